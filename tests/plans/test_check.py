from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.models.tabletop import BLOCKS, PLATE, scene_of
from vcage.base.graphs import circles, longest_path
from vcage.plans.check import contradictions, plan_complaints
from vcage.schema.goals import Description
from vcage.schema.plan import LayoutPlan, Relation


def plan(*triples: tuple[str, str, str]) -> list[Relation]:
    return [Relation(subject=s, relation=r, reference=o) for s, r, o in triples]


def test_a_possible_plan_has_no_contradictions():
    triples = [("a", "left_of", "b"), ("b", "left_of", "c"), ("c", "right_of", "a"), ("d", "inside", "c")]
    assert contradictions(plan(*triples, ("b", "center", "table"), ("e", "in_front_of", "a"))) == []


@pytest.mark.parametrize(
    ("relations", "words"),
    [
        ([("a", "left_of", "b"), ("b", "left_of", "a")], "a left of b left of a: that is a circle"),
        ([("a", "left_of", "b"), ("b", "left_of", "c"), ("a", "right_of", "c")], "circle"),
        ([("a", "left_of", "b"), ("c", "right_of", "b"), ("d", "right_of", "c"), ("d", "left_of", "a")], "circle"),
        ([("a", "behind", "b"), ("a", "in_front_of", "b")], "circle"),
        ([("a", "inside", "b"), ("b", "on", "a")], "circle"),
        ([("a", "inside", "b"), ("b", "inside", "c"), ("c", "on", "a")], "circle"),
        ([("a", "inside", "b"), ("a", "on", "c")], "both b and c"),
        ([("a", "inside", "b"), ("a", "on", "table")], "both b and table"),
        ([("a", "inside", "b"), ("a", "beside", "b")], "beside it"),
        ([("a", "inside", "b"), ("b", "near", "a")], "lies in or on it"),
        ([("a", "inside", "b"), ("b", "inside", "c"), ("a", "left_of", "c")], "left_of it"),
        ([("a", "inside", "b"), ("a", "left_of", "c"), ("b", "right_of", "c")], "b left of c left of b"),
        ([("a", "center", "table"), ("b", "center", "table")], "both be in the center"),
        ([("a", "near", "a")], "itself"),
        ([("table", "on", "a")], "the table cannot"),
        ([("a", "beside", "table")], "only center, on, left_of"),
        ([("a", "left_of", "table"), ("a", "center", "table")], "both left_of and center the table"),
        ([("a", "left_of", "table"), ("a", "right_of", "table")], "both left_of and right_of the table"),
        ([("a", "right_of", "table"), ("b", "left_of", "table"), ("a", "left_of", "b")], "cannot be left_of"),
        (
            [("a", "behind", "table"), ("a", "in_front_of", "c"), ("c", "in_front_of", "b"), ("b", "center", "table")],
            "cannot be in_front_of what leads to b",
        ),
    ],
)
def test_contradictions_are_found(relations, words):
    found = contradictions(plan(*relations))
    assert len(found) == 1
    assert words in found[0]


def test_every_circle_is_named_at_once():
    triples = [("a", "left_of", "b"), ("b", "left_of", "a"), ("c", "left_of", "d"), ("d", "left_of", "c")]
    assert len(contradictions(plan(*triples, ("a", "behind", "c"), ("c", "behind", "a")))) == 3


def test_contents_of_one_container_are_ordered_by_themselves():
    triples = [("a", "inside", "t"), ("b", "inside", "t"), ("a", "left_of", "b"), ("t", "center", "table")]
    assert contradictions(plan(*triples)) == []
    assert "circle" in contradictions(plan(*triples, ("b", "left_of", "a")))[0]


def test_a_content_may_be_in_the_centre_with_its_container():
    assert contradictions(plan(("a", "inside", "b"), ("a", "center", "table"), ("b", "center", "table"))) == []


def test_a_repeated_statement_is_no_contradiction():
    assert contradictions(plan(("a", "center", "table"), ("a", "center", "table"))) == []


def test_a_plan_must_name_all_objects_and_no_others():
    scene = scene_of([PLATE, *BLOCKS])
    complaints = plan_complaints(LayoutPlan(text=" ", relations=plan(("plate", "left_of", "cup"))), scene)
    assert complaints == [
        "text: is empty", "there is no object 'cup'", "nothing says where red-block, green-block, blue-block go",
    ]  # fmt: skip


def test_a_hopeless_plan_is_not_complained_about_without_end():
    scene = scene_of([PLATE])
    nonsense = plan(*((f"o{i}", "near", "plate") for i in range(50)))
    complaints = plan_complaints(LayoutPlan(text="x", relations=nonsense), scene)
    assert len(complaints) == 21 and complaints[-1] == "and 31 more complaints like these"


def test_an_object_starting_in_another_must_be_planned_there():
    scene = scene_of([PLATE, BLOCKS[0]])
    objects = [scene.objects[0], scene.objects[1].model_copy(update={"container": "plate"})]
    layout = LayoutPlan(text="x", relations=plan(("plate", "center", "table"), ("red-block", "left_of", "plate")))
    complaints = plan_complaints(layout, scene.model_copy(update={"objects": objects}))
    assert complaints == ["red-block lies in or on plate at the start: say that it stays there"]


def test_described_objects_must_be_in_the_plan():
    said = Description(subject="red-block", relation="left_of", reference="plate", words="the left block")
    scene = scene_of([PLATE, BLOCKS[0]]).model_copy(update={"descriptions": [said]})
    triples = [("plate", "center", "table"), ("red-block", "near", "plate")]
    (complaint,) = plan_complaints(LayoutPlan(text="x", relations=plan(*triples)), scene)
    assert "red-block left_of plate" in complaint and "'the left block'" in complaint
    triples += [("red-block", "left_of", "plate")]
    assert plan_complaints(LayoutPlan(text="x", relations=plan(*triples)), scene) == []


def test_drawer_contents_are_not_the_plan_s_to_place():
    scene = scene_of([PLATE, BLOCKS[0]])
    stowed = scene.objects[1].model_copy(update={"container": "plate", "container_part": "drawer_top"})
    scene = scene.model_copy(update={"objects": [scene.objects[0], stowed]})
    triples = [("plate", "center", "table")]
    assert plan_complaints(LayoutPlan(text="x", relations=plan(*triples)), scene) == []
    triples += [("red-block", "near", "plate")]
    (complaint,) = plan_complaints(LayoutPlan(text="x", relations=plan(*triples)), scene)
    assert "top drawer of plate" in complaint and "leave it out" in complaint


def test_the_centre_of_an_object_is_reserved_for_contents():
    assert "without lying in or on it" in contradictions(plan(("a", "center", "b")))[0]
    assert contradictions(plan(("a", "on", "b"), ("a", "center", "b"))) == []


def test_a_thousand_relations_are_checked_without_recursion():
    names = [f"o{i}" for i in range(1001)]
    row = [(a, "left_of", b) for a, b in itertools.pairwise(names)]
    assert contradictions(plan(*row)) == []
    assert len(contradictions(plan(*row, (names[-1], "left_of", names[0])))) == 1
    nest = [(a, "inside", b) for a, b in itertools.pairwise(names)]
    assert contradictions(plan(*nest)) == []


@given(order=st.permutations(list("abcdefg")), edges=st.sets(st.tuples(st.integers(0, 6), st.integers(0, 6))))
def test_relations_that_follow_an_order_make_no_circle(order, edges):
    forwards = [(order[min(e)], order[max(e)]) for e in edges if e[0] != e[1]]
    assert circles(forwards) == []
    if forwards:
        assert len(circles([*forwards, forwards[0][::-1]])) == 1


def test_the_longest_path_counts_edges_and_ends():
    lengths = {("a", "b"): 1.0, ("b", "c"): 1.0, ("a", "c"): 1.5}
    assert longest_path(lengths, {"a": 0.5, "c": 0.25}) == (2.75, ["a", "b", "c"])
    assert longest_path({}, {}) == (0.0, [])
