"""Recordings of others, read as they are: HDF5 of RoboTwin, ACT and our own, LeRobot data sets, folders of pictures."""
