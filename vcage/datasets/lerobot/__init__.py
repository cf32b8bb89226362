"""LeRobot data sets, v2.1, v3.0 and v3.1: written, added to, and given other videos."""
