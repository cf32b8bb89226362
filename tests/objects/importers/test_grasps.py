"""Contact points found by trying."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from vcage.objects.convex import Convex
from vcage.objects.importers.grasps import GraspFromAbove, contact_points_from_above, is_free, surface_points
from vcage.sim.robots import load_robot

GRIPPER = load_robot("dual_panda").arms["left"].gripper


def box(size: tuple[float, float, float], at: tuple[float, float, float] = (0, 0, 0)) -> Convex:
    """A box that stands on the table at ``at``."""
    mesh = trimesh.creation.box(extents=size)
    return Convex.of(mesh.vertices + [at[0], at[1], at[2] + size[2] / 2])


def test_a_narrow_box_is_grasped_across_its_middle() -> None:
    first, *_ = contact_points_from_above([box((0.04, 0.15, 0.06))], GRIPPER)
    assert first.closing == (1.0, 0.0, 0.0) and first.approach == (0.0, 0.0, -1.0)
    assert first.position[:2] == pytest.approx((0, 0), abs=0.004)
    assert first.position[2] == pytest.approx(0.035, abs=0.004)


def test_a_box_narrow_both_ways_is_grasped_both_ways() -> None:
    assert {point.closing for point in contact_points_from_above([box((0.04, 0.05, 0.06))], GRIPPER)} == {
        (1, 0, 0),
        (0, 1, 0),
    }


def test_an_object_wider_than_the_gripper_has_no_grasp() -> None:
    assert contact_points_from_above([box((0.1, 0.12, 0.06))], GRIPPER) == []


def test_a_gripper_that_opens_wider_grasps_wider_objects() -> None:
    wider = GRIPPER.model_copy(update={"max_width": 0.14})
    assert contact_points_from_above([box((0.1, 0.12, 0.06))], wider)


def test_a_too_flat_object_has_no_grasp() -> None:
    assert contact_points_from_above([box((0.04, 0.12, 0.006))], GRIPPER) == []


def test_a_wall_beside_the_material_keeps_the_finger_out() -> None:
    block, wall = box((0.04, 0.04, 0.06)), box((0.01, 0.2, 0.06), (0.035, 0, 0))
    surface = surface_points([block, wall])
    position = np.array([0, 0, 0.035])
    assert not is_free(surface, GraspFromAbove("x", position, np.array([1.0, 0, 0]), 0.04), GRIPPER)
    assert is_free(surface, GraspFromAbove("y", position, np.array([0, 1.0, 0]), 0.04), GRIPPER)


def test_a_tower_above_the_grasp_keeps_the_palm_out() -> None:
    surface = surface_points([box((0.04, 0.15, 0.04)), box((0.02, 0.02, 0.12))])
    assert not is_free(surface, GraspFromAbove("x", np.array([0, 0, 0.03]), np.array([1.0, 0, 0]), 0.04), GRIPPER)
    assert is_free(surface, GraspFromAbove("x", np.array([0, 0.06, 0.03]), np.array([1.0, 0, 0]), 0.04), GRIPPER)


def test_the_second_grasp_is_a_finger_away_from_the_first() -> None:
    points = [
        point for point in contact_points_from_above([box((0.04, 0.15, 0.06))], GRIPPER) if point.closing == (1, 0, 0)
    ]
    assert len(points) == 2
    assert np.linalg.norm(np.subtract(points[0].position, points[1].position)) >= 0.022
