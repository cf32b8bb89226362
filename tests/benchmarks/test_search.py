"""How the search benchmark counts reasons."""

from __future__ import annotations

import pytest

from benchmarks.search import OBJECTS, kinds_of_reasons, run
from tests.example_scenes import block_and_plate
from vcage.schema.subtasks import Refusal
from vcage.tasks.search import FoundSubtasks


def test_reasons_are_grouped_regardless_of_names_and_sizes() -> None:
    objects = block_and_plate()
    block, plate = (o.record.phrase for o in objects)
    reasons = [
        f"{block} (4.0 × 4.0 cm) does not fit on {plate} at 'middle'",
        f"{plate} (21 × 20.5 cm) does not fit on {block} at 'top'",
        f"{block} has no place to put something in or on",
    ]
    refused = [Refusal(template="place", object="block", receptacle="plate", reason=reason) for reason in reasons]
    kinds = kinds_of_reasons(objects, FoundSubtasks([], refused, 3))
    assert dict(kinds) == {"… (N × N cm) does not fit on … at …": 2, "… has no place to put something in or on": 1}


@pytest.mark.slow
def test_the_refusals_of_a_large_scene_are_counted_by_kind() -> None:
    figures = run(quick=True)
    (row,) = figures["rows"]
    assert row["objects"] == OBJECTS and row["kept"] > 0 and row["refused"] >= sum(figures["reasons"].values()) > 0
