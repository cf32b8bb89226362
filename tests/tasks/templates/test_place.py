"""Placing, and its kin: stacking flush, and weighing."""

from __future__ import annotations

import numpy as np

from tests.scenes import GROUND, kinematics, thing
from vcage.schema.goals import Goal
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.templates.place import stands_flush

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


def test_what_is_weighed_lies_on_the_scale_and_waits_there() -> None:
    bar = thing("chocolate_bar", (-0.2, 0.0))
    (pair,), _ = TEMPLATES["weigh"].proposals([bar, SCALE], ())
    subtask, _ = pair.examine([bar, SCALE], kinematics(), GROUND, np.random.default_rng(0))
    assert subtask is not None
    assert subtask.goals == [
        Goal(subject=bar.id, relation="weighed"),
        Goal(subject=bar.id, relation="on", reference=SCALE.id),
    ]
    assert any(call.startswith("task.wait(") for call in TEMPLATES["weigh"].calls(subtask))
    assert len({subtask.text, *subtask.texts}) >= 10
