"""Painted textures: functions from a seeded generator to (H, W, 3) uint8 pictures."""
