"""Objects in containers from the start: inside their openings, apart, turned with them, and no load on the table."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.layout.items import unplaced
from vcage.base.errors import InfeasibleScene, UsageError
from vcage.base.geometry import boxes_overlap, footprint_half_size, rotation_2d
from vcage.layout.items import Placement, TableItem
from vcage.layout.placement.contents import CONTENT_MARGIN_M
from vcage.layout.placement.place import place
from vcage.objects.openings import Opening

WORKSPACE = np.array([[-0.5, -0.3], [0.5, 0.3]])
YAWS = tuple(np.radians(range(0, 360, 15)))
TRAY = unplaced("tray", (0.34, 0.24), YAWS, opening=Opening((0.01, -0.005), (0.3, 0.2), 0.012, 0.04))


def local_box(item: TableItem, at: Placement, container: Placement) -> np.ndarray:
    """(2, 2) an item's rectangle in the frame of a container."""
    centre = np.array([at.x - container.x, at.y - container.y]) @ rotation_2d(container.yaw)
    half = footprint_half_size(item.size[:2], at.yaw - container.yaw)
    return np.stack([centre - half, centre + half])


def opening_box(opening: Opening) -> np.ndarray:
    centre, half = np.array(opening.centre), np.array(opening.size) / 2
    return np.stack([centre - half, centre + half])


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 6))
def test_contents_lie_in_their_opening_and_apart_for_any_seed(seed, count):
    rng = np.random.default_rng(seed)
    contents = [unplaced(f"o{k}", tuple(rng.uniform(0.02, 0.06, 2)), YAWS, inside="tray") for k in range(count)]
    others = [unplaced(f"t{k}", tuple(rng.uniform(0.03, 0.1, 2)), YAWS) for k in range(3)]
    placed = place([*contents, TRAY, *others], WORKSPACE, rng)
    room = opening_box(TRAY.opening) + np.array([[1], [-1]]) * (CONTENT_MARGIN_M - 1e-7)
    boxes = [local_box(item, placed[item.id], placed["tray"]) for item in contents]
    for box in boxes:
        assert np.all(box[0] >= room[0]) and np.all(box[1] <= room[1])
    for a, b in combinations(boxes, 2):
        assert not boxes_overlap(a, b, CONTENT_MARGIN_M - 1e-7)


def test_contents_stand_on_the_floor_of_their_container():
    bowl = unplaced("bowl", (0.12, 0.12), YAWS, inside="tray", opening=Opening((0, 0), (0.08, 0.08), 0.005, 0.05))
    egg = unplaced("egg", (0.04, 0.05), YAWS, inside="bowl")
    placed = place([egg, bowl, TRAY], WORKSPACE, np.random.default_rng(0))
    assert list(placed) == ["egg", "bowl", "tray"]
    assert [placed[name].z for name in ("tray", "bowl", "egg")] == pytest.approx([0, 0.012, 0.017])
    box, room = local_box(egg, placed["egg"], placed["bowl"]), opening_box(bowl.opening)
    assert np.all(box[0] >= room[0]) and np.all(box[1] <= room[1])


def test_contents_take_no_room_of_the_table():
    small = np.array([[-0.18, -0.13], [0.18, 0.13]])
    contents = [unplaced(f"o{k}", (0.09, 0.09), inside="tray") for k in range(4)]
    tray = replace(TRAY, yaws=(0.0,))
    assert len(place([tray, *contents], small, np.random.default_rng(0))) == 5


def test_the_same_seed_gives_the_same_contents():
    items = [TRAY, *(unplaced(f"o{k}", (0.05, 0.04), YAWS, inside="tray") for k in range(4))]
    first, second = (place(items, WORKSPACE, np.random.default_rng(3)) for _ in range(2))
    assert first == second


@pytest.mark.parametrize("seed", range(10))
def test_a_container_stands_where_its_contents_are_reached_and_seen(seed: int):
    allowed, within = [[[0.1, -0.1], [0.2, 0.1]]], [[[0.0, -0.2], [0.3, 0.2]]]
    cup = unplaced("cup", (0.06, 0.06), YAWS, allowed=allowed, within=within, inside="tray")
    at = place([TRAY, cup], WORKSPACE, np.random.default_rng(seed))["cup"]
    half = footprint_half_size(cup.size[:2], at.yaw)
    assert 0.1 - 1e-6 <= at.x <= 0.2 + 1e-6 and -0.1 - 1e-6 <= at.y <= 0.1 + 1e-6
    assert at.x + half[0] <= 0.3 + 1e-6 and abs(at.y) + half[1] <= 0.2 + 1e-6


def test_an_object_too_large_for_an_opening_is_refused_with_both_names_and_the_missing_length():
    laptop = unplaced("laptop", (0.32, 0.1), inside="tray")
    with pytest.raises(InfeasibleScene, match=r"laptop .*opening of tray.* 0\.026 m along x") as caught:
        place([TRAY, laptop], WORKSPACE, np.random.default_rng(0))
    assert caught.value.details["objects"] == ["laptop"] == caught.value.details["drop"]
    assert caught.value.details["container"] == "tray"
    assert caught.value.details["missing_area_m2"] > 0


def test_too_many_contents_are_refused_with_the_ones_to_drop():
    contents = [unplaced(f"o{k}", (0.09, 0.09), inside="tray") for k in range(8)]
    with pytest.raises(InfeasibleScene, match="tray") as caught:
        place([TRAY, *contents], WORKSPACE, np.random.default_rng(0))
    dropped = set(caught.value.details["drop"])
    kept = [item for item in contents if item.id not in dropped]
    assert len(dropped) == 2 and len(place([TRAY, *kept], WORKSPACE, np.random.default_rng(0))) == 7


@pytest.mark.parametrize(
    ("items", "message"),
    [
        ([unplaced("a", (0.1, 0.1), inside="ghost")], "unknown container 'ghost'"),
        ([TRAY, unplaced("a", (0.1, 0.1)), unplaced("b", (0.1, 0.1), inside="a")], "b lies in a, which has no room"),
        ([unplaced("a", (0.1, 0.1), inside="a", opening=TRAY.opening)], "circle: a in a"),
        (
            [unplaced(x, (0.1, 0.1), inside=y, opening=TRAY.opening) for x, y in ("ab", "bc", "ca")],
            "circle: a in b in c in a",
        ),
        ([unplaced("a", (0.1, 0.1), opening=Opening((0, 0), (0.1, np.nan), 0, 0))], "a has the opening"),
        ([unplaced("a", (0.1, 0.1), opening=Opening((0, 0), (0.1, 0.0), 0, 0))], "a has the opening"),
    ],
    ids=["unknown", "no opening", "in itself", "circle", "nan opening", "flat opening"],
)
def test_containers_that_make_no_sense_are_refused(items, message):
    with pytest.raises(UsageError, match=message):
        place(items, WORKSPACE, np.random.default_rng(0))
