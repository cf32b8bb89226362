"""Solids that overlap or come near to each other."""

from __future__ import annotations

import numpy as np
import sapien

from vcage.base.geometry import Pose
from vcage.sim.collision import near_to
from vcage.sim.poses import to_sapien
from vcage.sim.shapes import box_shape


def test_overlapping_boxes_are_near_even_where_the_distance_comes_out_positive() -> None:
    """FCL puts these .6 mm apart; the middle of the second is inside the first."""
    first = box_shape([0.048, 0.174, 0.034]).placed(sapien.Pose())
    second = box_shape([0.044, 0.15, 0.084]).placed(to_sapien(Pose.from_yaw([-0.004, 0.087, 0.011], np.radians(118))))
    assert near_to(first, second, distance=1e-4)


def test_boxes_farther_apart_than_the_distance_are_not_near() -> None:
    first, second = (box_shape([0.1, 0.1, 0.1]).placed(sapien.Pose([x, 0, 0])) for x in (0.0, 0.11))
    assert near_to(first, second, distance=0.0101)
    assert not near_to(first, second, distance=0.0099)
