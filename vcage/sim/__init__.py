"""Simulation on SAPIEN: worlds made from records, robots, motion, recording, and rendering by replay."""

from __future__ import annotations

from vcage.setup.vulkan import prepare_import

# Before anything imports SAPIEN: on a machine without X11 it cannot even be loaded otherwise.
prepare_import()
