"""Collision-free optimisation of a layout (paper, section III-A4)."""
