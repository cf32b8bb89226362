"""Whether an object can go from arm to arm, before it is simulated."""

from __future__ import annotations

from tests.example_scenes import TABLE_TOP, kinematics, thing
from vcage.base.geometry import Pose
from vcage.tasks.feasibility import Transfer
from vcage.tasks.passing import examine_detour, examine_passing
from vcage.tasks.scene_objects import SceneObject


def to_table(target: SceneObject, x: float, y: float = 0.0) -> Transfer:
    contact = target.asset.annotation.carrying_points[0]
    return Transfer.onto_table(target, contact, [Pose([x, y, TABLE_TOP])], [])


def test_the_arm_that_gives_is_another_than_the_one_that_takes():
    found = examine_passing(to_table(thing("hammer", (-0.2, 0.0)), 0.2), "right", kinematics(), TABLE_TOP)
    assert [grasp.arm for grasp in found.grasps] == ["left"]
    assert {check.name for check in found.checks} >= {"opening", "reach_grasp", "reach_meeting", "reach_place"}
    assert all(check.passed for check in found.checks)


def test_a_short_object_is_refused_for_the_room_between_the_hands():
    found = examine_passing(to_table(thing("can", (-0.2, 0.0)), 0.2), "right", kinematics(), TABLE_TOP)
    assert not found.feasible
    assert "no room side by side on red tin can: it is 9.0 cm long" in found.reason


def test_an_object_that_the_giving_arm_does_not_reach_is_refused():
    found = examine_passing(to_table(thing("hammer", (0.75, 0.4)), 0.2), "right", kinematics(), TABLE_TOP)
    assert found.reason == "the left arm does not reach 'handle' of red hammer"


def test_a_place_that_the_taking_arm_does_not_reach_is_refused():
    found = examine_passing(to_table(thing("hammer", (-0.2, 0.0)), 0.2, 1.5), "right", kinematics(), TABLE_TOP)
    assert "its place is out of reach" in found.reason


def test_the_arm_that_reaches_the_place_takes_over():
    to, findings = examine_detour([to_table(thing("hammer", (-0.5, 0.1)), 0.6, 0.1)], kinematics(), TABLE_TOP)
    assert to == "right"
    assert [grasp.arm for finding in findings for grasp in finding.grasps] == ["left"]


def test_one_arm_alone_hands_nothing_over():
    left = {"left": kinematics()["left"]}
    assert examine_detour([to_table(thing("hammer", (-0.2, 0.0)), 0.2)], left, TABLE_TOP) == (None, [])
