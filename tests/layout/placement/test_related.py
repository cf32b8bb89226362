"""Placements that keep relations."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest

from tests.layout.items import unplaced
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import boxes_overlap, footprint_half_size
from vcage.layout.items import ANY_YAW, Placement, TableItem
from vcage.layout.placement.place import place
from vcage.objects.openings import Opening
from vcage.plans.relations import hold_on_table, holds
from vcage.schema.goals import RelationWord
from vcage.schema.plan import Relation

WORKSPACE = np.array([[-0.45, -0.22], [0.45, 0.2]])
SIDES = ("left_of", "right_of", "in_front_of", "behind")
PLATES = [unplaced("a", (0.2, 0.2), ANY_YAW), unplaced("b", (0.18, 0.22), ANY_YAW)]
CLUTTER = [unplaced(f"c{k}", (0.08, 0.05), ANY_YAW) for k in range(4)]


def rel(subject: str, relation: str, reference: str) -> Relation:
    return Relation(subject=subject, relation=relation, reference=reference)


def rectangle(item: TableItem, at: Placement) -> np.ndarray:
    half = footprint_half_size(np.array(item.size[:2]), at.yaw)
    return np.array([[at.x, at.y], [at.x, at.y]]) + np.stack([-half, half])


def rectangles(items: list[TableItem], seed: int, *relations: Relation) -> dict[str, np.ndarray]:
    spots = place(items, WORKSPACE, np.random.default_rng(seed), relations=relations)
    return {item.id: rectangle(item, spots[item.id]) for item in items}


@pytest.mark.parametrize("word", [w for w in get_args(RelationWord) if w not in ("inside", "on", "center")])
def test_a_relation_between_two_holds_in_every_placement(word):
    small = [unplaced("a", (0.1, 0.1), ANY_YAW), unplaced("b", (0.08, 0.1), ANY_YAW)]
    for seed in range(20):
        found = rectangles([*small, *CLUTTER], seed, rel("a", word, "b"))
        assert holds(word, found["a"], found["b"])
        boxes = list(found.values())
        assert not any(boxes_overlap(p, q, 0.009) for k, p in enumerate(boxes) for q in boxes[:k])


@pytest.mark.parametrize("word", [*SIDES, "center"])
def test_a_third_of_the_table_is_kept_to(word):
    for seed in range(20):
        found = rectangles([unplaced("a", (0.1, 0.1), ANY_YAW), *CLUTTER], seed, rel("a", word, "table"))
        assert hold_on_table(word, found["a"], WORKSPACE)


def test_a_row_of_three_stands_from_left_to_right_and_is_not_always_the_same():
    row = [unplaced(name, (0.1, 0.1), ANY_YAW) for name in "abc"]
    found = [rectangles(row, seed, rel("a", "left_of", "b"), rel("b", "left_of", "c")) for seed in range(20)]
    assert all(f["a"][1, 0] < f["b"].mean(axis=0)[0] < f["c"][0, 0] + 0.1 for f in found)
    assert np.std([f["b"].mean(axis=0)[0] for f in found]) > 0.05


def test_large_plates_find_their_sides_although_the_first_may_leave_no_room():
    for seed in range(20):
        found = rectangles([*PLATES, *CLUTTER], seed, rel("a", "left_of", "b"))
        assert holds("left_of", found["a"], found["b"])


def test_contents_are_where_their_bowl_is():
    bowl = unplaced("bowl", (0.2, 0.2), opening=Opening((0.0, 0.0), (0.18, 0.18), 0.01, 0.05))
    apple, cup = unplaced("apple", (0.06, 0.06), inside="bowl"), unplaced("cup", (0.08, 0.08))
    for seed in range(10):
        found = rectangles([bowl, apple, cup], seed, rel("apple", "right_of", "cup"))
        assert holds("right_of", found["apple"], found["cup"])


def test_moving_parts_that_sweep_the_table_do_not_shift_where_a_thing_is():
    body = np.array([[-0.1, -0.05], [0.1, 0.15]])  # and a drawer that comes out in front of it
    cabinet = TableItem("a", (0.2, 0.35, 0.2), (0.0,), centre=(0.0, -0.025), body=body)
    for seed in range(10):
        spots = place([cabinet], WORKSPACE, np.random.default_rng(seed), relations=[rel("a", "center", "table")])
        own = body + cabinet.pose(spots["a"], 0.0).p[:2]
        assert hold_on_table("center", own, WORKSPACE)


def test_a_circle_of_relations_has_no_placement():
    with pytest.raises(InfeasibleScene):
        rectangles(PLATES, 0, rel("a", "left_of", "b"), rel("b", "left_of", "a"))
