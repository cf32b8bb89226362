"""Surfaces that several objects wear: functions to (H, W, 3) uint8 pictures; imported from `assets.textures`."""
