"""From a handle or button to the gripper's ways of operating it."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from tests.articulated import (
    LID_RANGE,
    TRAVEL,
    button_top,
    drawer_cabinet,
    drawer_handle,
    lid_handle,
    lidded_chest,
    push_button,
)
from tests.example_scenes import TABLE_TOP, robot
from vcage.base.geometry import Pose
from vcage.tasks.grasps import GRASPING
from vcage.tasks.primitives.handles import STEP, TURNS_ALONG, Handle, held_frame, operating_ways

GRIPPER = robot().arms["left"].gripper
PLACE = Pose.from_yaw([0.1, 0.05, TABLE_TOP], 0.3)


@pytest.fixture(scope="module")
def handles(tmp_path_factory):
    """The handles of a closed drawer, a closed lid and a button, by name."""
    folder = tmp_path_factory.mktemp("articulated")
    return {
        "drawer": Handle(drawer_handle(), drawer_cabinet(folder), PLACE, np.zeros(2), 0.012),
        "lid": Handle(lid_handle(), lidded_chest(folder), PLACE, np.zeros(1), 0.012),
        "button": Handle(button_top(), push_button(folder), PLACE, np.zeros(1), 0.0),
    }


def ways(handle: Handle, target: float):
    return list(operating_ways(handle, target, GRIPPER, TABLE_TOP))


def test_the_gripper_pulls_a_drawer_straight_along_its_slide(handles):
    way = ways(handles["drawer"], TRAVEL)[0]
    along = PLACE.rotation() @ [0, -1, 0]
    np.testing.assert_allclose(way.motion[-1].p - way.grasp.p, TRAVEL * along, atol=1e-9)
    assert all(np.allclose(abs(pose.q @ way.grasp.q), 1.0) for pose in way.motion)


def test_a_drawer_is_also_pulled_straight_by_a_hand_that_stands_aside(handles):
    found = ways(handles["drawer"], TRAVEL)
    along = PLACE.rotation() @ [0, -1, 0]
    turned = {round(float(np.degrees(np.arcsin(way.grasp.rotation()[:, 1] @ along)))) for way in found}
    assert turned == {0, 20, -20}
    for way in found:
        np.testing.assert_allclose(way.motion[-1].p - way.grasp.p, TRAVEL * along, atol=1e-9)


def test_poses_along_the_motion_are_close_together(handles):
    for name, target in (("drawer", TRAVEL), ("lid", LID_RANGE)):
        way = ways(handles[name], target)[0]
        for a, b in itertools.pairwise([way.grasp, *way.motion]):
            assert np.linalg.norm(a.p - b.p) <= STEP + 1e-6


def test_a_gripper_that_turns_along_keeps_its_place_on_the_lid(handles):
    way = ways(handles["lid"], LID_RANGE)[0]
    hinge = PLACE.apply(handles["lid"].link.joint.origin)
    distances = [np.linalg.norm(pose.p - hinge) for pose in (way.grasp, *way.motion)]
    np.testing.assert_allclose(distances, distances[0], atol=1e-9)
    turned = 2 * np.arccos(abs(way.grasp.q @ way.motion[-1].q))
    assert turned == pytest.approx(LID_RANGE)


def test_other_ways_turn_less_and_end_at_the_same_place(handles):
    found = ways(handles["lid"], LID_RANGE)
    turned = {round(float(2 * np.arccos(min(1, abs(w.grasp.q @ w.motion[-1].q)))), 6) for w in found}
    assert turned == {round(share * LID_RANGE, 6) for share in TURNS_ALONG}
    straight = [found[i * len(found) // len(TURNS_ALONG)] for i in range(len(TURNS_ALONG))]
    ends = np.array([way.motion[-1].p for way in straight])
    np.testing.assert_allclose(ends, np.broadcast_to(ends[0], ends.shape), atol=1e-9)


def test_a_handle_turns_between_the_fingers_of_a_hand_that_turns_less(handles):
    found = ways(handles["lid"], LID_RANGE)
    assert {way.turning for way in found} == {True, False}
    for way in found:
        turned = 2 * np.arccos(min(1, abs(way.grasp.q @ way.motion[-1].q)))
        assert way.turning == (turned < LID_RANGE - 1e-6)


def test_a_knob_is_turned_by_hands_that_turn_all_the_way(handles):
    lid = handles["lid"]
    knob = replace(lid, contact=lid.contact.model_copy(update={"position": lid.link.joint.origin}))
    turned = [2 * np.arccos(min(1, abs(way.grasp.q @ way.motion[-1].q))) for way in ways(knob, LID_RANGE)]
    np.testing.assert_allclose(turned, LID_RANGE)


def test_closing_begins_where_opening_ended(handles):
    closed = handles["lid"]
    opened = Handle(closed.contact, closed.model, closed.pose, np.array([LID_RANGE]), closed.width)
    for opening, closing in zip(ways(closed, LID_RANGE), ways(opened, 0.0), strict=True):
        np.testing.assert_allclose(closing.grasp.matrix(), opening.motion[-1].matrix(), atol=1e-9)
        np.testing.assert_allclose(closing.motion[-1].matrix(), opening.grasp.matrix(), atol=1e-9)


def test_a_button_is_pressed_with_the_tips_of_closed_fingers_and_let_go(handles):
    way = ways(handles["button"], 0.008)[0]
    assert way.opening == 0.0
    top = PLACE.apply(handles["button"].contact.position)
    np.testing.assert_allclose(way.grasp.p - [0, 0, GRIPPER.tip_depth], top, atol=1e-9)
    lowest = min(pose.p[2] for pose in way.motion)
    assert lowest == pytest.approx(way.grasp.p[2] - 0.008)
    assert way.motion[way.pushed - 1].p[2] == pytest.approx(lowest)
    np.testing.assert_allclose(way.motion[-1].p, way.grasp.p, atol=1e-9)


def test_fingers_come_open_and_leave_the_way_they_point(handles):
    way = ways(handles["drawer"], TRAVEL)[0]
    assert way.opening == pytest.approx(0.012 + GRASPING.grasp_room_m)
    back = way.after.p - way.motion[-1].p
    np.testing.assert_allclose(back / np.linalg.norm(back), -way.motion[-1].rotation()[:, 2], atol=1e-9)


def test_the_frame_of_a_part_is_the_parts_when_the_gripper_turns_along(handles):
    handle = handles["lid"]
    frame = held_frame(handle, 0.0)
    np.testing.assert_allclose(frame.matrix(), PLACE.matrix(), atol=1e-9)


def test_a_contact_point_of_the_body_moves_nothing(handles):
    handle = handles["drawer"]
    fixed = Handle(handle.contact.model_copy(update={"link": None}), handle.model, PLACE, np.zeros(2), 0.0)
    with pytest.raises(ValueError, match="no moving part"):
        ways(fixed, 0.1)
