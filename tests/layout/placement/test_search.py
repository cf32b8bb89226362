"""The search: dense planes are packed, loose ones scattered at any heading, and both look random."""

from __future__ import annotations

import numpy as np
import pytest

from tests.layout.items import unplaced
from vcage.base.geometry import boxes_overlap
from vcage.layout.items import TableItem
from vcage.layout.placement.arrangement import Arrangement, Spot
from vcage.layout.placement.plane import Plane, make_plane
from vcage.layout.placement.search import arrange, pack_in_corners

YAWS = tuple(np.radians(range(-180, 180, 15)))


def plane(items: list[TableItem], width: float, depth: float, margin: float = 0.01) -> Plane:
    bounds = np.array([[0, 0], [width, depth]], dtype=float)
    return make_plane(items, bounds, margin, np.empty((0, 2, 2)), lambda _item, _yaw: ())


def test_headings_that_need_the_same_room_are_one_stance():
    rectangle, square = (plane([unplaced("a", size, YAWS)], 1, 1).stances[0] for size in ((0.2, 0.1), (0.1, 0.1)))
    assert [len(stance.yaws) for stance in rectangle] == [2, 2, 4, 4, 4, 4, 4]
    assert sorted(len(stance.yaws) for stance in square) == [4, 4, 8, 8]
    assert rectangle[0].area == pytest.approx(0.02)


def test_with_room_to_spare_every_heading_comes_up():
    loose = plane([unplaced("a", (0.2, 0.1), YAWS)], 2, 2)
    found = {round(arrange(loose, np.random.default_rng(seed)).spots[0].yaw, 6) for seed in range(200)}
    assert found == {round(yaw, 6) for yaw in YAWS}


def test_without_room_to_spare_the_small_headings_are_taken():
    tight = plane([unplaced(f"o{k}", (0.2, 0.1), YAWS) for k in range(9)], 0.62, 0.32)
    outcome = arrange(tight, np.random.default_rng(0))
    assert outcome.left == []
    assert all(abs(np.sin(2 * spot.yaw)) < 1e-9 for spot in outcome.spots.values())


def test_a_guillotine_cut_sheet_is_packed_again():
    # Pieces of a 1.2 x 0.8 sheet, so they fill 93 % of what 1.25 x 0.83 has.
    sizes = [(0.5, 0.3), (0.5, 0.5), (0.4, 0.45), (0.4, 0.35), (0.3, 0.2), (0.3, 0.6)]
    tight = plane([unplaced(f"p{k}", size, (0.0, np.pi / 2)) for k, size in enumerate(sizes)], 1.25, 0.83, margin=0.0)
    assert pack_in_corners(tight, 200, np.random.default_rng(0)).left == []


def test_packed_objects_are_shaken():
    tight = plane([unplaced(f"o{k}", (0.2, 0.1), YAWS) for k in range(9)], 0.66, 0.36)
    first, second = (arrange(tight, np.random.default_rng(seed)).spots for seed in (0, 1))
    assert np.mean([np.linalg.norm(first[k].centre - second[k].centre) for k in first]) > 0.02


def test_packing_leaves_out_the_fewest_objects_of_all_tries():
    crowded = plane([unplaced(f"o{k}", (0.3, 0.3)) for k in range(5)], 0.62, 0.62)
    outcome = pack_in_corners(crowded, 5, np.random.default_rng(0))
    assert len(outcome.left) == 1 and len(outcome.spots) == 4


def test_an_empty_plane_is_solved():
    assert arrange(plane([], 1, 1), np.random.default_rng(0)).spots == {}


def test_conflicts_are_pairs_too_close_together():
    arrangement = Arrangement(plane([unplaced(x, (0.1, 0.1)) for x in "abc"], 1, 1))
    (stance,) = arrangement.plane.stances[0]
    for k, centre in enumerate([(0.2, 0.2), (0.5, 0.5), (0.8, 0.8)]):
        arrangement.put(k, Spot(stance, np.array(centre), 0.0))
    tried = np.array([[0.2, 0.2], [0.5, 0.395], [0.5, 0.385], [0.65, 0.65]])
    hits = arrangement.conflicts(0, stance, tried)
    boxes = [np.array([c - stance.half, c + stance.half]) for c in np.array([[0.2, 0.2], [0.5, 0.5], [0.8, 0.8]])]
    for centre, row in zip(tried, hits, strict=True):
        box = np.array([centre - stance.half, centre + stance.half])
        assert row.tolist() == [k != 0 and boxes_overlap(box, boxes[k], 0.01) for k in range(3)]
