"""How objects stand: any way round without moving parts, front to the robot with room for what moves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.layout.items import standing_at
from vcage.base.geometry import Pose, world_aabb
from vcage.layout.groups import hand_gaps
from vcage.layout.items import ANY_YAW, FRONT_YAWS, HandClearance, Placement, hand_clearance, table_item
from vcage.layout.placement.contents import content_plane
from vcage.layout.placement.place import place
from vcage.objects.library import Library
from vcage.objects.openings import Opening
from vcage.sim.joints import link_poses
from vcage.sim.robots import load_robot, load_template


@pytest.fixture(scope="module")
def cabinet():
    return Library.load().asset("cabinet_two_drawers")


def test_a_rigid_object_needs_its_footprint_any_way_round() -> None:
    mug = Library.load().asset("mug")
    room = table_item("mug", mug)
    np.testing.assert_allclose(room.size, mug.size)
    np.testing.assert_allclose(room.centre, 0)
    assert room.yaws == ANY_YAW


def test_a_cabinet_faces_the_robot_and_has_room_for_its_drawers(cabinet) -> None:
    room = table_item("cabinet", cabinet)
    assert room.yaws == FRONT_YAWS
    travel = max(link.joint.upper for link in cabinet.model.links)
    assert room.size[1] == pytest.approx(cabinet.footprint[1] + travel, abs=0.002)
    assert room.centre[1] == pytest.approx(-travel / 2, abs=0.002)


@pytest.mark.parametrize("yaw", FRONT_YAWS)
def test_an_opened_cabinet_lies_within_its_rectangle(cabinet, yaw: float) -> None:
    room, spot = table_item("cabinet", cabinet), Placement(0.1, 0.05, yaw)
    pose = room.pose(spot, 0.74)
    corners = []
    joints = [link.joint.upper for link in cabinet.model.links]
    for link, local in link_poses(cabinet.model, joints).items():
        corners += [pose.apply(local.apply(piece.vertices)) for piece in cabinet.pieces_of(link)]
    half = np.array([*np.array(room.size[:2]) / 2, 1.0])
    turned = world_aabb(np.stack([-half, half]), room.pose(spot, 0.0) * Pose([*room.centre, 0.0]))
    points = np.concatenate(corners)
    assert np.all(points[:, :2] >= turned[0, :2] - 1e-6) and np.all(points[:, :2] <= turned[1, :2] + 1e-6)


def test_every_object_finds_a_place_on_the_table_alone() -> None:
    library, template = Library.load(), load_template("table")
    workspace = np.array([template.workspace.lower, template.workspace.upper])
    for name in library.names:
        assert place([table_item(name, library.asset(name))], workspace, np.random.default_rng(0))[name]


def test_an_opening_is_positioned_by_the_middle_of_the_rectangle(cabinet) -> None:
    room = replace(table_item("cabinet", cabinet), opening=Opening((0.02, 0.03), (0.1, 0.1), 0.2, 0.3))
    spot = Placement(0.1, 0.05, 0.4)
    middle = content_plane(room, []).bounds.mean(axis=0)
    in_world = Pose.from_yaw([spot.x, spot.y, 0.0], spot.yaw).apply([*middle, 0.0])
    np.testing.assert_allclose(in_world, room.pose(spot, 0.0).apply([0.02, 0.03, 0.0]), atol=1e-12)


HAND = HandClearance(height=0.05, gap=0.095)


def test_a_panda_passes_over_low_things_and_has_its_palm_beside_the_grasped_object() -> None:
    assert hand_clearance(load_robot("dual_panda")) == HAND


def test_the_largest_hand_of_a_robot_counts() -> None:
    robot = load_robot("dual_panda")
    left = robot.arms["left"]
    larger = left.gripper.model_copy(update={"finger_length": 0.02, "palm_size": (0.3, 0.1)})
    arms = {**robot.arms, "left": left.model_copy(update={"gripper": larger})}
    found = hand_clearance(robot.model_copy(update={"arms": arms}))
    assert found == HandClearance(height=0.033, gap=0.143)


def test_only_obstacles_at_palm_height_beside_the_grasped_object_get_more_room() -> None:
    grasped, low, high = (
        standing_at(name, (0.05, 0.05, z), 0.0, (0, 0)) for name, z in (("a", 0.04), ("b", 0.05), ("c", 0.2))
    )
    gaps = hand_gaps([replace(grasped, hand=HAND), low, high], margin=0.01)
    np.testing.assert_array_equal(gaps, [[0, 0, 0.085], [0, 0, 0], [0.085, 0, 0]])
    assert hand_gaps([grasped, low, high], margin=0.01) is None
    assert hand_gaps([replace(grasped, hand=HAND), low], margin=0.01) is None
