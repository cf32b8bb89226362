"""Recordings of others, read as they are: HDF5 in RoboTwin's, ACT's and our own layout, and folders of pictures."""
