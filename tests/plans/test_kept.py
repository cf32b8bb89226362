from __future__ import annotations

from typing import get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.models.tabletop import BLOCKS, PLATE, scene_of
from vcage.base.errors import UnknownName
from vcage.plans.check import contradictions
from vcage.plans.kept import relations_kept, relations_kept_in
from vcage.plans.relations import ground_box, hold, holds, holds_on_table, plane_gap
from vcage.schema.plan import Relation, RelationWord
from vcage.schema.scene import Workspace

GROUND = ground_box(Workspace(lower=(-0.45, -0.3), upper=(0.45, 0.3)), 0.74)


def box(x: float, y: float, z: float = 0.74, size=(0.1, 0.1, 0.05)) -> np.ndarray:
    half = np.array(size) / 2
    return np.array([[x - half[0], y - half[1], z], [x + half[0], y + half[1], z + size[2]]])


def rel(subject: str, relation: str, reference: str) -> Relation:
    return Relation(subject=subject, relation=relation, reference=reference)


@pytest.mark.parametrize(
    ("relation", "x", "y"),
    [("left_of", -0.2, 0.1), ("right_of", 0.2, -0.1), ("in_front_of", 0.1, -0.2), ("behind", 0.0, 0.2)],
)
def test_directions_are_as_the_robot_sees_them(relation, x, y):
    assert holds(relation, box(x, y), box(0, 0))
    assert not holds(relation, box(-x, -y), box(0, 0))


def test_a_direction_beyond_the_cone_does_not_hold():
    assert not holds("left_of", box(-0.1, 0.3), box(0, 0))


def test_a_direction_needs_the_centre_beyond_the_edge():
    assert not holds("left_of", box(-0.15, 0), box(0, 0, size=(0.4, 0.1, 0.05)))


@given(x=st.floats(-0.5, 0.5), y=st.floats(-0.3, 0.3))
def test_an_object_is_never_on_both_sides(x, y):
    subject, reference = box(x, y), box(0, 0)
    assert not (holds("left_of", subject, reference) and holds("right_of", subject, reference))
    assert not (holds("in_front_of", subject, reference) and holds("behind", subject, reference))
    assert holds("left_of", subject, reference) == holds("right_of", reference, subject)


def test_inside_needs_containment_in_the_plane_and_a_bottom_between():
    container = box(0, 0, size=(0.3, 0.3, 0.1))
    assert holds("inside", box(0.05, 0, 0.75), container)
    assert not holds("inside", box(0.13, 0, 0.75), container)
    assert not holds("inside", box(0, 0, 0.86), container)


def test_on_needs_the_centre_over_the_reference_and_contact():
    plate = box(0, 0, size=(0.2, 0.2, 0.02))
    assert holds("on", box(0.08, 0, 0.75), plate)
    assert holds("on", box(0, 0, 0.765), plate)
    assert not holds("on", box(0, 0, 0.80), plate)
    assert not holds("on", box(0.12, 0, 0.75), plate)


def test_beside_is_closer_than_near_and_neither_overlaps():
    reference = box(0, 0)
    assert holds("beside", box(0.15, 0), reference) and holds("near", box(0.15, 0), reference)
    assert holds("near", box(0.25, 0), reference) and not holds("beside", box(0.25, 0), reference)
    assert not holds("near", box(0.35, 0), reference)
    assert not holds("beside", box(0.05, 0), reference)


def test_the_centre_of_the_table_is_its_middle():
    assert holds_on_table("center", box(0.1, 0.05), GROUND)
    assert not holds_on_table("center", box(0.3, 0), GROUND)


@pytest.mark.parametrize(
    ("relation", "x", "y"), [("left_of", -0.3, 0), ("right_of", 0.3, 0), ("in_front_of", 0, -0.2), ("behind", 0, 0.2)]
)
def test_a_side_of_the_table_is_its_outer_third(relation, x, y):
    assert holds_on_table(relation, box(x, y), GROUND)
    assert holds_on_table(relation, box(x - y, y - x), GROUND), "its corners are on that side too"
    assert not holds_on_table(relation, box(x / 4, y / 4), GROUND)
    assert not holds_on_table(relation, box(-x, -y), GROUND)


def test_nothing_is_beside_the_table():
    with pytest.raises(ValueError, match="beside"):
        holds_on_table("beside", box(0, 0), GROUND)


def test_an_unknown_word_is_an_error():
    with pytest.raises(ValueError, match="under"):
        holds("under", box(0, 0), box(0, 0))


def test_the_gap_is_euclidean_and_negative_in_overlap():
    assert plane_gap(box(0, 0), box(0.13, 0.14)) == pytest.approx(0.05)
    assert plane_gap(box(0, 0), box(0.08, 0)) == pytest.approx(-0.02)


def test_kept_relations_are_counted_and_broken_ones_named():
    boxes = {"a": box(-0.2, 0), "b": box(0.0, 0)}
    relations = [rel("a", "left_of", "b"), rel("a", "behind", "b"), rel("b", "center", "table")]
    kept = relations_kept(relations, boxes, GROUND)
    assert kept.share == pytest.approx(2 / 3)
    assert kept.broken == [relations[1]]


def test_relations_of_a_scene_match_its_boxes():
    scene = scene_of([PLATE, *BLOCKS])
    relations = [rel("red-block", "left_of", "plate"), rel("red-block", "right_of", "plate")]
    assert relations_kept_in(scene, relations).sentences == ["red-block right_of plate"]


def test_a_plan_without_relations_is_kept():
    assert relations_kept([], {}, GROUND).share == 1.0


def test_an_object_without_a_box_is_named():
    with pytest.raises(UnknownName, match="cup"):
        relations_kept([rel("cup", "near", "a")], {"a": box(0, 0)}, GROUND)


@pytest.mark.parametrize("word", get_args(RelationWord))
def test_a_box_of_nans_stands_in_no_relation(word):
    assert not holds(word, np.full((2, 3), np.nan), box(0, 0))
    assert not holds(word, box(0, 0), np.full((2, 3), np.nan))


@pytest.mark.parametrize("word", get_args(RelationWord))
def test_many_boxes_at_once_are_judged_as_one_by_one(word):
    many = np.stack([box(x, y, z) for x in (-0.3, -0.05, 0.0, 0.12) for y in (-0.2, 0.0, 0.15) for z in (0.74, 0.9)])
    assert hold(word, many, box(0, 0)).tolist() == [holds(word, one, box(0, 0)) for one in many]


def test_relations_that_contradict_are_the_matter_of_the_plans_check():
    assert contradictions([rel("a", "near", "a")])
