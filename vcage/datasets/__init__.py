"""Episodes on disk: the HDF5 written by collection, and LeRobot datasets for training."""
