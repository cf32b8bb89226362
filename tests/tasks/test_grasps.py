"""From a contact point to gripper poses."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.example_scenes import TABLE_TOP, library, robot, thing
from vcage.base.geometry import Pose, frame_from_axes, oriented_boxes_overlap
from vcage.schema.asset import ContactPoint
from vcage.tasks.grasps import GRASPING, TILTS, approach_opening, grasp_poses, hand_boxes
from vcage.tasks.scene_objects import SolidBox

GRIPPER = robot().arms["left"].gripper
CONTACTS = [c for name in library().names for c in library().annotation(name).contact_points]

contacts = st.sampled_from(CONTACTS)
poses = st.builds(
    lambda x, y, yaw: Pose.from_yaw([x, y, TABLE_TOP], yaw),
    st.floats(-0.5, 0.5),
    st.floats(-0.3, 0.3),
    st.floats(-np.pi, np.pi),
)


@given(contacts, poses)
def test_neither_finger_tips_nor_palm_are_ever_below_the_support(contact: ContactPoint, pose: Pose):
    for grasp in grasp_poses(pose, contact, GRIPPER, TABLE_TOP):
        for part in hand_boxes(GRIPPER, GRIPPER.max_width):
            assert SolidBox(part, grasp.pose).bottom > TABLE_TOP


@given(st.sampled_from([c for c in CONTACTS if c.link is None]), poses)
def test_no_tilted_finger_comes_deeper_than_a_straight_one(contact: ContactPoint, pose: Pose):
    """There the object may be wider than where it is to be held."""
    straight, *others = grasp_poses(pose, contact, GRIPPER, TABLE_TOP)
    deepest = min(SolidBox(finger, straight.pose).bottom for finger in hand_boxes(GRIPPER, GRIPPER.max_width)[:2])
    for grasp in others:
        for finger in hand_boxes(GRIPPER, GRIPPER.max_width)[:2]:
            assert SolidBox(finger, grasp.pose).bottom > deepest - 1e-6


@given(contacts, poses)
def test_the_fingers_close_along_the_axis_of_the_contact_point(contact: ContactPoint, pose: Pose):
    wanted = pose.rotation() @ frame_from_axes(contact.position, contact.approach, contact.closing).rotation()[:, 1]
    for grasp in grasp_poses(pose, contact, GRIPPER, TABLE_TOP):
        assert abs(grasp.pose.rotation()[:, 1] @ wanted) == pytest.approx(1.0)


@given(contacts, poses)
def test_the_grasp_in_the_object_frame_agrees_with_the_grasp_in_the_world(contact: ContactPoint, pose: Pose):
    for grasp in grasp_poses(pose, contact, GRIPPER, TABLE_TOP):
        np.testing.assert_allclose((pose * grasp.in_object).matrix(), grasp.pose.matrix(), atol=1e-9)


@given(contacts, poses)
def test_the_gripper_is_only_ever_moved_straight_up_from_the_contact_point(contact: ContactPoint, pose: Pose):
    point = pose.apply(contact.position)
    for grasp in grasp_poses(pose, contact, GRIPPER, TABLE_TOP):
        np.testing.assert_allclose(grasp.pose.p[:2], point[:2], atol=1e-9)
        assert grasp.pose.p[2] >= point[2] - 1e-9


def test_the_straight_grasps_come_first_and_the_most_tilted_last():
    block = thing("block")
    contact = block.asset.annotation.contact_point(0)
    poses = [grasp.pose for grasp in grasp_poses(block.pose, contact, GRIPPER, TABLE_TOP)]
    downwards = [-pose.rotation()[2, 2] for pose in poses]
    np.testing.assert_allclose(downwards, np.repeat(np.cos(TILTS), 2), atol=1e-9)


def test_each_tilt_comes_with_the_gripper_flipped():
    block = thing("block")
    straight, flipped, *_ = grasp_poses(block.pose, block.asset.annotation.contact_point(0), GRIPPER, TABLE_TOP)
    np.testing.assert_allclose(straight.pose.rotation()[:, 1], -flipped.pose.rotation()[:, 1], atol=1e-9)


@given(st.floats(0.0, 0.2))
def test_the_fingers_never_open_wider_than_the_gripper_can(width: float):
    assert approach_opening(width, GRIPPER) <= GRIPPER.max_width


@given(st.floats(0.0, GRIPPER.max_width - GRASPING.grasp_room_m))
def test_the_open_fingers_leave_the_material_between_them_free(width: float):
    material = np.array([[-0.01, -width / 2, -0.05], [0.01, width / 2, 0.0]])
    fingers = hand_boxes(GRIPPER, approach_opening(width, GRIPPER))[:2]
    assert not any(oriented_boxes_overlap(finger, Pose(), material, Pose()) for finger in fingers)


def test_the_hand_that_must_stay_free_is_that_of_the_robot():
    slim = GRIPPER.model_copy(update={"finger_width": 0.01, "finger_thickness": 0.008, "palm_height": 0.05})
    left, right, palm = hand_boxes(slim, 0.04)
    np.testing.assert_allclose((left[1] - left[0])[:2], [0.01, 0.008])
    np.testing.assert_allclose(left[:, 1], -right[::-1, 1])
    assert palm[1, 2] - palm[0, 2] == pytest.approx(0.05)


def test_opening_fingers_fill_the_space_they_sweep():
    for opened, closed, swept in zip(
        hand_boxes(GRIPPER, 0.06), hand_boxes(GRIPPER, 0.02), hand_boxes(GRIPPER, 0.06, 0.02), strict=True
    ):
        np.testing.assert_array_equal(swept[0], np.minimum(opened, closed)[0])
        np.testing.assert_array_equal(swept[1], np.maximum(opened, closed)[1])
