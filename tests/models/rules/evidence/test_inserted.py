"""Verdicts of the offline critic on inserting."""

from __future__ import annotations

from functools import cache

import pytest

from tests.example_scenes import library, scene_of, thing
from vcage.base.geometry import Pose
from vcage.episodes.question import Asking, cameras, verdict
from vcage.models.rules.evidence.inserted import InTheHole
from vcage.runs.context import StageContext
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.sim.cameras import shoot
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.tasks.inserting import inserting_ways

PEG, BLOCK = thing("peg", (-0.25, -0.05), 0.6), thing("peg_block", (0.1, 0.1))
GOAL = Goal(subject=PEG.id, relation="inserted_in", reference=BLOCK.id)
WAYS = [way for contact in PEG.asset.annotation.carrying_points for way in inserting_ways(PEG, BLOCK, contact, [])]


@pytest.mark.parametrize(
    ("left", "seen", "elsewhere", "share", "accepted", "why"),
    [
        (
            0.9,
            0.9,
            0.6,
            1.0,
            True,
            "90 % of the peg is seen in line with the hole of the block, 60 % as drawn beside it",
        ),
        (0.1, 0.9, 0.6, 1.0, False, "the peg lies where it was"),
        (0.9, 0.5, 0.4, 1.0, False, "50 % of the peg is seen in line with the hole"),
        (
            0.9,
            0.7,
            0.8,
            1.0,
            False,
            "70 % of the peg is seen in line with the hole of the block, 80 % as drawn beside it",
        ),
        (0.9, 0.9, 0.6, 0.5, False, "it fills 50 % of the hole"),
    ],
)
def test_a_thing_must_be_seen_deep_in_the_hole_and_better_than_elsewhere(
    left: float, seen: float, elsewhere: float, share: float, accepted: bool, why: str
) -> None:
    told = InTheHole(left, seen, elsewhere, share, Pose()).verdict("peg", "block")
    assert told.accepted is accepted and why in told.reason


@cache
def table():
    """A scene of a peg and a block, drawn."""
    scene = scene_of([PEG, BLOCK])
    models = {o.id: library().asset(o.record.asset, o.record.variant).model for o in (PEG, BLOCK)}
    return scene, World.of_scene(scene, models, load_robot(scene.robot), render=True)


def told_of(peg: Pose, block: Pose = BLOCK.pose) -> Verdict:
    """The verdict on a peg and a block at some poses afterwards."""
    scene, world = table()
    seen = {}
    for when, poses in {"before": (PEG.pose, BLOCK.pose), "after": (peg, block)}.items():
        for name, pose in zip((PEG.id, BLOCK.id), poses, strict=True):
            world.set_object_pose(name, pose)
        seen[when] = {name: shoot(world, camera) for name, camera in cameras(scene, [GOAL]).items()}
    return verdict(StageContext("offline"), scene, Asking("Insert the peg into the peg block", [GOAL], seen))


def drawn_out(far: float, number: int = 0) -> Pose:
    """The peg drawn out of the hole by some metres."""
    deep, way = WAYS[number][-1], WAYS[number][-1].p - WAYS[number][0].p
    return Pose(deep.p - far * way / (way @ way) ** 0.5, deep.q)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(4))
def test_a_peg_seen_in_the_hole_from_either_side_is_inserted(number: int) -> None:
    told = told_of(drawn_out(0.0, number))
    assert told.accepted, told.reason


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pose", "why"),
    [
        (PEG.pose, "lies where it was"),
        (drawn_out(0.04), "of the hole"),
        (drawn_out(0.1), "of the hole"),
        (Pose.from_yaw(BLOCK.pose.p + [-0.11, 0.0, 0.0], 0.0), "is seen in line with the hole"),
        (Pose.from_yaw(BLOCK.pose.p + [0.02, 0.09, 0.0], 1.0), "is seen in line with the hole"),
        (Pose.from_yaw(BLOCK.pose.p + [0.0, 0.0, 0.085], 0.0), "is seen in line with the hole"),
    ],
    ids=["not moved", "half in", "before the mouth", "on the table before it", "beside", "on top"],
)
def test_a_peg_seen_elsewhere_is_not_inserted(pose: Pose, why: str) -> None:
    told = told_of(pose)
    assert not told.accepted and why in told.reason


@pytest.mark.slow
def test_a_peg_in_a_block_that_was_pushed_away_is_not_accepted() -> None:
    away = Pose([0.12, 0.06, 0.0])
    told = told_of(Pose(drawn_out(0.0).p + away.p, drawn_out(0.0).q), Pose(BLOCK.pose.p + away.p))
    assert not told.accepted and "in line with the hole" in told.reason
