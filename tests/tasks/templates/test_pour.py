"""Pouring: a vessel is tipped over a container, and goes back to its place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from tests.example_scenes import thing, world_of
from tests.example_scenes import workplace as example
from vcage.base.geometry import Pose
from vcage.schema.goals import Goal
from vcage.sim.kinematics import kinematics_of
from vcage.sim.robots import load_robot
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import Watch
from vcage.tasks.stowing import heaped_in
from vcage.tasks.task import Task
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.truth import goals_hold
from vcage.tasks.workcell import TaskFailed
from vcage.tasks.workplace import Workplace

CUP, BOWL = thing("cup", (-0.2, -0.02)), thing("bowl", (0.05, 0.05))
GOAL = Goal(subject=CUP.id, relation="poured", reference=BOWL.id)
POUR = TEMPLATES["pour"]
ROBOT = load_robot("aloha_agilex")


def workplace(objects: Sequence[SceneObject]) -> Workplace:
    """Objects on the ground of the examples, with the arms of a robot that pours."""
    return replace(example(objects), kinematics={name: kinematics_of(arm) for name, arm in ROBOT.arms.items()})


def filled(vessel: SceneObject, count: int = 3) -> list[SceneObject]:
    """Balls that lie in a vessel."""
    balls = [thing("ball", id=f"ball_{number}", container=vessel.id) for number in range(count)]
    poses = heaped_in(vessel, balls, np.random.default_rng(0))
    return [
        replace(ball.moved(poses[ball.id]), record=ball.record.model_copy(update={"heaped": True})) for ball in balls
    ]


def examined(*objects: SceneObject, goal: Goal = GOAL):
    (proposal,), _ = POUR.proposals(objects, [goal])
    return proposal.examine(workplace([*objects]))


def why_not(*objects: SceneObject, goal: Goal = GOAL) -> str:
    """The first reason why something is not poured."""
    (proposal,), _ = POUR.proposals(objects, [goal])
    if (refusal := proposal.impossible()) is not None:
        return refusal.reason
    subtask, refused = proposal.examine(workplace([*objects]))
    assert subtask is None
    return refused[0].reason


def test_a_cup_with_balls_in_reach_of_a_bowl_is_poured_into_it() -> None:
    subtask, _ = examined(CUP, BOWL, *filled(CUP))
    assert subtask is not None and subtask.goals == [GOAL]
    assert (subtask.object, subtask.grasped, subtask.receptacle) == (CUP.id, CUP.id, None)
    assert subtask.text == "Pour the white cup into the white bowl." and len({subtask.text, *subtask.texts}) >= 10


def test_nothing_is_poured_unless_it_is_asked_for() -> None:
    assert not POUR.proposals([CUP, BOWL, *filled(CUP)], ())[0]


def test_an_empty_vessel_is_refused_by_name() -> None:
    assert why_not(CUP, BOWL) == "nothing lies in white cup that could be poured"


def test_what_is_no_vessel_is_refused_by_name() -> None:
    block = thing("block", (-0.2, 0.0))
    goal = Goal(subject=block.id, relation="poured", reference=BOWL.id)
    assert "red block is no vessel" in why_not(block, BOWL, goal=goal)


def test_what_does_not_roll_is_refused_by_name() -> None:
    block = thing("small_block").moved(Pose(CUP.pose.p + [0.0, 0.0, 0.006]))
    assert why_not(CUP, BOWL, block) == "red small block lies in white cup, and only balls are poured"


@pytest.mark.parametrize(
    ("name", "why"),
    [("ramekin", "ramekin is too narrow to pour into: 5.6 × 5.6 cm"), ("plate", "plate is not open at the top")],
)
def test_a_narrow_or_flat_target_is_refused_by_name(name: str, why: str) -> None:
    goal = Goal(subject=CUP.id, relation="poured", reference=name)
    assert why in why_not(CUP, thing(name, (0.05, 0.05)), *filled(CUP), goal=goal)


def test_more_balls_than_the_container_holds_are_refused_by_name() -> None:
    pot, bowl = thing("pot", (-0.2, 0.0)), thing("small_bowl", (0.1, 0.05))
    goal = Goal(subject=pot.id, relation="poured", reference=bowl.id)
    assert "has no room for 30 balls below its rim" in why_not(pot, bowl, *filled(pot, 30), goal=goal)


def test_a_bowl_that_turns_between_soft_fingers_is_refused_where_it_is_held() -> None:
    small = thing("small_bowl", (-0.2, 0.0))
    goal = Goal(subject=small.id, relation="poured", reference=BOWL.id)
    objects = [small, BOWL, *filled(small)]
    (proposal,), _ = POUR.proposals(objects, [goal])
    subtask, refused = proposal.examine(example(objects))  # whose fingers are soft
    assert subtask is None and "turns between fingers that are not firm" in refused[0].reason


def test_a_container_out_of_reach_is_refused_with_a_reason_for_each_contact_point() -> None:
    subtask, refused = examined(CUP, thing("bowl", (0.0, 1.0)), *filled(CUP))
    assert subtask is None and len(refused) == len(CUP.asset.annotation.carrying_points)
    assert all("does not reach its place over white bowl, tipped" in refusal.reason for refusal in refused)


def played(*objects: SceneObject, goal: Goal = GOAL):
    """A task after pouring, its watch and its world."""
    subtask, refused = examined(*objects, goal=goal)
    assert subtask is not None, refused
    by_id, world = {o.id: o for o in objects}, world_of(objects, ROBOT)
    world.settle()
    task, watch = Task(world, by_id, {}), Watch(world, by_id, [goal])
    task.pour(goal.subject, str(goal.reference), [(grasp.contact, grasp.arm) for grasp in subtask.grasps])
    task.home()
    return task, watch, world


def test_the_robot_pours_all_balls_and_puts_the_cup_back() -> None:
    task, watch, world = played(CUP, BOWL, *filled(CUP))
    truth = goals_hold([GOAL], watch)
    assert truth.success, truth.reason
    assert task.moment is not None and task.moment.objects[CUP.id].rotation()[2, 2] < 0
    assert np.linalg.norm(world.object_pose(CUP.id).p - CUP.pose.p) < 0.02
    assert watch.contents(CUP.id) and not any(watch.lies_in(name, CUP.id) for name in watch.contents(CUP.id))


def test_a_ball_that_stays_in_the_cup_ends_the_attempt(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vcage.tasks.primitives.pour.left_in", lambda _, balls: [*balls][:1])
    with pytest.raises(TaskFailed, match="1 of 3 stay in the white cup when it is tipped"):
        played(CUP, BOWL, *filled(CUP))
