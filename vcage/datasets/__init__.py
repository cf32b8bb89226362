"""Episodes on disk: the HDF5 that collection writes, and the LeRobot datasets that training reads."""
