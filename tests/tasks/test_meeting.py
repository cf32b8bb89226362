"""Where two hands meet on one object."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import TABLE_TOP, kinematics, robot, thing
from vcage.base.geometry import Pose
from vcage.sim.kinematics import kinematics_of
from vcage.sim.motion import MotionFailed
from vcage.sim.robots import load_robot
from vcage.tasks.grasps import grasp_poses
from vcage.tasks.meeting import Hold, NoMeeting, holds_beside, meeting_height, meetings
from vcage.tasks.scene_objects import SceneObject

GRIPPER = robot().arms["left"].gripper
ARMS = (kinematics()["left"], kinematics()["right"])
HEIGHT = TABLE_TOP + 0.2


def first_hold(target: SceneObject) -> Hold:
    contact = target.asset.annotation.carrying_points[0]
    grasp = next(grasp_poses(Pose(), contact, GRIPPER, 0.0))
    return Hold(grasp.in_object, target.asset.grasp_width(contact))


def beside(target: SceneObject) -> list[Hold]:
    contacts = target.asset.annotation.carrying_points
    return holds_beside(target.asset, first_hold(target), contacts, GRIPPER)


def any_hold(_hold: Hold) -> None:
    """Suits every hold."""


@pytest.mark.parametrize("asset", ["hammer", "rolling_pin", "marker", "cookie_box", "bottle"])
def test_the_hands_on_a_long_object_do_not_overlap(asset: str):
    target = thing(asset)
    first = first_hold(target).hand(GRIPPER)
    found = beside(target)
    assert found
    assert not any(a.overlaps(b) for hold in found for a in hold.hand(GRIPPER) for b in first)


def test_a_second_hand_closes_on_material():
    target = thing("hammer")
    assert all(0 < hold.width < GRIPPER.max_width for hold in beside(target))


def test_the_palm_of_a_second_hand_is_clear_of_the_object():
    target = thing("cookie_box")
    body = target.moved(Pose()).box
    assert not any(hold.hand(GRIPPER)[0].overlaps(body) for hold in beside(target))


def test_a_second_hand_is_first_tried_near_the_middle_of_the_weight():
    tried = [abs(hold.in_object.p[0]) for hold in beside(thing("rolling_pin"))]
    assert tried == sorted(tried)


@pytest.mark.parametrize("asset", ["can", "apple", "block"])
def test_two_hands_have_no_room_on_a_small_object(asset: str):
    assert not beside(thing(asset))
    with pytest.raises(NoMeeting, match=r"cm long, and each is 6\.4 cm thick") as caught:
        next(meetings(thing(asset), first_hold(thing(asset)), ARMS, HEIGHT, any_hold))
    assert caught.value.check == "room_for_hands"


def test_both_arms_are_at_their_holds_where_an_object_changes_hands():
    target = thing("hammer")
    given = first_hold(target)
    meeting = next(meetings(target, given, ARMS, HEIGHT, any_hold))
    giver, taker = (arm.fk(q) for arm, q in zip(ARMS, (meeting.giving, meeting.taking), strict=True))
    np.testing.assert_allclose(giver.p, (meeting.pose * given.in_object).p, atol=1e-3)
    np.testing.assert_allclose(taker.p, (meeting.pose * meeting.taken.in_object).p, atol=1e-3)


def test_an_object_changes_hands_upright_above_the_least_height():
    target = thing("hammer")
    for meeting in meetings(target, first_hold(target), ARMS, HEIGHT + 0.1, any_hold):
        assert meeting.pose.rotation()[2, 2] == pytest.approx(1.0)
        assert (meeting.pose * meeting.given.in_object).p[2] > HEIGHT + 0.05


def test_each_arm_holds_its_own_side():
    target = thing("rolling_pin")
    meeting = next(meetings(target, first_hold(target), ARMS, HEIGHT, any_hold))
    assert (meeting.pose * meeting.given.in_object).p[0] < (meeting.pose * meeting.taken.in_object).p[0]


@pytest.mark.parametrize("flipped", [0, 1])
def test_arms_that_reach_down_only_near_their_bases_meet_there(flipped: int):
    target, arms = thing("hammer"), load_robot("aloha_agilex").arms
    contact = target.asset.annotation.carrying_points[0]
    grasp = list(grasp_poses(Pose(), contact, arms["left"].gripper, 0.0))[flipped]
    given, both = Hold(grasp.in_object, target.asset.grasp_width(contact)), (arms["left"], arms["right"])
    left, right = map(kinematics_of, both)
    meeting = next(meetings(target, given, (left, right), TABLE_TOP + 0.1, any_hold))
    for arm, joints, hold in ((left, meeting.giving, given), (right, meeting.taking, meeting.taken)):
        np.testing.assert_allclose(arm.fk(joints).p, (meeting.pose * hold.in_object).p, atol=1e-3)


def test_meetings_where_something_is_in_the_way_are_left_out():
    target = thing("hammer")
    found = list(meetings(target, first_hold(target), ARMS, HEIGHT, any_hold))
    rest = list(
        meetings(target, first_hold(target), ARMS, HEIGHT, any_hold, lambda meeting: meeting.pose != found[0].pose)
    )
    assert rest
    assert all(meeting.pose != found[0].pose for meeting in rest)


def test_an_object_keeps_its_attitude_to_where_it_changes_hands():
    hangs = thing("hammer").moved(Pose([0, 0, 1.0], [np.cos(0.15), 0, np.sin(0.15), 0]))
    meeting = next(meetings(hangs, first_hold(hangs), ARMS, HEIGHT, any_hold))
    assert meeting.pose.rotation()[2, 2] == pytest.approx(hangs.pose.rotation()[2, 2])


def test_a_hand_is_as_high_above_all_others_as_what_hangs_from_it_needs():
    target = thing("hammer")
    given, gripper = first_hold(target), ARMS[0].arm.gripper
    alone = meeting_height(target, given, gripper, [], TABLE_TOP)
    beside = meeting_height(target, given, gripper, [thing("bottle", (0.3, 0.0))], TABLE_TOP)
    assert TABLE_TOP + given.in_object.p[2] < alone < beside


def test_an_object_that_cannot_be_carried_on_is_not_handed_over():
    def never(_hold: Hold) -> None:
        raise MotionFailed("its place is out of reach")

    target = thing("hammer")
    with pytest.raises(NoMeeting, match="its place is out of reach") as caught:
        next(meetings(target, first_hold(target), ARMS, HEIGHT, never))
    assert caught.value.check == "reach_place"


def test_arms_do_not_meet_above_their_reach():
    target = thing("marker")
    with pytest.raises(NoMeeting, match="do not both reach") as caught:
        next(meetings(target, first_hold(target), ARMS, TABLE_TOP + 1.5, any_hold))
    assert caught.value.check == "reach_meeting"
