"""Proof by use: objects are measured, placed, grasped, filled and opened in the simulator."""
