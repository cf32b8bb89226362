"""Proof by use: every object of the library is measured, stood, grasped, filled and opened in the simulator."""
