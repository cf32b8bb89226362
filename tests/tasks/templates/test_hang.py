"""Hanging: the handle of a mug is slid over a peg, and the mug stays there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from tests.example_scenes import thing, world_of
from tests.example_scenes import workplace as example
from vcage.base.geometry import Pose
from vcage.goals import KINDS
from vcage.schema.goals import Goal
from vcage.schema.robot import Robot
from vcage.sim.kinematics import kinematics_of
from vcage.sim.robots import load_robot
from vcage.tasks.hanging import SETTINGS, free_pegs, hangs_on, hung_poses
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import Watch
from vcage.tasks.task import Task
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.truth import goals_hold

MUG, RACK = thing("mug", (-0.2, -0.05), 0.4), thing("mug_rack", (0.0, 0.03))
GOAL = Goal(subject=MUG.id, relation="hung_on", reference=RACK.id)
HANG = TEMPLATES["hang"]


def examined(*objects: SceneObject, goal: Goal = GOAL, robot: str = "aloha_agilex"):
    (proposal,), _ = HANG.proposals(objects, [goal])
    arms = {name: kinematics_of(arm) for name, arm in load_robot(robot).arms.items()}
    return proposal.examine(replace(example([*objects]), kinematics=arms))


def why_not(*objects: SceneObject, goal: Goal = GOAL) -> str:
    """The first reason why something is not hung."""
    (proposal,), _ = HANG.proposals(objects, [goal])
    if (refusal := proposal.impossible()) is not None:
        return refusal.reason
    subtask, refused = proposal.examine(example([*objects]))
    assert subtask is None
    return refused[0].reason


def hanging(id: str, number: int) -> SceneObject:
    """A mug that hangs on the rack, at one of its poses there."""
    mug = thing("mug", (-0.2, 0.2), id=id)
    return mug.moved([*hung_poses(mug, RACK, [])][number])


def test_a_mug_in_reach_of_a_rack_is_hung_on_it_by_its_body() -> None:
    subtask, refused = examined(MUG, RACK)
    assert subtask is not None and subtask.goals == [GOAL]
    assert (subtask.object, subtask.grasped, subtask.receptacle) == (MUG.id, MUG.id, None)
    assert {grasp.contact for grasp in subtask.grasps} == {3}
    assert subtask.text == "Hang the white mug on the light brown mug rack."
    assert len({subtask.text, *subtask.texts}) >= 10
    assert any("has fingers in its handle" in one.reason for one in refused)
    assert any("turns between the fingers" in one.reason for one in refused)


def test_nothing_is_hung_unless_it_is_asked_for() -> None:
    assert not HANG.proposals([MUG, RACK], ())[0]


@pytest.mark.parametrize("name", ["cup", "block"])
def test_what_has_no_closed_handle_is_refused_by_name(name: str) -> None:
    other = thing(name, (-0.2, -0.05))
    goal = Goal(subject=other.id, relation="hung_on", reference=RACK.id)
    assert "has no closed handle to hang it by" in why_not(other, RACK, goal=goal)


def test_what_has_no_peg_is_refused_by_name() -> None:
    bowl = thing("bowl", (0.05, 0.05))
    goal = Goal(subject=MUG.id, relation="hung_on", reference=bowl.id)
    assert why_not(MUG, bowl, goal=goal) == "white bowl has no peg to hang something on"


def test_a_rack_without_a_free_peg_is_refused_by_name() -> None:
    one, other = hanging("one", 0), hanging("other", 2)
    assert len(free_pegs(RACK, [one])) == 1 and free_pegs(RACK, [one, other]) == []
    assert why_not(MUG, RACK, one, other) == "every peg of light brown mug rack is taken"


def test_more_things_than_pegs_are_refused_by_name() -> None:
    mugs = [thing("mug", (0.1 * number, -0.2), id=f"mug_{number}") for number in range(3)]
    goals = [Goal(subject=mug.id, relation="hung_on", reference=RACK.id) for mug in mugs]
    found, refused = HANG.proposals([*mugs, RACK], goals)
    assert found == [] and len(refused) == 3
    assert {one.reason for one in refused} == {"light brown mug rack has 2 pegs, and 3 things are to hang on it"}


def test_pegs_that_are_too_thick_are_refused_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vcage.tasks.hanging.SETTINGS", replace(SETTINGS, room_m=0.02))
    assert "are too thick for the handle of white mug" in why_not(MUG, RACK)


def test_a_rack_out_of_reach_is_refused() -> None:
    subtask, refused = examined(MUG, thing("mug_rack", (0.0, 1.0)))
    assert subtask is None
    assert any("does not reach a peg of light brown mug rack" in one.reason for one in refused)


def played(robot: Robot, objects: Sequence[SceneObject], grasps: Sequence[tuple[int, str]]):
    """A watch after hanging."""
    by_id, world = {o.id: o for o in objects}, world_of(objects, robot)
    world.settle()
    task, watch = Task(world, by_id, {}), Watch(world, by_id, [GOAL])
    task.hang(GOAL.subject, str(GOAL.reference), grasps)
    task.home()
    return watch


@pytest.mark.parametrize("robot", ["aloha_agilex", "dual_panda"])
def test_the_robot_hangs_the_mug_and_lets_it_go(robot: str) -> None:
    subtask, refused = examined(MUG, RACK, robot=robot)
    assert subtask is not None, refused
    watch = played(load_robot(robot), [MUG, RACK], [(grasp.contact, grasp.arm) for grasp in subtask.grasps])
    truth = goals_hold([GOAL], watch)
    assert truth.success, truth.reason
    assert watch.touching(MUG.id) <= {RACK.id} and watch.thing(MUG.id).lowest > watch.table_height + 0.03
    assert np.linalg.norm(watch.thing(RACK.id).pose.p - RACK.pose.p) < 0.01


def test_a_mug_hangs_near_the_poses_at_which_it_is_expected() -> None:
    mug = hanging(MUG.id, 0)
    world = world_of([mug, RACK])
    world.set_object_pose(mug.id, mug.pose)
    world.step(500)
    assert np.linalg.norm(world.object_pose(mug.id).p - mug.pose.p) < 0.02


def complaint_of(mug: SceneObject, steps: int = 500, *others: SceneObject) -> str | None:
    """Why a mug does not hang, some physics steps after it was left at its pose."""
    objects = [mug, RACK, *others]
    world = world_of(objects)
    for o in objects:
        world.set_object_pose(o.id, o.pose)
    watch = Watch(world, {o.id: o for o in objects}, [GOAL])
    world.step(steps)
    return KINDS["hung_on"].complaint(GOAL, watch)


def test_a_mug_at_rest_on_a_peg_hangs() -> None:
    assert complaint_of(hanging(MUG.id, 0)) is None


def test_a_mug_beside_the_rack_does_not_hang() -> None:
    assert complaint_of(MUG, 20) == "no peg of mug_rack passes through the handle of mug"


def test_a_mug_that_swings_does_not_hang_yet() -> None:
    rest = hanging(MUG.id, 0)
    (peg, *_), tilt = free_pegs(RACK, []), np.radians(40)
    about = Pose(peg.at(0.04)) * Pose(q=[np.cos(tilt / 2), *(np.sin(tilt / 2) * peg.axis)]) * Pose(-peg.at(0.04))
    assert complaint_of(rest.moved(about * rest.pose), 15) == "mug still swings on mug_rack"


def test_a_mug_that_leans_on_a_peg_is_not_threaded() -> None:
    beside = MUG.moved(Pose(RACK.pose.p + [-0.06, -0.045, 0.1], MUG.pose.q))
    assert not hangs_on(beside, RACK)
