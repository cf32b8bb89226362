"""Start descriptions against boxes and plans."""

from __future__ import annotations

import numpy as np
import pytest

from vcage.base.errors import UnknownName
from vcage.plans.descriptions import described_relations, false_descriptions, false_in_words, with_descriptions
from vcage.plans.plain_words import goal_in_words, in_words
from vcage.plans.relations import ground_box
from vcage.schema.goals import Description, Goal
from vcage.schema.plan import LayoutPlan, Relation
from vcage.schema.scene import Workspace

GROUND = ground_box(Workspace(lower=(-0.45, -0.3), upper=(0.45, 0.3)), 0.74)
PHRASES = {"white": "white plate", "blue": "blue plate"}


def said(subject: str, relation: str, reference: str, part: str | None = None) -> Description:
    return Description(subject=subject, relation=relation, reference=reference, part=part, words="as I said")


def box(x: float, y: float, z: float = 0.74, size: tuple = (0.1, 0.1, 0.05)) -> np.ndarray:
    half = np.array(size) / 2
    return np.array([[x - half[0], y - half[1], z], [x + half[0], y + half[1], z + size[2]]])


def test_a_description_is_false_in_the_mirrored_layout():
    left = said("white", "left_of", "blue")
    assert false_descriptions([left], {"white": box(-0.2, 0), "blue": box(0.1, 0)}, GROUND) == []
    assert false_descriptions([left], {"white": box(0.2, 0), "blue": box(0.1, 0)}, GROUND) == [left]


def test_a_side_of_the_table_needs_no_other_object():
    left = said("white", "left_of", "table")
    assert false_descriptions([left], {"white": box(-0.3, 0.1)}, GROUND) == []
    assert false_descriptions([left], {"white": box(-0.1, 0.1)}, GROUND) == [left]


def test_drawer_contents_lie_in_the_drawer_s_box_not_the_cabinet_s():
    pen, boxes = said("pen", "inside", "cabinet", "drawer_top"), {"cabinet": box(0, 0, size=(0.3, 0.3, 0.3))}
    drawer = {"cabinet/drawer_top": box(0, 0, 0.9, (0.25, 0.25, 0.06))}
    in_it, below = {"pen": box(0, 0, 0.91, (0.1, 0.02, 0.02))}, {"pen": box(0, 0, 0.76, (0.1, 0.02, 0.02))}
    assert false_descriptions([pen], {**boxes, **drawer, **in_it}, GROUND) == []
    assert false_descriptions([pen], {**boxes, **drawer, **below}, GROUND) == [pen]


def test_a_description_with_an_unknown_object_is_an_error():
    with pytest.raises(UnknownName, match="cup"):
        false_descriptions([said("cup", "left_of", "white")], {"white": box(0, 0)}, GROUND)


def test_false_facts_are_put_in_plain_words_beside_the_instruction():
    (text,) = false_in_words([said("white", "left_of", "blue")], PHRASES)
    assert text == "it is not so that the white plate is to the left of the blue plate ('as I said')"


@pytest.mark.parametrize(
    ("description", "text"),
    [
        (said("white", "behind", "table"), "the white plate is at the back of the table"),
        (said("white", "center", "table"), "the white plate is in the middle of the table"),
        (said("white", "inside", "blue", "drawer_top"), "the white plate is inside the top drawer of the blue plate"),
    ],
)
def test_a_description_is_a_sentence(description, text):
    assert in_words(description, PHRASES) == text


@pytest.mark.parametrize(
    ("goal", "text"),
    [
        (Goal(subject="white", relation="on", reference="table"), "the white plate is on the table"),
        (Goal(subject="desk", relation="open", part="drawer_top"), "the top drawer of the desk is open"),
        (Goal(subject="white", relation="handed", reference="left"), "the white plate was handed to the left arm"),
        (Goal(subject="white", relation="back"), "the white plate is back where it stood"),
    ],
)
def test_a_goal_is_a_sentence(goal, text):
    assert goal_in_words(goal, PHRASES) == text


def test_a_plan_gets_the_descriptions_that_it_lacks_and_says_them():
    near = Relation(subject="white", relation="near", reference="blue")
    plan = LayoutPlan(text="Two plates.", relations=[near])
    found = with_descriptions(plan, [said("white", "left_of", "blue")], PHRASES)
    assert found.relations == [near, *described_relations([said("white", "left_of", "blue")])]
    assert found.text == "Two plates. The white plate is to the left of the blue plate."
    assert with_descriptions(found, [said("white", "left_of", "blue")], PHRASES) == found


def test_a_plan_does_not_distinguish_inside_from_on_and_ignores_drawers():
    plan = LayoutPlan(text="x", relations=[Relation(subject="white", relation="on", reference="blue")])
    told = [said("white", "inside", "blue"), said("pen", "inside", "desk", "drawer_top")]
    assert with_descriptions(plan, told, PHRASES) == plan
