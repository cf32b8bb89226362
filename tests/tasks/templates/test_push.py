"""A push is proposed only for a requested object that cannot be carried."""

from __future__ import annotations

import re

import numpy as np
import pytest

from tests.example_scenes import GROUND, scene_of, thing, workplace
from vcage.plans.relations import holds
from vcage.schema.goals import Goal, goal_of
from vcage.schema.subtasks import Refusal, Subtask
from vcage.tasks.chain_slots import slots_for_chain
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import actions_of
from vcage.tasks.synthesis import render_script
from vcage.tasks.templates.push import FACES, HEADINGS, PUSH, SETTINGS, examine_pushes, headings

PLATE, MUG, BLOCK = thing("plate", (0.0, -0.1)), thing("mug", (0.0, 0.15)), thing("block", (0.3, 0.1))
LEFT = goal_of(["plate", "left_of", "mug"])


def examined(goal: Goal, *objects: SceneObject) -> tuple[Subtask | None, list[Refusal]]:
    (proposal,), _ = PUSH.proposals(objects, [goal])
    assert proposal.impossible() is None
    return proposal.examine(workplace(objects))


def test_only_requested_relations_are_proposed():
    objects = [PLATE, MUG, BLOCK]
    assert PUSH.proposals(objects, []) == ([], [])
    found, _ = PUSH.proposals(objects, [LEFT, goal_of(["mug", "on", "plate"]), goal_of(["block", "on", "table"])])
    assert [proposal.goal for proposal in found] == [LEFT]


def test_a_portable_object_is_left_to_set_down():
    assert examined(goal_of(["block", "left_of", "mug"]), PLATE, MUG, BLOCK) == (None, [])


def test_a_push_is_a_subtask_that_moves_its_object_over_the_table():
    subtask, _ = examined(LEFT, PLATE, MUG)
    assert subtask is not None
    phrases = PLATE.record.phrase, MUG.record.phrase
    assert subtask.text == "Push the {} to the left of the {}.".format(*phrases)
    assert len({subtask.text, *subtask.texts}) >= 10
    assert subtask.goals == [LEFT, goal_of(["plate", "on", "table"])]
    assert actions_of([subtask], [PLATE, MUG], scene_of([PLATE, MUG]))[subtask.id].moves == "plate"


def test_its_script_is_short_and_calls_the_push():
    subtask, _ = examined(LEFT, PLATE, MUG)
    assert subtask is not None
    text = render_script(subtask, scene_of([PLATE, MUG], "Push the plate to the left of the mug"))
    assert "task.push('plate', arms=[arm for _, arm, _ in GRASPS])" in text


@pytest.mark.parametrize(
    ("asset", "reason"), [("customer_mat", "4 mm high, too flat"), ("microwave", "N, more than 24 N")]
)
def test_a_flat_or_heavy_object_is_refused_with_the_measure(asset: str, reason: str):
    objects = [thing(asset), thing("mug", (0.3, 0.1))]
    (proposal,), _ = PUSH.proposals(objects, [goal_of([asset, "left_of", "mug"])])
    refusal = proposal.impossible()
    assert refusal is not None and reason in refusal.reason


def test_an_object_on_another_is_not_pushed():
    plate = thing("plate", (0.0, 0.0), container="mug")
    (proposal,), _ = PUSH.proposals([plate, MUG], [LEFT])
    assert "does not stand on the table" in proposal.impossible().reason


def test_its_slot_is_the_end_of_a_push_from_its_place_in_the_episode():
    subtask, _ = examined(LEFT, PLATE, MUG)
    assert subtask is not None
    for shift in (-0.008, 0.008):
        plate = PLATE.moved(type(PLATE.pose).from_yaw(PLATE.pose.p + [shift, shift, 0.0], 0.1))
        slot = slots_for_chain([subtask], workplace([plate, MUG]))[subtask.id]
        assert slot.pose.yaw == pytest.approx(0.1)
        way = (slot.pose.p - plate.pose.p)[:2]
        turn = (np.arctan2(way[1], way[0]) - 0.1) / np.radians(30)
        assert turn == pytest.approx(round(turn), abs=1e-6)


def examined_pushes(word: str, pushed: SceneObject, *others: SceneObject):
    goal = goal_of([pushed.id, word, others[0].id])
    return examine_pushes(pushed, goal, workplace([pushed, *others]))


def test_a_box_is_pushed_against_its_faces_and_a_round_thing_in_any_direction():
    assert tuple(headings(thing("book", yaw=0.3))) == FACES
    assert len(headings(thing("plate", yaw=0.3))) == len(HEADINGS)


def test_each_push_ends_where_the_goal_holds_with_a_margin_and_on_the_ground():
    cup = thing("mug", (0.0, 0.12))
    found, _ = examined_pushes("left_of", thing("book", (0.0, -0.1)), cup)
    assert found
    for push in found:
        box = thing("book", (0.0, -0.1)).moved(push.end).aabb
        assert holds("left_of", box + [SETTINGS.margin_m, 0, 0], cup.aabb)
        assert np.all(box[0, :2] >= GROUND.lower) and np.all(box[1, :2] <= GROUND.upper)
        assert {grasp.contact for grasp in push.finding.grasps} == {push.heading}


def test_the_arm_on_the_side_of_the_object_comes_first():
    found, _ = examined_pushes("left_of", thing("plate", (-0.1, -0.1)), thing("mug", (-0.1, 0.15)))
    assert found[0].finding.grasps[0].arm == "left"


def test_the_checks_of_a_push_come_from_its_best_arm():
    found, _ = examined_pushes("left_of", thing("plate", (-0.15, -0.1)), thing("mug", (-0.15, 0.15)))
    assert any(len(push.finding.grasps) == 2 for push in found)
    for finding in (push.finding for push in found):
        assert f"the {finding.grasps[0].arm} arm reaches" in finding.checks[-1].message


@pytest.mark.parametrize(
    ("others", "reason"),
    [
        (((0.0, 0.0),), "mug is in the way of .* pushed .* to the right"),
        (((0.3, 0.0),), "pushed to the left, at most 2. cm, it does not come to be so that book right_of mug"),
    ],
)
def test_each_other_direction_has_a_reason(others, reason):
    found, refused = examined_pushes("right_of", thing("book", (-0.18, 0.0)), *(thing("mug", xy) for xy in others))
    assert {push.heading for push in found}.isdisjoint(refused)
    assert any(re.search(reason, text) for text in refused.values())


def test_an_obstacle_below_the_hand_is_reported():
    pushed, cup = thing("book", (0.0, -0.1)), thing("mug", (0.0, 0.15))
    wall = thing("book", (-0.165, -0.1), id="other")
    _, refused = examined_pushes("right_of", pushed, cup, wall)
    assert any("is in the way of the hand" in reason for reason in refused.values())
