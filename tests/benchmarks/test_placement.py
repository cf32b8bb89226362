"""How the placement benchmark draws its scenes, what its rivals do, and how it counts."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks._placement_measures import Drift, TrueShapes
from benchmarks._placement_rivals import depth_first, maniskill, random_retries
from benchmarks._placement_scenes import FILL, BenchmarkScene, Stock, cut
from benchmarks.placement import Answer, Measured, measure, row
from tests.layout.items import unplaced
from vcage.base.geometry import Pose, boxes_overlap, footprint_half_size
from vcage.layout.items import Placement
from vcage.layout.placement.place import place
from vcage.scenes.starting_poses import MARGIN_M

# The import of ManiSkill's environments takes seconds.
RIVALS = pytest.mark.parametrize(
    "method", [random_retries, depth_first, pytest.param(maniskill, marks=pytest.mark.slow)]
)
TABLE = np.array([[-0.4, -0.2], [0.4, 0.2]])
EVERYWHERE = np.array([[[-5.0, -5.0], [5.0, 5.0]]])
BLOCKS = [unplaced(f"block-{i}", (0.06, 0.04), tuple(np.radians((0, 45, 90)))) for i in range(6)]


@pytest.fixture(scope="module")
def stock() -> Stock:
    return Stock()


def measured(seed: int, method: str = "vcage", **fields) -> Measured:
    return Measured(**{"n": 4, "seed": seed, "method": method, "ms": 1.0, "refused": False, **fields})


# --- scenes ---


def test_a_seed_gives_the_same_scene_again(stock: Stock) -> None:
    first, second = stock.scene(10, 3), Stock().scene(10, 3)
    assert [(t.id, t.asset.variant.id, t.role) for t in first.things] == [
        (t.id, t.asset.variant.id, t.role) for t in second.things
    ]
    np.testing.assert_array_equal(first.workspace, second.workspace)


def test_scenes_are_as_full_as_the_range_says(stock: Stock) -> None:
    fills = []
    for seed in range(10):
        scene = stock.scene(10, seed)
        needed = sum(np.prod(np.add(thing.room.size[:2], MARGIN_M)) for thing in scene.things)
        fills.append(needed / np.prod(scene.workspace[1] - scene.workspace[0]))
    assert FILL[0] <= min(fills) < 0.35 < max(fills) <= FILL[1] + 1e-9


def test_every_object_fits_alone(stock: Stock) -> None:
    for seed in range(20):
        scene = stock.scene(4, seed)
        for item in scene.plain_items():
            assert len(place([item], scene.workspace, np.random.default_rng(0), margin=MARGIN_M)) == 1


def test_contents_and_receptacles_must_be_within_reach_and_context_need_not(stock: Stock) -> None:
    scene = stock.scene(10, 2)
    roles = [thing.role for thing in scene.things]
    assert roles.count("content") == 3 and roles.count("receptacle") == 1
    limited = [item.allowed is not None for item in scene.items(EVERYWHERE)]
    assert limited == [role != "context" for role in roles]
    assert all(item.allowed is None for item in scene.plain_items())


def test_reach_is_cut_to_the_workspace() -> None:
    reach = np.array([[[-1.0, 0.0], [1.0, 1.0]], [[3.0, 3.0], [4.0, 4.0]]])
    np.testing.assert_array_equal(cut(reach, TABLE), [[[-0.4, 0.0], [0.4, 0.2]]])


# --- rivals ---


@RIVALS
def test_a_rival_places_a_few_objects_with_margin_and_within_the_workspace(method) -> None:
    placed = method(BLOCKS, TABLE, 0, MARGIN_M)
    assert sorted(placed) == [item.id for item in BLOCKS]
    places = [(placed[item.id], footprint_half_size(item.size[:2], placed[item.id].yaw)) for item in BLOCKS]
    boxes = [np.array([at.x, at.y]) + np.array([-half, half]) for at, half in places]
    for i, box in enumerate(boxes):
        assert np.all(box[0] >= TABLE[0] - 1e-6) and np.all(box[1] <= TABLE[1] + 1e-6)
        assert not any(boxes_overlap(box, other, MARGIN_M - 1e-6) for other in boxes[:i])


@RIVALS
def test_a_rival_answers_a_seed_the_same_again(method) -> None:
    assert method(BLOCKS, TABLE, 5, MARGIN_M) == method(BLOCKS, TABLE, 5, MARGIN_M)


def test_random_retries_leave_out_unplaceable_objects() -> None:
    large = unplaced("large", (0.7, 0.35))
    placed = random_retries([large, unplaced("too much", (0.3, 0.3)), BLOCKS[0]], TABLE, 0, MARGIN_M)
    assert "large" in placed and "too much" not in placed


@pytest.mark.slow
def test_maniskill_leaves_unplaceable_objects_at_the_origin() -> None:
    placed = maniskill([unplaced("large", (0.7, 0.35)), unplaced("too much", (0.3, 0.3))], TABLE + 1, 0, MARGIN_M)
    assert (placed["too much"].x, placed["too much"].y) == pytest.approx((1, 1))


def test_depth_first_keeps_the_fullest_partial_solution() -> None:
    items = [unplaced(f"half-{i}", (0.38, 0.38)) for i in range(3)]
    assert len(depth_first(items, TABLE, 0, 0.0)) == 2


def test_depth_first_keeps_to_the_allowed_headings() -> None:
    front = unplaced("front", (0.3, 0.1), tuple(np.radians((-15, 0, 15))))
    assert {depth_first([front], TABLE, seed, MARGIN_M)["front"].yaw for seed in range(5)} == {0.0}


# --- measures ---


@pytest.mark.parametrize(
    ("gap", "meets", "collides"), [(0.001, False, False), (-0.003, True, False), (-0.007, True, True)]
)
def test_pieces_collide_beyond_five_millimetres_and_boxes_at_once(stock: Stock, gap, meets, collides) -> None:
    block = stock.library.asset("block")
    shapes = TrueShapes({"a": block, "b": block}, {"a": Pose(), "b": Pose([block.size[0] + gap, 0, 0])})
    assert bool(shapes.meeting()) == meets
    assert shapes.collide("a", "b") == collides


def test_boxes_match_the_posed_shapes(stock: Stock) -> None:
    block = stock.library.asset("block")
    shapes = TrueShapes({"a": block}, {"a": Pose.from_yaw([0.39, 0, 0], np.pi / 4)})
    half = np.sqrt(2) * block.size[0] / 2
    assert shapes.boxes["a"][1, 0] == pytest.approx(0.39 + half, abs=0.004)  # its edges may be rounded
    assert shapes.within(TABLE) == 0
    assert shapes.within(2 * TABLE) == 1


def test_an_object_that_moves_far_or_turns_much_is_unstable() -> None:
    assert Drift(9.9, 7.9).stable
    assert not Drift(10.1, 0.0).stable and not Drift(0.0, 8.1).stable


def test_a_placed_scene_is_measured_through_physics_and_kinematics(stock: Stock) -> None:
    scene = stock.scene(4, 0)
    placed = place(scene.items(EVERYWHERE), scene.workspace, np.random.default_rng(0), margin=MARGIN_M)
    result = measure(scene, stock, 0, "vcage", Answer(placed, 2.0))
    assert result.solved and not result.collision_mesh
    assert len(result.drifts) == 4 and all(drift.stable for drift in result.drifts)
    assert 0 < result.points[0] <= result.points[1]


def test_two_objects_at_one_place_collide_and_are_not_solved(stock: Stock) -> None:
    things = stock.scene(4, 0).things
    scene = BenchmarkScene(things, 2 * TABLE)
    result = measure(scene, stock, 1, "maniskill", Answer({t.id: Placement(0, 0, 0) for t in things}, 1.0))
    assert result.collision_aabb and result.collision_mesh and not result.solved


def test_an_answer_without_any_place_is_measured(stock: Stock) -> None:
    result = measure(stock.scene(4, 0), stock, 0, "random", Answer({}, 1.0))
    assert (result.placed, result.missing, result.solved) == (0, 4, False)
    assert result.points == (0, 0) and not result.collision_aabb


# --- the figures ---


def test_a_refused_scene_is_neither_solved_nor_missing_anything() -> None:
    figures = row("vcage", 4, [measured(0, refused=True), measured(1, placed=4, within=4)])
    assert (figures["solved"], figures["infeasible"], figures["missing"]) == (0.5, 0.5, 0)


def test_an_object_left_out_is_missing() -> None:
    figures = row("random", 4, [measured(0, "random", placed=3, within=3, missing=1)])
    assert (figures["solved"], figures["infeasible"], figures["missing"]) == (0.0, 0.0, 1)


def test_scenes_that_only_others_solve_are_counted() -> None:
    runs = [measured(seed, refused=True) for seed in (0, 1)]
    runs += [measured(0, "random", placed=4, within=4), measured(1, "random", placed=3, within=3, missing=1)]
    assert row("vcage", 4, runs)["solved_by_others"] == 0.5
    assert row("random", 4, runs)["solved_by_others"] == 0.0


def test_a_row_without_physics_says_none() -> None:
    figures = row("vcage", 4, [measured(0, placed=4, within=4)])
    assert figures["stable"] is None and figures["reachable"] is None and figures["drift_mm_p95"] is None
