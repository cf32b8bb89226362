"""Poses of a hand whose fingers close where they are meant to."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import thing
from vcage.sim.robots import load_robot
from vcage.tasks.grasps import approach_opening, grasp_poses
from vcage.tasks.hand_poses import SETTINGS, closed_width, hand_poses

GRIPPER = load_robot("aloha_agilex").arms["left"].gripper
SCANNER = thing("barcode_scanner")
HEAD = SCANNER.asset.annotation.contact_point(1)


def test_all_hands_on_a_plain_block_are_kept():
    block = thing("block")
    contact = block.asset.annotation.contact_point(0)
    kept = hand_poses(block, contact, GRIPPER)
    assert kept == list(grasp_poses(block.pose, contact, GRIPPER, block.box.bottom))


def test_a_hand_that_leans_over_a_wider_part_would_close_on_that_and_is_left_out():
    """The guard before a scanner's window is wider than its head."""
    over_the_guard = [pose for pose in hand_poses(SCANNER, HEAD, GRIPPER) if pose.in_object.rotation()[0, 2] > 0.8]
    assert not over_the_guard
    assert any(p.in_object.rotation()[0, 2] > 0.8 for p in grasp_poses(SCANNER.pose, HEAD, GRIPPER, SCANNER.pose.p[2]))


@pytest.mark.parametrize("name", ["barcode_scanner", "mug", "bowl", "pot"])
def test_no_hand_closes_on_much_wider_material_than_a_straight_one(name: str):
    held = thing(name)
    for contact in held.asset.annotation.carrying_points:
        opening = approach_opening(held.asset.grasp_width(contact), GRIPPER)
        poses = hand_poses(held, contact, GRIPPER)
        widths = [closed_width(held.asset, pose.in_object, GRIPPER, opening) for pose in poses]
        assert max(widths) < widths[0] + SETTINGS.wider_m + 1e-6


def test_they_come_in_pairs_that_are_flipped_about_the_approach():
    poses = hand_poses(SCANNER, HEAD, GRIPPER)
    for one, other in zip(poses[::2], poses[1::2], strict=True):
        np.testing.assert_allclose(one.pose.rotation()[:, 2], other.pose.rotation()[:, 2], atol=1e-9)
        np.testing.assert_allclose(one.pose.rotation()[:, 1], -other.pose.rotation()[:, 1], atol=1e-9)
