"""Tools with a pad, over what they wipe."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from tests.example_scenes import thing
from vcage.base.geometry import Pose
from vcage.goals.thresholds import THRESHOLDS
from vcage.tasks.wiping import SETTINGS, Pad, cells_of, farthest, flat_top, free_wiping_ways, under_pad
from vcage.tasks.wiping import wiping_ways as ways_of

SPONGE, BOARD = thing("sponge", (-0.3, 0.0), 0.7), thing("cutting_board", (0.05, 0.05), 0.3)


def share_wiped(tool, way, target) -> float:
    """Share of the cells over which a tool passes on a way."""
    found: set[int] = set()
    for a, b in pairwise(way):
        for share in np.linspace(0, 1, 20):
            found |= {*under_pad(tool.moved(Pose(a.p + share * (b.p - a.p), a.q)), target).tolist()}
    return len(found) / len(cells_of(target))


@pytest.mark.parametrize("tool", ["sponge", "whiteboard_eraser"])
@pytest.mark.parametrize("name", ["cutting_board", "plate", "tray", "coloured_mat", "customer_mat", "book"])
def test_each_way_wipes_enough_of_a_top(tool: str, name: str) -> None:
    held, target = thing(tool, (-0.3, 0.0), 0.7), thing(name, (0.05, 0.05), 0.3)
    ways = [*ways_of(held, target, above_m=0.0)]
    assert ways and all(share_wiped(held, way, target) >= THRESHOLDS.wiped_share for way in ways)


@pytest.mark.parametrize("name", ["mug", "bowl", "apple", "breakfast_tray"])
def test_what_is_deep_or_has_no_flat_place_has_no_flat_top(name: str) -> None:
    assert flat_top(thing(name)) is None and not [*ways_of(SPONGE, thing(name))]


@pytest.mark.parametrize("name", ["block", "coaster"])
def test_a_pad_is_not_drawn_over_a_top_that_is_too_small(name: str) -> None:
    assert flat_top(thing(name)) is not None and not [*ways_of(SPONGE, thing(name))]


def test_a_leaning_top_is_not_wiped() -> None:
    leaning = BOARD.moved(BOARD.pose * Pose(q=[np.cos(0.1), np.sin(0.1), 0.0, 0.0]))
    assert not [*ways_of(SPONGE, leaning)]


def test_what_has_no_pad_wipes_nothing() -> None:
    assert Pad.of(BOARD) is None and not len(under_pad(BOARD, BOARD)) and not [*ways_of(thing("banana"), BOARD)]


def test_the_heading_that_turns_a_tool_least_comes_first() -> None:
    first, *_, last = ways_of(SPONGE, BOARD)
    turns = [abs(np.angle(np.exp(1j * (way[0].yaw - SPONGE.pose.yaw)))) for way in (first, last)]
    assert turns[0] < np.pi / 4 < turns[1]


def test_a_pad_over_a_top_or_beside_it_wipes_none_of_its_cells() -> None:
    way = next(ways_of(SPONGE, BOARD, above_m=0.0))
    assert len(under_pad(SPONGE.moved(way[0]), BOARD))
    for away in ([0.0, 0.0, 0.02], [0.4, 0.0, 0.0]):
        assert not len(under_pad(SPONGE.moved(Pose(way[0].p + away, way[0].q)), BOARD))


def test_a_way_ends_far_from_where_it_begins() -> None:
    for way in ways_of(SPONGE, BOARD):
        assert np.linalg.norm(way[farthest(way)].p - way[0].p) >= SETTINGS.least_way_m


def test_what_is_in_the_way_is_named() -> None:
    ring = [
        thing("cereal_box", (0.05 + 0.16 * np.cos(a), 0.05 + 0.16 * np.sin(a)), a + np.pi / 2, id=f"box_{number}")
        for number, a in enumerate(np.linspace(0, 2 * np.pi, 6, endpoint=False).tolist())
    ]
    ways, met = free_wiping_ways(SPONGE, thing("tray", (0.05, 0.05)), ring)
    assert not ways and met is not None and met.id.startswith("box_")
