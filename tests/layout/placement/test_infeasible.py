"""The report when there is no place: objects, missing room, and ways out that work when tried."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.layout.items import unplaced
from vcage.base.errors import InfeasibleScene
from vcage.layout.items import TableItem
from vcage.layout.placement.place import place

WORKSPACE = np.array([[-0.5, -0.3], [0.5, 0.3]])
YAWS = (0.0, np.pi / 4, np.pi / 2)


def refusal(items, workspace=WORKSPACE, **options) -> InfeasibleScene:
    with pytest.raises(InfeasibleScene) as caught:
        place(items, workspace, np.random.default_rng(0), **options)
    return caught.value


def crowd(seed: int, count: int) -> list[TableItem]:
    rng = np.random.default_rng(seed)
    return [unplaced(f"o{k}", tuple(rng.uniform(0.15, 0.4, 2)), YAWS) for k in range(count)]


@settings(max_examples=6, deadline=None, derandomize=True)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(12, 16))
def test_both_ways_out_hold_when_they_are_tried(seed, count):
    items = crowd(seed, count)
    details = refusal(items).details
    kept = [item for item in items if item.id not in details["drop"]]
    assert 0 < len(kept) < len(items)
    assert len(place(kept, WORKSPACE, np.random.default_rng(1))) == len(kept)
    larger = WORKSPACE + np.outer((-0.5, 0.5), details["enlarge_m"])
    assert len(place(items, larger, np.random.default_rng(1))) == len(items)


@settings(max_examples=6, deadline=None, derandomize=True)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(12, 16))
def test_some_area_is_always_missing(seed, count):
    error = refusal(crowd(seed, count))
    assert error.details["missing_area_m2"] > 0
    assert "m² are missing" in error.message and " 0.0000 m²" not in error.message


def test_the_same_scene_gets_the_same_answer():
    first, second = (refusal(crowd(5, 14)) for _ in range(2))
    assert first.as_record() == second.as_record()


def test_the_hint_names_the_objects_to_drop_and_the_workspace_needed():
    # Three squares of more than half the depth fit side by side only, and need 1.04 m for that.
    error = refusal([unplaced(f"crate{k}", (0.34, 0.34)) for k in range(3)])
    assert error.details["drop"] == ["crate2"]
    assert 0.04 <= error.details["enlarge_m"][0] <= 0.08
    assert "drop crate2 (the other 2 fit)" in error.hint and "larger (then all fit)" in error.hint


def test_an_object_too_long_by_a_millimetre_is_reported_as_such():
    error = refusal([unplaced("rod", (1.001, 0.02))])
    assert "too large by 0.001 m along x" in error.message
    assert error.details["missing_area_m2"] == pytest.approx(0.001 * 0.02)
    assert error.details["enlarge_m"][0] >= 0.001


@pytest.mark.parametrize(
    ("item", "reason"),
    [
        (unplaced("cup", (0.1, 0.1), allowed=[]), "where an arm reaches it"),
        (unplaced("cup", (0.1, 0.1), within=[[[0, 0], [0.09, 1]]]), "where all of it is seen"),
        (unplaced("cup", (0.1, 0.1), allowed=[[[2, 2], [3, 3]]], within=[]), "reaches it and where all of it is seen"),
    ],
    ids=["reach", "view", "both"],
)
def test_a_limit_that_leaves_nothing_is_named_and_growing_is_not_advised(item, reason):
    error = refusal([item])
    assert reason in error.message and "missing" in error.message
    assert error.details["enlarge_m"] is None and "larger" not in error.hint


def test_an_object_in_the_way_is_named():
    error = refusal([unplaced("cup", (0.1, 0.1))], obstacles=[WORKSPACE])
    assert "beside what stands there already" in error.message
