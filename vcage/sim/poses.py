"""Between our poses (float64) and SAPIEN's (float32); both are wxyz."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vcage.base.geometry import Pose

if TYPE_CHECKING:
    import sapien


def to_sapien(pose: Pose) -> sapien.Pose:
    """The same transform as a SAPIEN pose."""
    import sapien

    return sapien.Pose(p=pose.p, q=pose.q)


def from_sapien(pose: sapien.Pose) -> Pose:
    """The same transform as one of our poses."""
    return Pose(pose.p, pose.q)
