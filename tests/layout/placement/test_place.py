from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.layout.items import unplaced
from vcage.base.errors import InfeasibleScene, UsageError
from vcage.base.geometry import Pose, boxes_overlap, world_aabb
from vcage.layout.items import TableItem
from vcage.layout.placement.place import place, require_possible

WORKSPACE = np.array([[-0.5, -0.3], [0.5, 0.3]])
YAWS = (0.0, np.pi / 2, np.pi / 4)


def random_items(rng: np.random.Generator, count: int) -> list[TableItem]:
    return [unplaced(f"o{k}", tuple(rng.uniform(0.02, 0.16, 2)), YAWS) for k in range(count)]


def true_boxes(items, placed) -> dict[str, np.ndarray]:
    """AABBs from rotated corners, as the paper computes them."""
    found = {}
    for item in items:
        x, y = np.array(item.size[:2]) / 2
        at = placed[item.id]
        found[item.id] = world_aabb([[-x, -y, 0], [x, y, 0.1]], Pose.from_yaw((at.x, at.y, 0), at.yaw))[:, :2]
    return found


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 14))
def test_no_two_objects_come_closer_than_the_margin_for_any_seed(seed, count):
    rng = np.random.default_rng(seed)
    items = random_items(rng, count)
    obstacle = np.array([[-0.05, -0.05], [0.05, 0.05]])
    boxes = true_boxes(items, place(items, WORKSPACE, rng, margin=0.01, obstacles=[obstacle]))
    for a, b in combinations([*boxes.values(), obstacle], 2):
        assert not boxes_overlap(a, b, 0.01 - 1e-7)
    for box in boxes.values():
        assert np.all(box[0] >= WORKSPACE[0] - 1e-7) and np.all(box[1] <= WORKSPACE[1] + 1e-7)


def test_the_same_seed_gives_the_same_placement():
    items = random_items(np.random.default_rng(1), 12)
    first, second = (place(items, WORKSPACE, np.random.default_rng(5)) for _ in range(2))
    assert first == second
    assert place(items, WORKSPACE, np.random.default_rng(6)) != first


def test_placements_come_in_the_order_of_the_items():
    items = random_items(np.random.default_rng(1), 8)
    assert list(place(items, WORKSPACE, np.random.default_rng(0))) == [item.id for item in items]


def test_a_scene_that_fits_only_tightly_is_packed():
    # Six 0.3 x 0.28 rectangles with gaps of 0.01 leave 3 cm of 1.0 and 1 cm of 0.6 to spare.
    items = [unplaced(f"book{k}", (0.3, 0.28)) for k in range(6)]
    for seed in range(5):
        assert len(place(items, WORKSPACE, np.random.default_rng(seed))) == 6


def test_an_exact_fit_is_found():
    items = [unplaced("a", (0.5, 0.6)), unplaced("b", (0.5, 0.6))]
    placed = place(items, WORKSPACE, np.random.default_rng(0), margin=0.0)
    assert sorted(round(p.x, 6) for p in placed.values()) == [-0.25, 0.25]


def test_objects_that_fit_only_turned_are_turned():
    placed = place([unplaced("tray", (0.2, 0.9), (0.0, np.pi / 2))], WORKSPACE, np.random.default_rng(0))
    assert placed["tray"].yaw == np.pi / 2


def test_more_area_than_the_workspace_has_is_refused_with_the_area_missing():
    items = [unplaced(f"book{k}", (0.3, 0.3)) for k in range(8)]
    with pytest.raises(InfeasibleScene) as caught:
        place(items, WORKSPACE, np.random.default_rng(0), margin=0.0)
    assert caught.value.details["missing_area_m2"] == pytest.approx(8 * 0.09 - 0.6, abs=1e-4)
    assert "0.12" in caught.value.message and caught.value.hint


def test_an_infeasible_scene_names_the_objects_without_a_place():
    # The area suffices, but three squares of more than half the depth fit side by side only.
    items = [unplaced(f"crate{k}", (0.34, 0.34)) for k in range(3)]
    with pytest.raises(InfeasibleScene) as caught:
        place(items, WORKSPACE, np.random.default_rng(0))
    assert caught.value.details["objects"] == ["crate2"]
    assert "crate2" in caught.value.message
    assert caught.value.details["missing_area_m2"] == pytest.approx(0.35**2)


def test_an_object_larger_than_the_workspace_is_named():
    with pytest.raises(InfeasibleScene, match=r"sofa .* fits nowhere"):
        require_possible([unplaced("mug", (0.1, 0.1)), unplaced("sofa", (1.2, 0.2))], WORKSPACE)


def test_an_object_out_of_reach_is_named():
    far = unplaced("mug", (0.1, 0.1), allowed=[[[2, 2], [3, 3]]])
    with pytest.raises(InfeasibleScene, match=r"mug .* where an arm reaches it"):
        place([far], WORKSPACE, np.random.default_rng(0))


def test_objects_stay_where_they_are_reachable():
    allowed = [[[0.2, -0.2], [0.3, 0.2]]]
    items = [unplaced(f"o{k}", (0.05, 0.05), allowed=allowed) for k in range(5)]
    placed = place(items, WORKSPACE, np.random.default_rng(3))
    assert all(0.2 - 1e-8 <= p.x <= 0.3 + 1e-8 for p in placed.values())


@pytest.mark.parametrize(
    ("items", "message"),
    [
        ([unplaced("cup", (0.1, 0.1)), unplaced("cup", (0.1, 0.1))], "two objects are called 'cup'"),
        ([unplaced("cup", (0.0, 0.1))], "cup has the size"),
        ([unplaced("cup", (np.nan, 0.1))], "cup has the size"),
        ([unplaced("cup", (0.1, 0.1), yaws=())], "cup has the headings"),
        ([unplaced("cup", (0.1, 0.1), yaws=(np.inf,))], "cup has the headings"),
        ([unplaced("cup", (-0.1, 0.1))], "cup has the size"),
        ([unplaced("cup", (0.1, 0.1, 0.1))], "cup has the size"),
        ([unplaced("cup", ("wide", 0.1))], "cup has the size"),
        ([unplaced("cup", (0.1, 0.1), allowed=[[[0, 0], [np.nan, 1]]])], "not finite: where cup may stand"),
        ([unplaced("cup", (0.1, 0.1), within=[[[1, 1], [0, 0]]])], "inverted: where cup is seen"),
        ([unplaced("cup", (0.1, 0.1), allowed=[1, 2, 3])], "no rectangles .* where cup may stand"),
    ],
    ids=[
        "id twice",
        "no width",
        "nan",
        "no yaw",
        "infinite yaw",
        "negative width",
        "three sizes",
        "text",
        "nan reach",
        "inverted view",
        "no rectangles",
    ],
)
def test_items_that_make_no_sense_are_refused(items, message):
    with pytest.raises(UsageError, match=message):
        place(items, WORKSPACE, np.random.default_rng(0))


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"workspace": WORKSPACE[::-1]}, "inverted: the workspace"),
        ({"workspace": WORKSPACE * np.nan}, "not finite: the workspace"),
        ({"workspace": [[0, 0], [1, 0]]}, "no inside"),
        ({"workspace": [0, 1, 2]}, "no rectangles"),
        ({"margin": -0.01}, "margin"),
        ({"margin": np.nan}, "margin"),
        ({"obstacles": [[[0, 0], [np.nan, 1]]]}, "not finite: the obstacles"),
        ({"obstacles": [[[1, 1], [0, 0]]]}, "inverted: the obstacles"),
    ],
)
def test_a_room_that_makes_no_sense_is_refused(changed, message):
    with pytest.raises(UsageError, match=message):
        place([unplaced("a", (0.1, 0.1))], **{"workspace": WORKSPACE, "rng": np.random.default_rng(0), **changed})


def test_no_items_have_no_places():
    assert place([], WORKSPACE, np.random.default_rng(0)) == {}


def test_a_thousand_obstacles_are_kept_clear_of():
    rng = np.random.default_rng(0)
    lower = rng.uniform(*WORKSPACE, (1000, 2))
    obstacles = np.stack([lower, lower + 0.002], axis=1)
    items = [unplaced(f"o{k}", (0.02, 0.01), YAWS) for k in range(3)]
    for box in true_boxes(items, place(items, WORKSPACE, rng, margin=0.002, obstacles=obstacles)).values():
        assert not any(boxes_overlap(box, obstacle, 0.002 - 1e-7) for obstacle in obstacles)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_the_whole_footprint_stays_in_view(seed):
    rng = np.random.default_rng(seed)
    within = np.array([[[-0.4, -0.25], [0.1, 0.1]], [[-0.2, -0.25], [0.1, 0.28]]])
    items = [replace(item, within=within) for item in random_items(rng, 4)]
    for box in true_boxes(items, place(items, WORKSPACE, rng)).values():
        assert np.any(np.all((within[:, 0] <= box[0] + 1e-7) & (box[1] - 1e-7 <= within[:, 1]), axis=1))


@pytest.mark.parametrize("count", [20, 40])
def test_many_objects_at_any_heading_find_places_on_a_full_table(count: int):
    rng = np.random.default_rng(count)
    yaws = tuple(np.radians(range(-180, 180, 15)))
    items = [unplaced(f"o{k}", tuple(rng.uniform(0.03, 0.2, 2)), yaws) for k in range(count)]
    filled = sum(np.prod(item.size[:2]) for item in items)
    half = np.sqrt(filled / 0.6) / 2 * np.array([np.sqrt(2), np.sqrt(0.5)])
    boxes = true_boxes(items, place(items, np.stack([-half, half]), rng, margin=0.01))
    for a, b in combinations(boxes.values(), 2):
        assert not boxes_overlap(a, b, 0.01 - 1e-7)
