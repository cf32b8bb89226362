"""Exact collision-free placement (paper, section III-A1)."""
