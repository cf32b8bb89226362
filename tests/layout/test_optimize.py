from __future__ import annotations

import logging
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.layout.items import standing_at
from vcage.base.errors import InfeasibleScene, UnknownName, UsageError
from vcage.base.geometry import Pose, boxes_overlap, world_aabb
from vcage.layout.check import require_exact
from vcage.layout.cost import CostWeights
from vcage.layout.groups import Groups
from vcage.layout.items import TableItem
from vcage.layout.optimize import LayoutOptions, LayoutResult, displacement_summary, optimize_layout
from vcage.objects.openings import Opening
from vcage.plans.kept import relations_kept
from vcage.schema.plan import Relation
from vcage.schema.scene import Table

WORKSPACE = np.array([[-0.5, -0.3], [0.5, 0.3]])
HEIGHT = 0.74


TABLE = Table(size=(1.0, 0.6), height=HEIGHT)
"""As large as the workspace."""

GROUND = np.column_stack([WORKSPACE, [HEIGHT, HEIGHT]])


def solve(items: list[TableItem], seed: int = 0, relations=(), table: Table = TABLE, **options) -> LayoutResult:
    rng = np.random.default_rng(seed)
    return optimize_layout(items, WORKSPACE, table, rng, relations, LayoutOptions(**options))


def box_of(item: TableItem, result: LayoutResult, frame: Pose | None = None) -> np.ndarray:
    """(2, 3) true AABB in the world or in another frame."""
    x, y, z = np.array(item.size) / 2
    pose = Pose.from_yaw(result.positions[item.id], item.yaw)
    return world_aabb([[-x, -y, 0], [x, y, 2 * z]], frame.inverse() * pose if frame else pose)


def random_items(rng: np.random.Generator, count: int) -> list[TableItem]:
    return [
        standing_at(
            f"o{k}",
            tuple(rng.uniform(0.02, 0.14, 3)),
            float(rng.uniform(-np.pi, np.pi)),
            tuple(rng.uniform(1.2 * WORKSPACE[0], 1.2 * WORKSPACE[1])),
        )
        for k in range(count)
    ]


def tray_with_rolls(count: int = 3, yaw: float = 0.4) -> list[TableItem]:
    opening = Opening(centre=(0.01, 0.0), size=(0.26, 0.16), floor=0.012, rim=np.inf)
    tray = standing_at("tray", (0.3, 0.2, 0.03), yaw, (0.1, 0.05), opening)
    rolls = [
        standing_at(f"roll{k}", (0.08, 0.05, 0.05), yaw + 0.1 * k, (0.1 + 0.02 * k, 0.05), inside="tray")
        for k in range(count)
    ]
    return [tray, *rolls]


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 9))
def test_nothing_overlaps_and_all_is_in_bounds_for_any_seed(seed, count):
    items = random_items(np.random.default_rng(seed), count)
    result = solve(items, seed, restarts=2)
    boxes = [box_of(item, result)[:, :2] for item in items]
    for a, b in combinations(boxes, 2):
        assert not boxes_overlap(a, b, 0.01 - 1e-6)
    for box in boxes:
        assert np.all(box[0] >= WORKSPACE[0] - 1e-6) and np.all(box[1] <= WORKSPACE[1] + 1e-6)


def test_the_same_seed_gives_the_same_layout():
    items = random_items(np.random.default_rng(4), 8)
    assert solve(items, 1).positions == solve(items, 1).positions


def test_a_layout_without_collisions_is_not_touched():
    items = [standing_at("a", (0.1, 0.1, 0.1), 0.0, (0, 0)), standing_at("b", (0.1, 0.1, 0.1), 0.0, (0.2, 0))]
    result = solve(items)
    assert result.positions == {"a": (0, 0, HEIGHT), "b": (0.2, 0, HEIGHT)}
    assert result.starts == 0


def test_the_cost_after_has_no_collisions_and_the_cost_before_has():
    result = solve([standing_at(name, (0.1, 0.1, 0.1), 0.0, (0.0, 0.0)) for name in "abc"])
    assert result.cost_before.collision > 1e-3
    assert result.cost_after.collision < 1e-12


def test_the_larger_of_two_moves_less():
    items = [standing_at("big", (0.3, 0.3, 0.1), 0.0, (0, 0)), standing_at("small", (0.05, 0.05, 0.1), 0.0, (0.15, 0))]
    result = solve(items)
    assert result.displaced["big"] < 0.1 * result.displaced["small"]


@pytest.mark.parametrize("yaw", [0.0, 0.4, np.pi / 2])
def test_contents_stay_inside_their_container_and_apart(yaw):
    items = tray_with_rolls(yaw=yaw)
    tray, rolls = items[0], items[1:]
    result = solve(items)
    assert result.containers == {"tray": None, "roll0": "tray", "roll1": "tray", "roll2": "tray"}
    frame = Pose.from_yaw(result.positions["tray"], yaw)
    boxes = [box_of(roll, result, frame) for roll in rolls]
    centre, half = np.array(tray.opening.centre), np.array(tray.opening.size) / 2
    for box in boxes:
        assert np.all(box[0, :2] >= centre - half - 1e-6) and np.all(box[1, :2] <= centre + half + 1e-6)
    for a, b in combinations(boxes, 2):
        assert not boxes_overlap(a[:, :2], b[:, :2], 0.003 - 1e-6)


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 5))
def test_contents_end_inside_from_any_target(seed, count):
    rng = np.random.default_rng(seed)
    tray, *_ = tray_with_rolls(0, yaw=float(rng.uniform(-np.pi, np.pi)))
    rolls = [
        standing_at(
            f"roll{k}",
            (*rng.uniform(0.02, 0.06, 2), 0.05),
            float(rng.uniform(-np.pi, np.pi)),
            tuple(tray.target + rng.normal(0, 0.1, 2)),
            inside="tray",
        )
        for k in range(count)
    ]
    plan = [relation(roll.id, "inside", "tray") for roll in rolls]
    result = solve([tray, *rolls], seed, relations=plan)
    frame = Pose.from_yaw(result.positions["tray"], tray.yaw)
    lower, upper = np.array(tray.opening.centre) + np.outer([-0.5, 0.5], tray.opening.size)
    inside = [roll for roll in rolls if result.containers[roll.id] == "tray"]
    assert {roll.id for roll in rolls} - {roll.id for roll in inside} == set(result.released)
    for roll in inside:
        box = box_of(roll, result, frame)[:, :2]
        assert np.all(box[0] >= lower - 1e-6) and np.all(box[1] <= upper + 1e-6)


def test_contents_stand_on_the_floor_of_their_container():
    result = solve(tray_with_rolls())
    assert result.positions["roll0"][2] == pytest.approx(HEIGHT + 0.012)
    assert result.positions["tray"][2] == HEIGHT


def test_contents_move_with_their_container():
    alone = solve(tray_with_rolls())
    pushed = solve([*tray_with_rolls(), standing_at("crate", (0.4, 0.4, 0.2), 0.0, (-0.1, 0.0))])
    assert pushed.positions["tray"] != alone.positions["tray"]
    for roll in ("roll0", "roll1", "roll2"):
        offsets = [np.subtract(r.positions[roll], r.positions["tray"]) for r in (alone, pushed)]
        assert offsets[0] == pytest.approx(offsets[1], abs=2e-3)


def test_containers_nest():
    opening = Opening(centre=(0, 0), size=(0.12, 0.12), floor=0.01, rim=0.07)
    items = tray_with_rolls(0)
    items.append(standing_at("bowl", (0.14, 0.14, 0.07), 0.4, (0.1, 0.05), opening, inside="tray"))
    items.append(standing_at("egg", (0.04, 0.04, 0.05), 0.0, (0.12, 0.05), inside="bowl"))
    result = solve(items)
    assert result.containers == {"tray": None, "bowl": "tray", "egg": "bowl"}
    assert result.positions["egg"][2] == pytest.approx(HEIGHT + 0.012 + 0.01)


def test_overlap_without_permission_is_resolved():
    items = tray_with_rolls(1)
    items[1] = standing_at("roll0", items[1].size, 0.4, items[1].target)
    result = solve(items)
    assert result.containers["roll0"] is None
    assert not boxes_overlap(box_of(items[0], result)[:, :2], box_of(items[1], result)[:, :2], 0.01 - 1e-6)


def test_contents_without_room_are_released_and_reported():
    items = tray_with_rolls(0)
    items += [standing_at(f"bar{k}", (0.14, 0.09, 0.03), 0.4, (0.1, 0.05), inside="tray") for k in range(2)]
    result = solve(items)
    assert result.released == ["bar0"]
    assert result.containers == {"tray": None, "bar0": None, "bar1": "tray"}


def test_too_many_objects_are_infeasible_with_names_and_area():
    with pytest.raises(InfeasibleScene, match="m² are missing") as caught:
        solve([standing_at(f"crate{k}", (0.34, 0.34, 0.1), 0.0, (0, 0)) for k in range(3)], restarts=1)
    assert caught.value.details["objects"]


def test_an_object_larger_than_the_table_is_named():
    with pytest.raises(InfeasibleScene, match="sofa"):
        solve([standing_at("sofa", (2.0, 0.8, 0.8), 0.0, (0, 0)), standing_at("mug", (0.1, 0.1, 0.1), 0.0, (0, 0))])


def test_a_non_finite_pose_is_refused():
    with pytest.raises(UsageError, match="mug"):
        solve([standing_at("mug", (0.1, 0.1, 0.1), 0.0, (np.nan, 0.0))])


def test_the_summary_has_mean_percentile_and_maximum():
    summary = displacement_summary({"a": 0.0, "b": 0.02})
    assert summary["mean_m"] == pytest.approx(0.01)
    assert summary["max_m"] == pytest.approx(0.02)
    assert 0.01 < summary["p95_m"] <= 0.02


# --- the plan ------------------------------------------------------------------------------------------


def relation(subject: str, word: str, reference: str) -> Relation:
    return Relation(subject=subject, relation=word, reference=reference)


def kept(items: list[TableItem], result: LayoutResult, *relations: Relation) -> float:
    boxes = {item.id: box_of(item, result) for item in items}
    return relations_kept(relations, boxes, GROUND).share


def noisy_row(seed: int, count: int) -> tuple[list[TableItem], list[Relation]]:
    """Objects in a row from left to right, with 3 cm of noise, and the plan that they stand so."""
    rng = np.random.default_rng(seed)
    spots = np.stack([np.linspace(-0.4, 0.4, count), rng.uniform(-0.05, 0.05, count)], axis=1)
    items = [
        standing_at(f"o{k}", tuple(rng.uniform(0.03, 0.08, 3)), 0.0, tuple(spot + rng.normal(0, 0.03, 2)))
        for k, spot in enumerate(spots)
    ]
    return items, [relation(f"o{k}", "left_of", f"o{k + 1}") for k in range(count - 1)]


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(2, 8))
def test_noise_does_not_break_the_plan(seed, count):
    items, plan = noisy_row(seed, count)
    assert kept(items, solve(items, seed, relations=plan), *plan) == 1


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(2, 8))
def test_no_plan_brings_a_collision(seed, count):
    rng = np.random.default_rng(seed)
    items = random_items(rng, count)
    words = ["left_of", "right_of", "in_front_of", "behind", "beside", "near", "center"]
    plan = [relation(f"o{i}", rng.choice(words), f"o{j}") for i, j in rng.integers(0, count, (5, 2)) if i != j]
    result = solve(items, seed, restarts=1, relations=plan)
    boxes = [box_of(item, result)[:, :2] for item in items]
    assert not any(boxes_overlap(a, b, 0.01 - 1e-6) for a, b in combinations(boxes, 2))


def test_the_centre_is_the_middle_third_of_the_workspace():
    item = standing_at("vase", (0.1, 0.1, 0.2), 0.0, (0.4, 0.1))
    plan = relation("vase", "center", "table")
    result = solve([item], relations=[plan])
    assert kept([item], result, plan) == 1


@pytest.mark.parametrize("word", ["left_of", "right_of", "in_front_of", "behind"])
def test_a_thing_goes_to_the_third_of_the_table_that_the_plan_names(word):
    item = standing_at("vase", (0.1, 0.1, 0.2), 0.0, (0.02, 0.01))
    plan = relation("vase", word, "table")
    result = solve([item], relations=[plan])
    assert kept([item], result, plan) == 1
    assert result.displaced["vase"] < 0.2, "it moves no farther than to the edge of the third"


def test_relations_hold_for_contents_of_a_container():
    tray, *rolls = tray_with_rolls(1)
    mug = standing_at("mug", (0.08, 0.08, 0.1), 0.0, (-0.1, 0.05))
    plan = relation("mug", "right_of", "roll0")
    items = [tray, *rolls, mug]
    result = solve(items, relations=[plan])
    assert kept(items, result, plan) == 1


def test_contents_are_ordered_in_their_turned_container():
    items = tray_with_rolls(2, yaw=0.4)
    plan = [relation("roll1", "left_of", "roll0"), relation("roll0", "inside", "tray")]
    result = solve(items, relations=plan)
    assert kept(items, result, *plan) == 1


def test_contents_come_inside_from_anywhere():
    items = tray_with_rolls(1)
    items[1] = standing_at("roll0", (0.08, 0.05, 0.05), 0.4, (-0.3, -0.2), inside="tray")
    assert solve(items).containers["roll0"] is None
    demanded = [relation("roll0", "inside", "tray")]
    assert solve(items, relations=demanded).containers["roll0"] == "tray"
    assert solve(items, relations=demanded, weights=CostWeights(relation=0)).containers["roll0"] == "tray"


def test_a_relation_of_an_unknown_object_is_refused():
    with pytest.raises(UnknownName, match="sofa"):
        solve([standing_at("a", (0.1, 0.1, 0.1), 0.0, (0, 0))], relations=[relation("a", "near", "sofa")])


# --- stacks, moving parts and reach --------------------------------------------------------------------


def block(name: str, yaw: float = 0.0, on: str | None = None, edge: float = 0.05) -> TableItem:
    top = Opening(centre=(0.0, 0.0), size=(edge, edge), floor=edge, rim=np.inf)
    return standing_at(name, (edge, edge, edge), yaw, (0.1, 0.1), top, inside=on)


def test_a_stack_rises_by_every_level():
    result = solve([block("a"), block("b", 0.3, "a"), block("c", -0.2, "b")])
    assert [result.positions[name][2] for name in "abc"] == pytest.approx([HEIGHT, HEIGHT + 0.05, HEIGHT + 0.1])


def test_the_overhang_of_a_stack_keeps_others_away():
    board = standing_at("board", (0.3, 0.2, 0.02), 0.0, (0.1, 0.1), inside="base")
    items = [block("base"), board, standing_at("mug", (0.08, 0.08, 0.1), 0.0, (0.2, 0.1))]
    result = solve(items)
    assert result.containers["board"] == "base"
    assert not boxes_overlap(box_of(board, result)[:, :2], box_of(items[2], result)[:, :2], 0.01 - 1e-6)


def test_a_rectangle_beside_its_origin_is_kept_clear():
    oven = standing_at("oven", (0.3, 0.4, 0.3), 0.0, (0.0, 0.2), centre=(0.0, -0.1))  # with the sweep of its door
    mug = standing_at("mug", (0.08, 0.08, 0.1), 0.0, (0.0, -0.02))
    result = solve([oven, mug])
    room = oven.rectangle() + result.positions["oven"][:2]
    assert not boxes_overlap(room, box_of(mug, result)[:, :2], 0.01 - 1e-6)
    assert np.all(room >= WORKSPACE[0] - 1e-6) and np.all(room <= WORKSPACE[1] + 1e-6)


def test_the_middle_of_a_rectangle_ends_where_it_is_allowed():
    allowed = [[[0.1, -0.1], [0.3, 0.1]]]
    item = standing_at("oven", (0.2, 0.2, 0.3), np.pi / 2, (-0.2, 0.0), centre=(0.0, -0.1), allowed=allowed)
    result = solve([item])
    middle = item.rectangle().mean(axis=0) + result.positions["oven"][:2]
    assert middle == pytest.approx([0.1, 0.0], abs=0.005)


def test_contents_bring_their_container_within_reach():
    tray, roll = tray_with_rolls(1, yaw=0.0)
    roll = standing_at("roll0", roll.size, 0.0, roll.target, inside="tray", allowed=[[[-0.3, -0.1], [-0.1, 0.1]]])
    result = solve([tray, roll])
    assert result.containers["roll0"] == "tray"
    assert -0.12 < result.positions["roll0"][0] <= -0.1 + 1e-6


def out_of_reach_together() -> list[TableItem]:
    """A roll in the middle of a tray, allowed on the right of the table; its tray on the left."""
    tray, roll = tray_with_rolls(1, yaw=0.0)
    tray = replace(tray, allowed=[[[-0.2, -0.1], [-0.1, 0.1]]])
    return [tray, replace(roll, allowed=[[[0.3, -0.1], [0.4, 0.1]]])]


def test_contents_kept_out_of_reach_by_their_container_are_reported(caplog):
    with caplog.at_level(logging.WARNING):
        result = solve(out_of_reach_together())
    assert result.out_of_reach == ["roll0"]
    assert "roll0 cannot be reached where tray may stand" in caplog.text
    assert solve(tray_with_rolls(1)).out_of_reach == []


# --- the exact check -----------------------------------------------------------------------------------


def test_a_content_that_leaves_its_opening_is_found():
    items = tray_with_rolls(1)
    groups, result = Groups(items), solve(items)
    require_exact(groups, result.positions, WORKSPACE, 0.01, [])
    moved = result.positions | {"roll0": (0.1, 0.15, HEIGHT)}
    with pytest.raises(InfeasibleScene, match="roll0 sticks out of tray"):
        require_exact(groups, moved, WORKSPACE, 0.01, [])


@pytest.mark.parametrize(("second", "words"), [((0.105, 0.0), "touch"), ((0.5, 0.0), "sticks out")])
def test_touching_and_protruding_objects_are_found(second, words):
    items = [standing_at(name, (0.1, 0.1, 0.1), 0.0, (0.0, 0.0)) for name in "ab"]
    with pytest.raises(InfeasibleScene, match=words):
        require_exact(Groups(items), {"a": (0.0, 0.0, HEIGHT), "b": (*second, HEIGHT)}, WORKSPACE, 0.01, [])


@pytest.mark.parametrize("position", [(np.nan, 0.0, HEIGHT), (0.0, np.inf, HEIGHT), (0.0, 0.0, np.nan)])
def test_a_non_finite_position_is_found(position):
    items = [standing_at("a", (0.1, 0.1, 0.1), 0.0, (0.0, 0.0))]
    with pytest.raises(InfeasibleScene, match="a has no finite position"):
        require_exact(Groups(items), {"a": position}, WORKSPACE, 0.01, [])


def test_an_object_outside_its_allowed_area_is_found():
    items = [standing_at("oven", (0.2, 0.2, 0.3), 0.0, (0.0, 0.0), centre=(0.0, -0.1), allowed=[[[0, 0], [0.1, 0.1]]])]
    require_exact(Groups(items), {"oven": (0.05, 0.15, HEIGHT)}, WORKSPACE, 0.01, [])
    with pytest.raises(InfeasibleScene, match="oven is not where it is allowed") as caught:
        require_exact(Groups(items), {"oven": (0.05, 0.05, HEIGHT)}, WORKSPACE, 0.01, [])
    assert caught.value.details["objects"] == ["oven"]


def test_the_check_believes_the_positions_and_not_the_groups():
    opening = Opening(centre=(0, 0), size=(0.12, 0.12), floor=0.01, rim=0.07)
    tray = tray_with_rolls(0)[0]
    bowl = standing_at("bowl", (0.14, 0.14, 0.07), 0.4, (0.1, 0.05), opening, inside="tray")
    items = [tray, bowl, standing_at("egg", (0.04, 0.04, 0.05), 0.0, (0.12, 0.05), inside="bowl")]
    positions = solve(items).positions
    groups = Groups(items)  # that has laid nothing out
    require_exact(groups, positions, WORKSPACE, 0.01, [])
    x, y, z = positions["egg"]
    with pytest.raises(InfeasibleScene, match="egg sticks out of bowl"):
        require_exact(groups, positions | {"egg": (x + 0.1, y, z)}, WORKSPACE, 0.01, [])


@pytest.mark.parametrize(
    ("workspace", "options"),
    [([[0, 0], [0, 1]], {}), ([[0, 0], [np.nan, 1]], {}), (WORKSPACE, {"margin": -0.1}), (WORKSPACE, {"restarts": -1})],
    ids=["no inside", "nan", "negative margin", "negative restarts"],
)
def test_bounds_and_options_that_make_no_sense_are_refused(workspace, options):
    items = [standing_at("a", (0.1, 0.1, 0.1), 0.0, (0, 0))]
    with pytest.raises(UsageError):
        optimize_layout(items, workspace, TABLE, np.random.default_rng(0), options=LayoutOptions(**options))
