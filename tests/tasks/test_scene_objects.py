"""An object of a scene with its geometry."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import MultiPoint

from tests.example_scenes import TABLE_TOP, thing
from vcage.base.geometry import Pose
from vcage.tasks.scene_objects import Obstacles, SolidBox


def test_the_walls_of_a_box_leave_its_opening_free():
    box = thing("packaging_box", (0.1, 0.0), 0.4)
    opening = box.asset.opening(box.asset.annotation.functional_point(0))
    centre = box.pose.apply([*opening.centre, opening.floor])
    inside = SolidBox(np.array([[-0.1, -0.08, 0.0], [0.1, 0.08, 0.01]]), Pose(centre, box.pose.q))
    ((_, below),) = Obstacles(box.walls(0)).under([inside])
    assert len(below) == 0


@settings(deadline=None)
@given(st.lists(st.floats(-1, 1), min_size=8, max_size=8), st.floats(-0.2, 0.2), st.floats(-0.2, 0.2))
def test_boxes_are_seen_apart_when_their_outlines_are(turns: list[float], x: float, y: float):
    """Against shapely, for boxes turned in any way."""
    bounds = np.array([[-0.1, -0.04, -0.02], [0.1, 0.04, 0.02]])
    a, b = (np.array(q) + [1.1, 0, 0, 0] for q in (turns[:4], turns[4:]))
    boxes = SolidBox(bounds, Pose(q=a)), SolidBox(bounds, Pose([x, y, 0.5], b))
    outlines = [MultiPoint(box.corners[:, :2]).convex_hull for box in boxes]
    gap = outlines[0].distance(outlines[1])
    if gap > 1e-6 or outlines[0].intersection(outlines[1]).area > 1e-6:
        ((_, below),) = Obstacles([boxes[1]]).under([boxes[0]])
        assert (len(below) == 0) == (gap > 0)


def test_the_walls_of_a_box_reach_from_its_bottom_to_its_rim():
    box = thing("packaging_box")
    rim = box.asset.opening(box.asset.annotation.functional_point(0)).rim
    walls = box.walls(0)
    assert len(walls) == 4
    for wall in walls:
        assert (wall.bottom, wall.top) == pytest.approx((TABLE_TOP, TABLE_TOP + rim))


def test_a_flat_top_has_no_walls():
    assert thing("block").walls(0) == []


def test_a_moved_object_keeps_everything_but_its_pose():
    block = thing("block", (0.1, 0.0))
    moved = block.moved(Pose([0.2, 0.1, TABLE_TOP]))
    assert (moved.record, moved.asset) == (block.record, block.asset)
    np.testing.assert_allclose(moved.aabb.mean(axis=0)[:2], [0.2, 0.1])


def test_a_turned_object_has_a_larger_box_in_the_world():
    straight, turned = thing("marker"), thing("marker", yaw=np.pi / 4)
    assert np.ptp(turned.aabb, axis=0)[1] > np.ptp(straight.aabb, axis=0)[1]
