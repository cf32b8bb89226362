"""Recordings made small: a search for each camera, in processes of their own, and its output."""
