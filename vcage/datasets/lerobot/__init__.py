"""LeRobot data sets, v2.1 and v3.0: written, added to, and given other videos."""
