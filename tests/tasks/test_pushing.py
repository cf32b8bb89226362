"""Which straight pushes bring about a goal, and why others do not."""

from __future__ import annotations

import re

import numpy as np
import pytest

from tests.example_scenes import GROUND, kinematics, thing
from vcage.plans.relations import holds
from vcage.schema.goals import goal_of
from vcage.tasks.pushing import FACES, HEADINGS, SETTINGS, examine_pushes, headings
from vcage.tasks.scene_objects import SceneObject


def examined(word: str, pushed: SceneObject, *others: SceneObject):
    goal = goal_of([pushed.id, word, others[0].id])
    return examine_pushes(pushed, goal, others, kinematics(), GROUND)


def test_a_box_is_pushed_against_its_faces_and_a_round_thing_in_any_direction():
    assert tuple(headings(thing("book", yaw=0.3))) == FACES
    assert len(headings(thing("plate", yaw=0.3))) == len(HEADINGS)


def test_each_push_ends_where_the_goal_holds_with_a_margin_and_on_the_ground():
    cup = thing("mug", (0.0, 0.12))
    found, _ = examined("left_of", thing("book", (0.0, -0.1)), cup)
    assert found
    for push in found:
        box = thing("book", (0.0, -0.1)).moved(push.end).aabb
        assert holds("left_of", box + [SETTINGS.margin_m, 0, 0], cup.aabb)
        assert np.all(box[0, :2] >= GROUND.lower) and np.all(box[1, :2] <= GROUND.upper)
        assert {grasp.contact for grasp in push.finding.grasps} == {push.heading}


def test_the_arm_on_whose_side_it_happens_comes_first():
    found, _ = examined("left_of", thing("plate", (-0.1, -0.1)), thing("mug", (-0.1, 0.15)))
    assert found[0].finding.grasps[0].arm == "left"


def test_the_checks_of_a_push_are_those_of_its_best_arm():
    found, _ = examined("left_of", thing("plate", (-0.15, -0.1)), thing("mug", (-0.15, 0.15)))
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
    found, refused = examined("right_of", thing("book", (-0.18, 0.0)), *(thing("mug", xy) for xy in others))
    assert {push.heading for push in found}.isdisjoint(refused)
    assert any(re.search(reason, text) for text in refused.values())


def test_what_stands_where_the_hand_comes_down_is_told():
    pushed, cup = thing("book", (0.0, -0.1)), thing("mug", (0.0, 0.15))
    wall = thing("book", (-0.165, -0.1), id="other")
    _, refused = examined("right_of", pushed, cup, wall)
    assert any("is in the way of the hand" in reason for reason in refused.values())
