"""How the optimisation benchmark draws its scenes and judges what is returned."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from benchmarks import optimize
from benchmarks._optimize_checks import PlacedAsset, colliding_boxes, colliding_meshes, meshes_collide
from benchmarks._optimize_kinds import own_kinds
from benchmarks._optimize_plan import ROBUST, plan_relations, robust_words
from benchmarks._optimize_rival import PlainCost, finite_differences, parts
from benchmarks._optimize_rows import Outcome, Row
from benchmarks._optimize_scenes import FILL, STAGE, CleanScene, draw_scene, is_within
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.layout.cost import CostWeights, LayoutProblem, evaluate
from vcage.layout.relation_cost import RelatedBox, relation_terms
from vcage.objects.library import Library
from vcage.plans.kept import relations_kept
from vcage.schema.plan import Relation


@pytest.fixture(scope="module")
def library() -> Library:
    return Library.load()


@pytest.fixture(scope="module", params=[(5, 0, False), (12, 3, True), (20, 5, False)], ids=str)
def scene(library: Library, request: pytest.FixtureRequest) -> CleanScene:
    n, containers, bound = request.param
    return draw_scene(own_kinds(library), n, containers, bound, np.random.default_rng([n, containers]))


def clean_places(scene: CleanScene) -> dict[str, PlacedAsset]:
    return scene.placed({id: pose.p for id, pose in scene.poses.items()}, scene.containers)


# --- scenes --------------------------------------------------------------------------------------------


def test_a_clean_scene_has_no_collision_and_stays_in_bounds(scene: CleanScene) -> None:
    placed = clean_places(scene)
    assert colliding_boxes(placed) == []
    assert colliding_meshes(placed) == []
    assert all(map(scene.in_bounds, placed.values())) and scene.in_reach(placed)
    boxes = np.array([thing.box for thing in placed.values()])
    assert np.all(boxes[:, 0, :2] >= scene.workspace[0] - 1e-6)
    assert np.all(boxes[:, 1, :2] <= scene.workspace[1] + 1e-6)


def test_a_clean_scene_keeps_its_plan_and_the_plan_speaks_of_every_object(scene: CleanScene) -> None:
    boxes = {id: thing.box for id, thing in clean_places(scene).items()}
    ground = np.column_stack([scene.workspace, [0.0, 0.0]])
    assert relations_kept(scene.relations, boxes, ground).share == 1.0
    named = {name for r in scene.relations for name in (r.subject, r.reference)}
    assert named == set(scene.kinds)


def test_the_workspace_is_as_full_as_it_says(scene: CleanScene) -> None:
    boxes = [thing.room_in(Pose())[:, :2] for id, thing in clean_places(scene).items() if id not in scene.containers]
    covered = sum(np.prod(box[1] - box[0]) for box in boxes)
    assert covered / np.prod(scene.workspace[1] - scene.workspace[0]) == pytest.approx(scene.fill, rel=1e-3)
    assert scene.fill <= FILL[1]


def test_every_container_holds_something(library: Library) -> None:
    scene = draw_scene(own_kinds(library), 10, 5, False, np.random.default_rng(0))
    assert len(scene.kinds) == 10
    assert len(set(scene.containers.values())) == 5


def test_bound_objects_stand_in_their_allowed_areas(library: Library) -> None:
    scene = draw_scene(own_kinds(library), 12, 2, True, np.random.default_rng(1))
    assert set(scene.containers.values()) <= scene.allowed.keys()
    assert scene.in_reach(clean_places(scene))
    contents = scene.allowed.keys() & scene.containers.keys()
    assert all(is_within(scene.poses[id].p[:2], scene.allowed[id]) for id in contents)


def test_the_optimiser_gets_the_swept_area_and_body_of_a_drawer(library: Library) -> None:
    kind = next(k for k in own_kinds(library) if k.asset.name == "cabinet_one_drawer")
    item = kind.item("a", 0.0, np.array([1.0, 2.0]), None, None)
    assert item.size[1] > kind.asset.size[1] + 0.05
    np.testing.assert_allclose(item.rectangle(), kind.rectangle)
    np.testing.assert_allclose(item.body_rectangle(), kind.asset.bounds[:, :2])


def test_articulated_objects_stand_on_the_table_facing_the_robot(library: Library) -> None:
    movable = [kind for kind in own_kinds(library) if kind.asset.articulated]
    others = [kind for kind in own_kinds(library) if kind.opening is not None]
    scene = draw_scene([*movable, *others], 12, 2, False, np.random.default_rng(2))
    found = [id for id, kind in scene.kinds.items() if kind.asset.articulated]
    assert found and not set(found) & scene.containers.keys()
    assert all(np.degrees(abs(scene.poses[id].yaw)) <= 15 + 1e-9 for id in found)


def test_scenes_of_the_stage_keep_its_margin_and_have_something_to_grasp(library: Library) -> None:
    scene = draw_scene(own_kinds(library), 8, 2, False, np.random.default_rng(5), STAGE)
    rooms = [thing.room_in(Pose())[:, :2] for id, thing in clean_places(scene).items() if id not in scene.containers]
    gaps = [np.maximum(a[0] - b[1], b[0] - a[1]).max() for a, b in itertools.combinations(rooms, 2)]
    assert min(gaps) >= STAGE.margin - 1e-9
    assert scene.grasped
    assert {item.id for item in scene.items(scene.targets(0.0, np.random.default_rng(0))) if item.hand} == scene.grasped


def test_the_same_seed_draws_the_same_scene(library: Library) -> None:
    kinds = own_kinds(library)
    one, other = (draw_scene(kinds, 8, 2, True, np.random.default_rng(3)) for _ in range(2))
    assert one.relations == other.relations
    assert all(np.array_equal(one.poses[id].p, other.poses[id].p) for id in one.kinds)


# --- plan ----------------------------------------------------------------------------------------------


def square(x: float, y: float, half: float = 0.03) -> np.ndarray:
    return np.array([[x - half, y - half, 0.0], [x + half, y + half, 0.05]])


def test_a_word_that_barely_holds_is_not_robust() -> None:
    assert "right_of" in robust_words(square(0.03 + 2 * ROBUST, 0), square(0, 0))
    assert "right_of" not in robust_words(square(0.03 + ROBUST / 2, 0), square(0, 0))


def test_objects_that_nearly_touch_are_beside_each_other() -> None:
    assert {"beside", "near"} <= set(robust_words(square(0.061, 0), square(0, 0)))
    assert "beside" not in robust_words(square(0.06 + 0.095, 0), square(0, 0))


def test_one_object_alone_has_no_relation() -> None:
    assert plan_relations({"a": square(0, 0)}, {}, np.random.default_rng(0)) == []


# --- checks --------------------------------------------------------------------------------------------


def pair(library: Library, a: str, b: str, pose: Pose, container: str | None = None) -> dict[str, PlacedAsset]:
    return {a: PlacedAsset(library.asset(a), Pose()), b: PlacedAsset(library.asset(b), pose, container)}


def test_boxes_of_content_and_container_may_overlap_and_others_may_not(library: Library) -> None:
    assert colliding_boxes(pair(library, "tray", "block", Pose([0, 0, 0.005]), "tray")) == []
    assert colliding_boxes(pair(library, "tray", "block", Pose([0, 0, 0.005]))) == [("tray", "block")]


def test_contents_are_compared_in_the_frame_of_their_container(library: Library) -> None:
    turned = Pose.from_yaw([0, 0, 0], np.pi / 4)
    placed = {"tray": PlacedAsset(library.asset("tray"), turned)}
    for name, y in (("a", -0.021), ("b", 0.021)):
        placed[name] = PlacedAsset(library.asset("block"), turned * Pose([0, y, 0.005]), "tray")
    assert colliding_boxes(placed) == []


def test_an_object_in_the_way_of_a_drawer_collides(library: Library) -> None:
    kind = next(k for k in own_kinds(library) if k.asset.name == "cabinet_one_drawer")
    in_front = Pose([0, kind.asset.bounds[0, 1] - 0.05, 0])
    placed = {"block": PlacedAsset(library.asset("block"), in_front), "cabinet": PlacedAsset(kind.asset, Pose())}
    assert colliding_boxes(placed) == []
    placed["cabinet"] = PlacedAsset(kind.asset, Pose(), room=kind.rectangle)
    assert colliding_boxes(placed) == [("block", "cabinet")]


def test_an_object_in_the_wall_of_its_container_collides_by_mesh(library: Library) -> None:
    inside = pair(library, "basket", "block", Pose([0, 0, 0.006]), "basket")
    assert colliding_meshes(inside) == []
    in_the_wall = pair(library, "basket", "block", Pose([0.1, 0, 0.006]), "basket")
    assert colliding_meshes(in_the_wall) == [("basket", "block")]


@pytest.mark.parametrize(("gap", "collides"), [(-0.006, True), (-0.004, False), (0.0, False)])
def test_five_millimetres_are_a_touch(library: Library, gap: float, collides: bool) -> None:
    block = library.asset("block")
    other = PlacedAsset(block, Pose([block.size[0] + gap, 0.003, 0]))
    assert meshes_collide(PlacedAsset(block, Pose()), other) is collides


# --- rival ---------------------------------------------------------------------------------------------


def problem(rng: np.random.Generator, n: int = 8) -> LayoutProblem:
    workspace = np.array([[-0.3, -0.15], [0.3, 0.15]])
    allowed = [np.array([[[-0.2, -0.1], [0.1, 0.1]]]) if k % 3 == 0 else None for k in range(n)]
    half = rng.uniform(0.02, 0.06, (n, 2))
    words = itertools.cycle(["left_of", "behind", "near", "beside"])
    plan = [Relation(subject=f"o{k}", relation=next(words), reference=f"o{k - 1}") for k in range(1, n)]
    spots = {f"o{k}": RelatedBox(k, np.zeros(2), half[k]) for k in range(n)}
    terms = relation_terms(plan, spots, n)
    return LayoutProblem(half, rng.normal(0, 0.1, (n, 2)), workspace, 0.01, tuple(allowed), relations=terms)


def test_the_rival_minimises_the_cost_of_the_module() -> None:
    rng = np.random.default_rng(0)
    for _ in range(10):
        case = problem(rng)
        centres = rng.normal(0, 0.2, case.target.shape)
        assert PlainCost(case, CostWeights())(centres) == pytest.approx(evaluate(case, CostWeights(), centres)[0].total)


def test_the_rival_comes_down_and_stays_in_bounds() -> None:
    case = problem(np.random.default_rng(1))
    centres, value = finite_differences(case, CostWeights()), PlainCost(case, CostWeights())
    lower, upper = value.bounds
    assert np.all((lower - 1e-9 <= centres) & (centres <= upper + 1e-9))
    assert value(centres) < value(np.clip(case.target, lower, upper))


# --- rows ----------------------------------------------------------------------------------------------


def test_a_scene_without_noise_is_solved_and_keeps_its_plan(scene: CleanScene) -> None:
    outcome = optimize.measure(scene, 0.0, [0], rival=True)
    assert (outcome.boxes, outcome.in_bounds, outcome.kept) == ([], True, 1.0)
    assert outcome.rival_ratio > 0


def test_a_layout_declared_infeasible_is_searched_longer(scene: CleanScene, monkeypatch: pytest.MonkeyPatch) -> None:
    real, tried = optimize.optimize_layout, []

    def only_with_many_restarts(*args):
        tried.append(args[-1].restarts)
        if args[-1].restarts < 10:
            raise InfeasibleScene("no", hint="")
        return real(*args[:-1], replace(args[-1], restarts=1))

    monkeypatch.setattr(optimize, "optimize_layout", only_with_many_restarts)
    monkeypatch.setattr(optimize, "RESTARTS", 1)
    row = Row("plain", 0.01, 5, 0, [optimize.measure(scene, 0.01, [0], rival=False)])
    assert tried == [1, 10]
    record = row.record()
    assert (record["solved"], record["infeasible"], record["false_infeasible"]) == (0.0, 1.0, 1.0)
    assert record["relations_kept"] is None


def test_the_rival_is_given_every_object_once(scene: CleanScene) -> None:
    found = parts(scene, {id: pose.p[:2] for id, pose in scene.poses.items()}).values()
    assert sorted(id for part in found for id in part.ids) == sorted(scene.kinds)
    for part in found:
        assert PlainCost(part.problem, CostWeights())(part.problem.target) == pytest.approx(0.0, abs=1e-12)


def test_a_row_counts_scenes_and_not_pairs() -> None:
    row = Row("plain", 0.03, 10, 2)
    pairs = list(itertools.combinations("abc", 2))
    for found in ([], pairs):
        row.outcomes.append(Outcome(0.3, 1.0, 0.5, found, found, True, None, 0.9, [0.01, 0.03], 7, 1.0))
    record = row.record()
    assert (record["collision_aabb"], record["collision_mesh"], record["displacement_mm_p50"]) == (0.5, 0.5, 20.0)
