"""Verdicts of the offline critic on hanging."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from tests.example_scenes import library, scene_of, thing
from vcage.base.geometry import Pose
from vcage.episodes.question import Asking, cameras, verdict
from vcage.models.rules.evidence.hung import Hung
from vcage.runs.context import StageContext
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.sim.cameras import shoot
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.tasks.hanging import hanging_ways, hung_poses

MUG, RACK = thing("mug", (-0.25, -0.05), 0.6, variant="blue"), thing("mug_rack", (0.1, 0.1))
GOAL = Goal(subject=MUG.id, relation="hung_on", reference=RACK.id)
HUNG = [*hung_poses(MUG, RACK, [])]
HELD = [way[-1] for way in hanging_ways(MUG, RACK, [])]


@pytest.mark.parametrize(
    ("left", "seen", "elsewhere", "accepted", "why"),
    [
        (0.9, 0.9, 0.6, True, "90 % of the mug is seen hanging on the rack"),
        (0.1, 0.9, 0.6, False, "the mug stands where it was"),
        (0.9, 0.5, 0.4, False, "50 % of the mug is seen hanging on the rack, 40 % as drawn beside it"),
        (0.9, 0.7, 0.8, False, "70 % of the mug is seen hanging on the rack, 80 % as drawn beside it"),
    ],
)
def test_a_thing_must_be_seen_on_the_peg_better_than_elsewhere(
    left: float, seen: float, elsewhere: float, accepted: bool, why: str
) -> None:
    told = Hung(left, seen, elsewhere, Pose()).verdict("mug", "rack")
    assert told.accepted is accepted and why in told.reason


@cache
def table():
    """A scene of a mug and a rack, drawn."""
    scene = scene_of([MUG, RACK])
    models = {o.id: library().asset(o.record.asset, o.record.variant).model for o in (MUG, RACK)}
    return scene, World.of_scene(scene, models, load_robot(scene.robot), render=True)


def hung(mug: Pose, rack: Pose = RACK.pose) -> Verdict:
    """The verdict on a mug and a rack at some poses afterwards."""
    scene, world = table()
    seen = {}
    for when, poses in {"before": (MUG.pose, RACK.pose), "after": (mug, rack)}.items():
        for name, pose in zip((MUG.id, RACK.id), poses, strict=True):
            world.set_object_pose(name, pose)
        seen[when] = {name: shoot(world, camera) for name, camera in cameras(scene, [GOAL]).items()}
    return verdict(StageContext("offline"), scene, Asking("Hang the mug on the mug rack", [GOAL], seen))


@pytest.mark.slow
@pytest.mark.parametrize("number", [0, 3])
def test_a_mug_seen_on_either_peg_hangs(number: int) -> None:
    told = hung(HUNG[number])
    assert told.accepted, told.reason


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pose", "why"),
    [
        (MUG.pose, "stands where it was"),
        (Pose.from_yaw(RACK.pose.p + [-0.1, -0.08, 0.0], 1.0), "is seen hanging on the"),
        (Pose(RACK.pose.p + [0.12, 0.0, 0.035], [np.cos(np.pi / 4), np.sin(np.pi / 4), 0.0, 0.0]), "is seen hanging"),
        (HELD[0], "is seen hanging on the"),
    ],
    ids=["not moved", "beside", "lying", "upright on the peg"],
)
def test_a_mug_seen_elsewhere_does_not_hang(pose: Pose, why: str) -> None:
    told = hung(pose)
    assert not told.accepted and why in told.reason


@pytest.mark.slow
def test_a_rack_that_was_pushed_away_with_the_mug_was_disturbed() -> None:
    away = Pose([0.07, 0.0, 0.0])
    told = hung(Pose(HUNG[0].p + away.p, HUNG[0].q), Pose(RACK.pose.p + away.p, RACK.pose.q))
    assert not told.accepted and "from where it stood before" in told.reason
