"""Handing over between arms: on request, and where no arm reaches both ends."""

from __future__ import annotations

from tests.example_scenes import TABLE_TOP, scene_of, sensible, thing, workplace
from vcage.base.geometry import Pose
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Subtask
from vcage.tasks.feasibility import Transfer
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import FoundSubtasks, find_subtasks
from vcage.tasks.synthesis import render_script
from vcage.tasks.templates.hand_over import examine_detour, examine_passing

HANDED = Goal(subject="hammer", relation="handed", reference="right")


def search(objects: list[SceneObject], *asked: Goal) -> FoundSubtasks:
    return find_subtasks(workplace(objects), sensible, asked)


def handed(found: FoundSubtasks) -> list[Subtask]:
    return [subtask for subtask in found.kept if subtask.template == "hand_over"]


def test_it_is_tried_only_on_request():
    assert not handed(search([thing("hammer", (-0.2, 0.0))]))


def test_a_handed_over_object_is_put_down_by_the_taking_arm():
    (subtask,) = handed(search([thing("hammer", (-0.2, 0.0))], HANDED))
    assert subtask.goals == [HANDED, Goal(subject="hammer", relation="on", reference="table")]
    assert subtask.hand_to == "right"
    assert {grasp.arm for grasp in subtask.grasps} == {"left"}
    assert subtask.text == "Hand the red hammer to the right arm, which puts it down."


def test_an_object_too_short_for_two_hands_is_refused_with_its_measure():
    found = search([thing("can", (-0.2, 0.0))], Goal(subject="can", relation="handed", reference="right"))
    assert not handed(found)
    reasons = {refusal.reason for refusal in found.refused if refusal.template == "hand_over"}
    assert reasons == {
        "two hands have no room side by side on red tin can: it is 9.0 cm long, and each is 6.4 cm thick"
    }


def test_a_missing_arm_is_refused():
    found = search([thing("hammer", (-0.2, 0.0))], Goal(subject="hammer", relation="handed", reference="third"))
    assert [r.reason for r in found.refused if r.template == "hand_over"] == [
        "the arms are left, right: none hands anything to 'third'"
    ]


def test_an_object_no_single_arm_can_deliver_changes_hands():
    objects = [thing("cookie_box", (-0.6, 0.1), 0.3), thing("packaging_box", (0.6, 0.1))]
    inside = Goal(subject="cookie_box", relation="inside", reference="packaging_box")
    found = search(objects, inside)
    (subtask,) = handed(found)
    assert subtask.goals == [inside]
    assert not handed(search(objects)), "nobody asked for it"
    assert (subtask.id, subtask.hand_to) == ("cookie_box-handed-into-packaging_box", "right")
    assert any(r.reason == "the left arm does not reach 'inside floor' of brown packaging box" for r in found.refused)


def test_an_object_one_arm_can_deliver_does_not_change_hands():
    found = search([thing("cookie_box", (-0.2, 0.1), 0.3), thing("packaging_box", (0.15, 0.1))])
    assert not handed(found)
    assert any(subtask.template == "place" for subtask in found.kept)


def test_the_script_names_the_giving_and_the_taking_arm():
    hammer = thing("hammer", (-0.2, 0.0))
    (subtask,) = handed(search([hammer], HANDED))
    play = render_script(subtask, scene_of([hammer])).partition("def play(task):")[2].partition("def verify")[0]
    assert [line.strip() for line in play.splitlines()[2:6]] == [
        "task.pick('hammer', grasps=[(contact, arm) for contact, arm, _ in GRASPS], hand_to='right')",
        "task.hand_over('right')",
        "task.place()",
        "task.home()",
    ]


def to_table(target: SceneObject, x: float, y: float = 0.0) -> Transfer:
    contact = target.asset.annotation.carrying_points[0]
    return Transfer.onto_table(target, contact, [Pose([x, y, TABLE_TOP])], [])


def test_the_giving_arm_differs_from_the_taking_arm():
    found = examine_passing(to_table(thing("hammer", (-0.2, 0.0)), 0.2), "right", workplace([]))
    assert [grasp.arm for grasp in found.grasps] == ["left"]
    assert {check.name for check in found.checks} >= {"opening", "reach_grasp", "reach_meeting", "reach_place"}
    assert all(check.passed for check in found.checks)


def test_a_short_object_is_refused_for_the_room_between_the_hands():
    found = examine_passing(to_table(thing("can", (-0.2, 0.0)), 0.2), "right", workplace([]))
    assert not found.feasible
    assert "no room side by side on red tin can: it is 9.0 cm long" in found.reason


def test_an_object_that_the_giving_arm_does_not_reach_is_refused():
    found = examine_passing(to_table(thing("hammer", (0.75, 0.4)), 0.2), "right", workplace([]))
    assert found.reason == "the left arm does not reach 'handle' of red hammer"


def test_a_place_that_the_taking_arm_does_not_reach_is_refused():
    found = examine_passing(to_table(thing("hammer", (-0.2, 0.0)), 0.2, 1.5), "right", workplace([]))
    assert "its place is out of reach" in found.reason


def test_the_arm_that_reaches_the_place_takes_over():
    to, findings = examine_detour([to_table(thing("hammer", (-0.5, 0.1)), 0.6, 0.1)], workplace([]))
    assert to == "right"
    assert [grasp.arm for finding in findings for grasp in finding.grasps] == ["left"]


def test_one_arm_alone_hands_nothing_over():
    left = workplace([]).with_arms("left")
    assert examine_detour([to_table(thing("hammer", (-0.2, 0.0)), 0.2)], left) == (None, [])
