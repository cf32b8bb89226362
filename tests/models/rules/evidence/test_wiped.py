"""Verdicts of the offline critic on wiping."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from tests.example_scenes import library, scene_of, thing
from vcage.base.geometry import Pose
from vcage.episodes.question import Asking, cameras, verdict
from vcage.runs.context import StageContext
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.sim.cameras import shoot
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.tasks.wiping import farthest, wiping_ways

pytestmark = pytest.mark.slow

TRAY, SPONGE = thing("tray", (0.1, 0.1), 0.2), thing("sponge", (-0.25, -0.05), 0.6)
GOAL = Goal(subject=TRAY.id, relation="wiped")
WAY = next(wiping_ways(SPONGE, TRAY, above_m=0.0))
BEGIN, FAR = WAY[0], WAY[farthest(WAY)]


@cache
def table():
    """A scene of a tray and a sponge, drawn."""
    scene = scene_of([TRAY, SPONGE])
    models = {o.id: library().asset(o.record.asset, o.record.variant).model for o in (TRAY, SPONGE)}
    return scene, World.of_scene(scene, models, load_robot(scene.robot), render=True)


def wiped(moment: Pose | None, later: Pose | None, tray: Pose = TRAY.pose) -> Verdict:
    """The verdict on a sponge at two poses, one after the other, and a tray at another one afterwards."""
    scene, world = table()
    states = {"before": {}, "moment": {SPONGE.id: moment}, "later": {SPONGE.id: later}, "after": {TRAY.id: tray}}
    seen = {}
    for when, moved in states.items():
        if None not in moved.values():
            for o in (TRAY, SPONGE):
                world.set_object_pose(o.id, moved.get(o.id, o.pose))
            seen[when] = {name: shoot(world, camera) for name, camera in cameras(scene, [GOAL]).items()}
    return verdict(StageContext("offline"), scene, Asking("Wipe the tray", [GOAL], seen, grasped=SPONGE.id))


def test_a_sponge_seen_at_both_ends_of_a_tray_wipes_it() -> None:
    told = wiped(BEGIN, FAR)
    assert told.accepted, told.reason


@pytest.mark.parametrize("up", [0.05, 0.08])
def test_a_sponge_seen_over_a_tray_wipes_nothing(up: float) -> None:
    told = wiped(*(Pose(pose.p + [0.0, 0.0, up], pose.q) for pose in (BEGIN, FAR)))
    assert not told.accepted and "is seen on the" in told.reason


@pytest.mark.parametrize("spot", [BEGIN, FAR], ids=["begin", "far"])
def test_a_sponge_seen_at_one_spot_twice_wipes_nothing(spot: Pose) -> None:
    told = wiped(spot, spot)
    assert not told.accepted and "is seen on the" in told.reason


def test_a_sponge_seen_beside_a_tray_wipes_nothing() -> None:
    away = np.array([-0.3, 0.0, SPONGE.pose.p[2] - BEGIN.p[2]])
    told = wiped(*(Pose(pose.p + away, pose.q) for pose in (BEGIN, FAR)))
    assert not told.accepted and "is seen on the" in told.reason


def test_a_sponge_that_lies_where_it_was_wipes_nothing() -> None:
    told = wiped(SPONGE.pose, SPONGE.pose)
    assert not told.accepted and "lies where it was" in told.reason


def test_a_tray_that_was_pushed_away_is_not_wiped() -> None:
    told = wiped(BEGIN, FAR, tray=Pose(TRAY.pose.p + [0.08, 0.0, 0.0], TRAY.pose.q))
    assert not told.accepted and told.failure == "disturbed"


def test_without_a_picture_of_the_second_moment_nothing_is_wiped() -> None:
    told = wiped(BEGIN, None)
    assert not told.accepted and "no picture shows the moments" in told.reason
