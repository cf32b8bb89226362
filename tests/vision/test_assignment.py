from __future__ import annotations

import numpy as np

from vcage.vision.assignment import assign


def spot(u: int, v: int) -> np.ndarray:
    mask = np.zeros((120, 160), bool)
    mask[v : v + 24, u : u + 24] = True
    return mask


LEFT, RIGHT = spot(10, 10), spot(100, 60)


def test_all_pairs_together_beat_the_greedy_ones() -> None:
    chosen = assign([[LEFT, RIGHT], [LEFT]], [np.array([5.0, 4.0]), np.array([4.5])])
    assert {i: c.index for i, c in chosen.items()} == {0: 1, 1: 0}


def test_an_object_without_a_likely_place_stays_unassigned() -> None:
    assert assign([[LEFT]], [np.array([-0.1])]) == {}


def test_no_two_objects_get_the_same_place() -> None:
    chosen = assign([[LEFT], [spot(12, 12)]], [np.array([3.0]), np.array([2.0])])
    assert list(chosen) == [0]


def test_another_object_that_wants_the_place_lowers_the_confidence() -> None:
    alone = assign([[LEFT]], [np.array([3.0])])[0]
    contested = assign([[LEFT], [LEFT]], [np.array([3.0]), np.array([2.8])])[0]
    assert contested.confidence < alone.confidence


def test_an_object_that_fits_as_well_at_a_free_place_has_a_twin() -> None:
    assert assign([[LEFT, RIGHT]], [np.array([5.0, 4.5])])[0].twin == 1
    assert assign([[LEFT, RIGHT]], [np.array([5.0, 0.5])])[0].twin is None


def test_no_candidates_give_no_places() -> None:
    assert assign([[], []], [np.zeros(0), np.zeros(0)]) == {}
