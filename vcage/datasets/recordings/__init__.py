"""Recordings of others, read as they are: HDF5 of RoboTwin, ACT, robomimic and our own, LeRobot, and pictures."""
