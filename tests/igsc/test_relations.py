from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vcage.igsc.relations import contradictions, holds, plane_gap, relations_kept, table_box
from vcage.schema.plan import Relation
from vcage.schema.scene import Table


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
    table = table_box(Table())
    assert holds("center", box(0.1, 0.05), table)
    assert not holds("center", box(0.3, 0), table)


def test_an_unknown_word_is_an_error():
    with pytest.raises(ValueError, match="under"):
        holds("under", box(0, 0), box(0, 0))


def test_the_gap_is_euclidean_and_negative_in_overlap():
    assert plane_gap(box(0, 0), box(0.13, 0.14)) == pytest.approx(0.05)
    assert plane_gap(box(0, 0), box(0.08, 0)) == pytest.approx(-0.02)


def test_kept_relations_are_counted_and_broken_ones_named():
    boxes = {"a": box(-0.2, 0), "b": box(0.0, 0)}
    relations = [rel("a", "left_of", "b"), rel("a", "behind", "b"), rel("b", "center", "table")]
    kept = relations_kept(relations, boxes, Table())
    assert kept.share == pytest.approx(2 / 3)
    assert kept.broken == [relations[1]]


def test_a_possible_plan_has_no_contradictions():
    plan = [rel("a", "left_of", "b"), rel("b", "left_of", "c"), rel("c", "right_of", "a"), rel("d", "inside", "c")]
    assert contradictions([*plan, rel("b", "center", "table"), rel("e", "in_front_of", "a")]) == []


@pytest.mark.parametrize(
    ("relations", "words"),
    [
        ([("a", "left_of", "b"), ("b", "left_of", "a")], "circle"),
        ([("a", "left_of", "b"), ("b", "left_of", "c"), ("a", "right_of", "c")], "circle"),
        ([("a", "behind", "b"), ("a", "in_front_of", "b")], "circle"),
        ([("a", "inside", "b"), ("b", "on", "a")], "circle"),
        ([("a", "inside", "b"), ("a", "on", "c")], "both b and c"),
        ([("a", "inside", "b"), ("a", "beside", "b")], "beside it"),
        ([("a", "center", "table"), ("b", "center", "table")], "both be in the center"),
        ([("a", "near", "a")], "itself"),
        ([("table", "on", "a")], "the table cannot"),
        ([("a", "left_of", "table")], "only 'center'"),
    ],
)
def test_contradictions_are_found(relations, words):
    found = contradictions([rel(*r) for r in relations])
    assert len(found) == 1
    assert words in found[0]
