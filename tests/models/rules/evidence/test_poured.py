"""Verdicts of the offline critic on pouring."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from tests.example_scenes import library, scene_of, thing
from vcage.base.geometry import Pose
from vcage.episodes.question import Asking, cameras, verdict
from vcage.models.rules.evidence.poured import Poured, discs
from vcage.runs.context import StageContext
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.sim.cameras import shoot
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.tasks.pouring import pouring_ways
from vcage.tasks.stowing import heaped_in

CUP, BOWL = thing("cup", (-0.2, -0.05)), thing("bowl", (0.1, 0.1))
GOAL = Goal(subject=CUP.id, relation="poured", reference=BOWL.id)
LOOSE = [thing("ball", id=name, container=CUP.id, variant=colour) for name, colour in (("one", "red"), ("two", "blue"))]
TIPPED = next(pouring_ways(CUP, BOWL, CUP.asset.annotation.carrying_points[0]))[-1]


def disc(rows: int, *middles: tuple[int, int], radius: float = 6.0) -> np.ndarray:
    """A mask of discs."""
    y, x = np.mgrid[:rows, :rows]
    return np.any([np.hypot(y - v, x - u) <= radius for u, v in middles], axis=0).astype(np.float32)


@pytest.mark.parametrize(
    ("middles", "count"),
    [(((20, 20),), 1), (((20, 20), (32, 20)), 2), (((20, 20), (32, 20), (26, 30)), 3), (((20, 20), (40, 40)), 2)],
)
def test_balls_that_touch_are_counted_one_by_one(middles: tuple[tuple[int, int], ...], count: int) -> None:
    assert discs(disc(60, *middles), 6.0) == count


def test_a_speck_is_no_ball() -> None:
    assert discs(disc(60, (20, 20), radius=3.0), 6.0) == 0


@pytest.mark.parametrize(
    ("found", "accepted", "why"),
    [
        (Poured(left=0.9, stands=True, there=3, still=0, of=3), True, "3 of the 3 balls"),
        (Poured(left=0.9, stands=True, there=2, still=0, of=3), False, "2 of the 3 balls"),
        (Poured(left=0.9, stands=True, there=2, still=1, of=3), False, "1 of 3 balls are still seen in the cup"),
        (Poured(left=0.9, stands=False, there=3, still=0, of=3), False, "is not seen to stand upright"),
        (Poured(left=0.1, stands=True, there=3, still=0, of=3), False, "stands where it was"),
    ],
)
def test_all_balls_must_be_seen_in_the_container_and_none_in_the_vessel(
    found: Poured, accepted: bool, why: str
) -> None:
    told = found.verdict("cup", "bowl")
    assert told.accepted is accepted and why in told.reason


@cache
def table():
    """A scene of a cup with two balls, and a bowl, drawn; and the poses of the balls in each."""
    in_cup, in_bowl = (heaped_in(where, LOOSE, np.random.default_rng(0)) for where in (CUP, BOWL))
    balls = [replace(o.moved(in_cup[o.id]), record=o.record.model_copy(update={"heaped": True})) for o in LOOSE]
    objects = [CUP, BOWL, *balls]
    scene = scene_of(objects)
    models = {o.id: library().asset(o.record.asset, o.record.variant).model for o in objects}
    return scene, World.of_scene(scene, models, load_robot(scene.robot), render=True), in_cup, in_bowl


def poured(after: dict[str, Pose], moment: Pose = TIPPED) -> Verdict:
    """The verdict on a cup that is tipped at the moment, and things that are elsewhere afterwards."""
    scene, world, in_cup, in_bowl = table()
    start = {CUP.id: CUP.pose, BOWL.id: BOWL.pose, **in_cup}
    states = {"before": {}, "moment": {**in_bowl, CUP.id: moment}, "after": {**in_bowl, **after}}
    seen = {}
    for when, moved in states.items():
        for name, pose in (start | moved).items():
            world.set_object_pose(name, pose)
        seen[when] = {name: shoot(world, camera) for name, camera in cameras(scene, [GOAL]).items()}
    return verdict(StageContext("offline"), scene, Asking("Pour the cup", [GOAL], seen, grasped=CUP.id))


@pytest.mark.slow
def test_balls_seen_in_the_bowl_and_an_empty_cup_are_poured() -> None:
    told = poured({})
    assert told.accepted and "2 of the 2 balls" in told.reason, told.reason


@pytest.mark.slow
@pytest.mark.parametrize("name", ["one", "two"])
def test_a_ball_seen_beside_the_bowl_is_not_poured(name: str) -> None:
    told = poured({name: Pose([0.25, 0.1, 0.74])})
    assert not told.accepted and "1 of the 2 balls" in told.reason


@pytest.mark.slow
def test_a_ball_seen_in_the_cup_is_not_poured() -> None:
    told = poured({"one": table()[2]["one"]})
    assert not told.accepted and told.failure == "lost"


@pytest.mark.slow
def test_a_cup_that_lies_on_its_side_is_not_put_back() -> None:
    lies = Pose([-0.2, -0.05, 0.775], [np.cos(np.pi / 4), np.sin(np.pi / 4), 0.0, 0.0])
    assert not poured({CUP.id: lies}).accepted


@pytest.mark.slow
def test_a_cup_that_stays_at_its_place_pours_nothing() -> None:
    told = poured({}, moment=CUP.pose)
    assert not told.accepted and "stands where it was" in told.reason
