"""Poses of moving parts, by geometry alone."""

from __future__ import annotations

import numpy as np
import pytest

from tests.articulated import drawer_cabinet, lidded_chest
from vcage.base.errors import UnknownName
from vcage.base.geometry import Pose
from vcage.schema.asset import Joint
from vcage.sim.bodies import Body
from vcage.sim.joints import carried_by, joint_index, joint_motion, link_poses, part_names
from vcage.sim.world import World


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("articulated")


@pytest.fixture(scope="module")
def cabinet(folder):
    return drawer_cabinet(folder)


@pytest.fixture(scope="module")
def chest(folder):
    return lidded_chest(folder)


def test_all_parts_are_in_the_object_frame_at_rest(cabinet):
    assert all(np.allclose(pose.matrix(), np.eye(4)) for pose in link_poses(cabinet).values())


def test_a_slide_moves_its_part_along_the_axis(cabinet):
    poses = link_poses(cabinet, [0.0, 0.1])
    np.testing.assert_allclose(poses["drawer_upper"].p, [0, -0.1, 0], atol=1e-9)
    np.testing.assert_allclose(poses["drawer_lower"].p, [0, 0, 0], atol=1e-9)


def test_a_turn_leaves_the_points_of_its_axis_where_they_are(chest):
    joint = chest.links[0].joint
    moved = joint_motion(joint, 1.0)
    np.testing.assert_allclose(moved.apply(joint.origin), joint.origin, atol=1e-9)
    assert moved.apply([0, -0.08, 0.1])[2] > 0.15


def test_a_part_moves_with_the_part_that_carries_it(cabinet):
    first, second = cabinet.links
    turn = Joint(kind="turn", origin=(0, -0.1, 0), axis=(0, 0, 1), lower=0, upper=2, damping=0, friction=0)
    chain = cabinet.model_copy(
        update={"links": [first, second.model_copy(update={"parent": first.name, "joint": turn})]}
    )
    pose = link_poses(chain, [0.05, np.pi / 2])[second.name]
    np.testing.assert_allclose(pose.apply([0.1, -0.1, 0]), [0, -0.05, 0], atol=1e-9)
    assert carried_by(chain, first.name) == [first.name, second.name]
    assert carried_by(chain, second.name) == [second.name]


@pytest.mark.parametrize("joints", [[0.05, 0.11], [0.12, 0.0]])
def test_the_simulator_puts_drawers_where_geometry_says(template, cabinet, joints):
    pose = Pose.from_yaw([0.1, 0.05, 0.74], 0.4)
    world = World(template.table, {"cabinet": Body(cabinet, pose, tuple(joints))})
    for link, local in link_poses(cabinet, joints).items():
        entity = world.entities("cabinet")[link]
        np.testing.assert_allclose(entity.pose.to_transformation_matrix(), (pose * local).matrix(), atol=1e-5)


def test_the_simulator_puts_lids_where_geometry_says(template, chest):
    pose = Pose.from_yaw([0.1, 0.05, 0.74], -0.4)
    world = World(template.table, {"chest": Body(chest, pose, (1.2,))})
    expected = pose * link_poses(chest, [1.2])["lid"]
    entity = world.entities("chest")["lid"]
    np.testing.assert_allclose(entity.pose.to_transformation_matrix(), expected.matrix(), atol=1e-5)


def test_another_number_of_joints_is_refused(cabinet):
    with pytest.raises(ValueError, match="expected 2 joint positions, got 1"):
        link_poses(cabinet, [0.1])


def test_parts_have_names_for_contacts_and_obstacles(cabinet):
    assert part_names("desk", cabinet) == ["desk", "desk/drawer_lower", "desk/drawer_upper"]
    assert joint_index(cabinet, "drawer_upper") == 1
    with pytest.raises(UnknownName, match="drawer_lower"):
        joint_index(cabinet, "door")
