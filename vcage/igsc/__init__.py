"""Inpainting-guided scene construction (paper, section III-A): pure functions on records and arrays."""
