"""Simulation on SAPIEN: worlds made from records, robots, motion, recording, and rendering by replay."""

from __future__ import annotations

import warnings

# SAPIEN says so when it is imported, and then uses its own copy, which works.
warnings.filterwarnings("ignore", message="Failed to find system libvulkan")
