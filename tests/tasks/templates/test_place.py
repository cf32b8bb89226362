"""Placing, and its kin: stacking flush, and weighing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.example_scenes import thing, workplace
from vcage.base.errors import InfeasibleScene
from vcage.schema.goals import Goal
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import allocate, stands_flush
from vcage.tasks.templates import TEMPLATES

SCALE = thing("electronic_scale", (0.1, 0.05))


def pairs(template: str, *objects: SceneObject) -> set[tuple[str, str]]:
    found, _ = TEMPLATES[template].proposals(objects, ())  # pyrefly: ignore
    return {(pair.thing.id, pair.receptacle.id) for pair in found}


def test_a_pair_that_stands_flush_is_stacked_and_not_placed() -> None:
    low, high, plate = thing("block", (-0.2, 0), id="low"), thing("block", (-0.3, 0), id="high"), thing("plate")
    assert {("low", "high"), ("high", "low")} <= pairs("stack", low, high, plate)
    assert pairs("place", low, high, plate) == {("low", plate.id), ("high", plate.id)}


def test_only_a_scale_weighs() -> None:
    assert pairs("weigh", thing("block"), thing("plate"), SCALE) == {("block", SCALE.id)}


def test_a_block_stands_flush_on_a_block_and_not_on_a_plate() -> None:
    block, plate = thing("block"), thing("plate")
    assert stands_flush(block, thing("block", id="other"), block.asset.annotation.functional_point(0))
    assert not stands_flush(block, plate, plate.asset.annotation.functional_point(0))


def test_an_object_that_leaves_no_room_for_the_robot_is_refused_with_both_sizes() -> None:
    box, block = thing("packaging_box"), thing("block", (0.3, 0.0))
    width, depth = box.asset.opening(box.asset.annotation.functional_point(0)).size
    half = (width / 2 - 0.001, depth / 2 - 0.001)
    model = block.asset.model.model_copy(update={"lower": (-half[0], -half[1], 0.0), "upper": (*half, 0.04)})
    plank = replace(block, asset=replace(block.asset, model=model))
    (pair,) = (p for p in TEMPLATES["place"].proposals([plank, box], ())[0] if p.thing is plank)
    refusal = pair.impossible()
    assert refusal is not None and (refusal.receptacle, refusal.functional_point) == (box.id, 0)
    assert "cm) fits in brown packaging box" in refusal.reason and "less than the 6 mm on each side" in refusal.reason


def test_a_weighed_object_lies_on_the_scale_and_waits_there() -> None:
    bar = thing("chocolate_bar", (-0.2, 0.0))
    (pair,), _ = TEMPLATES["weigh"].proposals([bar, SCALE], ())
    subtask, _ = pair.examine(workplace([bar, SCALE]))
    assert subtask is not None
    assert subtask.goals == [
        Goal(subject=bar.id, relation="weighed"),
        Goal(subject=bar.id, relation="on", reference=SCALE.id),
    ]
    assert any(call.startswith("task.wait(") for call in TEMPLATES["weigh"].calls(subtask))
    assert len({subtask.text, *subtask.texts}) >= 10


def test_a_bowl_goes_into_a_bowl_of_its_kind_where_it_nests() -> None:
    lower, upper = thing("small_bowl", id="lower"), thing("small_bowl", (0.3, 0.0), id="upper")
    pair = next(p for p in TEMPLATES["place"].proposals([lower, upper], ())[0] if p.thing is upper)
    assert pair.impossible() is None
    point = lower.asset.annotation.functional_point(0)
    place = allocate(lower, 0, [upper], np.random.default_rng(0))["upper"]
    assert place.p[2] == lower.asset.nested_height(upper.asset, point) > point.position[2]


def test_a_bowl_nests_in_no_bowl_that_holds_something() -> None:
    lower, upper = thing("small_bowl", id="lower"), thing("small_bowl", (0.3, 0.0), id="upper")
    lemon = thing("lemon", container="lower")
    with pytest.raises(InfeasibleScene, match="only where nothing else lies, not yellow lemon"):
        allocate(lower, 0, [upper], np.random.default_rng(0), [lemon])


def test_what_is_put_in_a_compartment_is_in_it_and_in_the_whole() -> None:
    book, caddy = thing("standing_book", (-0.3, 0.0)), thing("desk_caddy")
    found = {p.goal.part: p for p in TEMPLATES["place"].proposals([book, caddy], ())[0]}
    assert {*found} == {f"compartment_{side}" for side in ("front", "back", "left", "right")}
    left = found["compartment_left"]
    assert left.impossible() is None
    assert left.goals == [left.goal, Goal(subject=book.id, relation="inside", reference=caddy.id)]


def test_a_goal_that_names_no_compartment_means_any() -> None:
    book, caddy = thing("standing_book", (-0.3, 0.0)), thing("desk_caddy")
    anywhere = Goal(subject=book.id, relation="inside", reference=caddy.id)
    found, _ = TEMPLATES["place"].proposals([book, caddy], [anywhere])
    assert [pair.goal for pair in found] == [anywhere] * 4
