"""Verdicts of the offline critic on standing up."""

from __future__ import annotations

from functools import cache

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

BOTTLE = thing("bottle", (-0.15, -0.05), 2.0, variant="water_lying")
CAN = thing("can", (-0.15, -0.05), 2.0, variant="corn_lying")
THERE = Pose.from_yaw([0.15, 0.0, 0.74], 0.4)


@cache
def table(name: str):
    """A scene of one lying thing, drawn."""
    (lying,) = (one for one in (BOTTLE, CAN) if one.id == name)
    scene = scene_of([lying])
    models = {name: library().asset(lying.record.asset, lying.record.variant).model}
    return lying, scene, World.of_scene(scene, models, load_robot(scene.robot), render=True)


def seen_at(name: str, pose: Pose) -> Verdict:
    """The verdict on a thing that is at a pose afterwards."""
    lying, scene, world = table(name)
    goals, seen = [Goal(subject=name, relation="upright")], {}
    for when, at in (("before", lying.pose), ("after", pose)):
        world.set_object_pose(name, at)
        seen[when] = {camera: shoot(world, one) for camera, one in cameras(scene, goals).items()}
    return verdict(StageContext("offline"), scene, Asking("Stand it up", goals, seen))


def standing(name: str, turn: Pose | None = None) -> Pose:
    """Its frame where it stands, in another attitude where one is given."""
    return THERE * (turn or Pose()) * table(name)[0].asset.stands.inverse()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bottle", "can"])
def test_what_is_seen_on_its_bottom_was_stood_up(name: str) -> None:
    told = seen_at(name, standing(name))
    assert told.accepted, told.reason


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bottle", "can"])
def test_what_is_seen_on_its_head_was_not(name: str) -> None:
    lying = table(name)[0]
    assert lying.asset.standing is not None
    over = Pose([0.0, 0.0, lying.asset.standing.size[2]], [0.0, 1.0, 0.0, 0.0])
    told = seen_at(name, standing(name, over))
    assert not told.accepted, told.reason


@pytest.mark.slow
@pytest.mark.parametrize("name", ["bottle", "can"])
@pytest.mark.parametrize("turn", [0.0, 1.0, 2.5])
def test_what_was_carried_there_and_lies_was_not(name: str, turn: float) -> None:
    assert not seen_at(name, Pose.from_yaw(THERE.p, turn)).accepted


@pytest.mark.slow
def test_what_stays_where_it_lay_was_not() -> None:
    told = seen_at("bottle", BOTTLE.pose)
    assert not told.accepted and "still lies where it was" in told.reason


@pytest.mark.slow
def test_what_did_not_lie_at_the_start_is_not_judged() -> None:
    scene = scene_of([upright := thing("bottle", (-0.15, -0.05))])
    world = World.of_scene(scene, {"bottle": upright.asset.model}, load_robot(scene.robot), render=True)
    goals = [Goal(subject="bottle", relation="upright")]
    shots = {camera: shoot(world, one) for camera, one in cameras(scene, goals).items()}
    told = verdict(StageContext("offline"), scene, Asking("Stand it up", goals, {"before": shots, "after": shots}))
    assert not told.accepted and "lay on its side" in told.reason


@pytest.mark.slow
@pytest.mark.parametrize(("there", "accepted"), [((0.25, 0.0), True), ((0.25, 0.25), False)])
def test_a_thing_is_seen_beside_what_was_stood_up_before(there: tuple[float, float], accepted: bool) -> None:
    block = thing("block", (-0.25, 0.2))
    scene = scene_of([BOTTLE, block])
    models = {one.id: one.asset.model for one in (BOTTLE, block)}
    world = World.of_scene(scene, models, load_robot(scene.robot), render=True)
    world.set_object_pose("bottle", standing("bottle"))
    goals, seen = [Goal(subject="block", relation="beside", reference="bottle")], {}
    for when, at in (("before", block.pose), ("after", Pose.from_yaw([*there, block.pose.p[2]], 0.0))):
        world.set_object_pose("block", at)
        seen[when] = {camera: shoot(world, one) for camera, one in cameras(scene, goals).items()}
    told = verdict(StageContext("offline"), scene, Asking("Put the block beside the bottle", goals, seen))
    assert told.accepted == accepted, told.reason
