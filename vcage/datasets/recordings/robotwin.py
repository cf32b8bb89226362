"""HDF5 in RoboTwin's two layouts.

The first: ``observation/<camera>/rgb`` holds JPEG as fixed-length bytes, made with OpenCV from RGB arrays and so with
red and blue swapped (https://github.com/robotwin-Platform/RoboTwin/issues/438); ``joint_action`` the commands, which it
takes for the state too. The second: ``vision/<camera>/colors``, swapped as well unless a comment in each JPEG says
otherwise, and the groups ``state`` and ``action``.
"""

from __future__ import annotations

from dataclasses import replace

import h5py

from vcage.datasets.recordings.hdf5_recording import Hdf5Recording, columns
from vcage.datasets.recordings.recording import Columns

ARM_PARTS = ("left_arm", "left_gripper", "right_arm", "right_gripper")
"""RoboTwin's datasets of a robot's joints, in the order of its ``vector``, which holds them all."""


class RoboTwinEpisode(Hdf5Recording):
    """RoboTwin's first layout; ``joint_state`` beside ``joint_action`` is ours (:mod:`vcage.datasets.robotwin`)."""

    LAYOUT = "robotwin"
    PICTURES = r"observation/([^/]+)/rgb"
    SWAPPED = True
    COLOURS_SURE = False

    def _commands(self, part: h5py.Group) -> Columns | None:
        return _joints(part.get("joint_action"))

    def _measured(self, part: h5py.Group) -> Columns | None:
        if "joint_state" in part:
            return _joints(part["joint_state"])
        found = _joints(part.get("joint_action"))
        if found is not None:
            note = "it holds no measured state; its commands are taken for it, as RoboTwin does"
            return replace(found, notes=(note,))
        return None


class RoboTwinVisionEpisode(Hdf5Recording):
    """RoboTwin's second layout."""

    LAYOUT = "robotwin-1.0"
    PICTURES = r"vision/([^/]+)/colors"
    SWAPPED = True
    COLOURS_SURE = False

    def _commands(self, part: h5py.Group) -> Columns | None:
        return columns(part.get("action", part.get("state")))

    def _measured(self, part: h5py.Group) -> Columns | None:
        return columns(part.get("state"))


def _joints(group: h5py.Group | None) -> Columns | None:
    """RoboTwin's numbers of a robot's joints."""
    return columns(group, ARM_PARTS) or columns(group, ("vector",))
