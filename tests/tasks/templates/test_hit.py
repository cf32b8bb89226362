"""Hitting: the head of a tool comes down on an object, and the tool goes back."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import robot, thing, with_fingers, workplace, world_of
from vcage.base.geometry import Pose
from vcage.schema.goals import Goal
from vcage.schema.robot import Robot
from vcage.tasks.state import Watch
from vcage.tasks.task import Task
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.truth import goals_hold
from vcage.tasks.workcell import TaskFailed

BLOCK, HAMMER = thing("block", (0.05, 0.05)), thing("hammer", (-0.2, -0.05), 0.6)
GOAL = Goal(subject=BLOCK.id, relation="hit")
HIT = TEMPLATES["hit"]


def examined(block=BLOCK, hammer=HAMMER):
    (proposal,), _ = HIT.proposals([block, hammer], [GOAL])
    return proposal.examine(workplace([block, hammer]))


def grasps(subtask) -> list[tuple[int, str]]:
    return [(grasp.contact, grasp.arm) for grasp in subtask.grasps]


def test_a_block_in_reach_of_a_hammer_in_reach_is_hit() -> None:
    subtask, _ = examined()
    assert subtask is not None and subtask.goals == [GOAL]
    assert (subtask.object, subtask.tool, subtask.grasped, subtask.receptacle) == (BLOCK.id, HAMMER.id, HAMMER.id, None)
    assert len({subtask.text, *subtask.texts}) >= 10


def test_the_hammer_is_held_near_its_head_where_an_arm_can() -> None:
    subtask, _ = examined()
    assert [grasp.contact for grasp in subtask.grasps] == [1, 1, 0, 0]


def test_nothing_is_hit_unless_it_is_asked_for_and_nothing_by_itself() -> None:
    assert not HIT.proposals([BLOCK, HAMMER], ())[0]
    assert not HIT.proposals([BLOCK, HAMMER], [Goal(subject=HAMMER.id, relation="hit")])[0]


def test_a_block_out_of_reach_is_refused_with_a_reason_for_each_contact_point() -> None:
    subtask, refused = examined(thing("block", (0.0, 1.0)))
    assert subtask is None and len(refused) == len(HAMMER.asset.annotation.carrying_points)
    assert all("does not reach" in refusal.reason for refusal in refused)


@pytest.mark.parametrize("hands", [robot(), with_fingers(10_000.0)], ids=["soft fingers", "firm fingers"])
def test_the_robot_hits_a_block_and_puts_the_hammer_back(hands: Robot) -> None:
    subtask, _ = examined()
    objects = {o.id: o for o in (BLOCK, HAMMER)}
    world = world_of([BLOCK, HAMMER], hands)
    world.settle()
    task, watch = Task(world, objects, {}), Watch(world, objects, [GOAL])
    task.hit(HAMMER.id, BLOCK.id, grasps(subtask))
    task.home()
    assert goals_hold([GOAL], watch).success
    assert task.moment is not None and task.moment.objects[HAMMER.id].p[2] > BLOCK.aabb[1, 2] - 0.005
    assert np.linalg.norm(world.object_pose(BLOCK.id).p - BLOCK.pose.p) < 0.005
    assert np.linalg.norm(world.object_pose(HAMMER.id).p - HAMMER.pose.p) < 0.02


def test_recorders_see_each_step_of_a_hit_once() -> None:
    subtask, _ = examined()
    world, seen = world_of([BLOCK, HAMMER]), list[int]()
    world.settle()
    world.before_step.append(lambda world: seen.append(world.steps))
    Task(world, {o.id: o for o in (BLOCK, HAMMER)}, {}).hit(HAMMER.id, BLOCK.id, grasps(subtask))
    assert len(seen) == len({*seen})


def test_a_head_that_meets_nothing_fails_and_is_no_hit(monkeypatch: pytest.MonkeyPatch) -> None:
    subtask, _ = examined()
    objects = {o.id: o for o in (BLOCK, HAMMER)}
    world = world_of([BLOCK, HAMMER])
    world.settle()
    task, watch = Task(world, objects, {}), Watch(world, objects, [GOAL])
    taken = Task._lift

    def lifted_and_gone(self: Task, grip) -> None:
        taken(self, grip)
        world.set_object_pose(BLOCK.id, Pose([0.4, 0.3, BLOCK.pose.p[2]]))

    monkeypatch.setattr(Task, "_lift", lifted_and_gone)
    with pytest.raises(TaskFailed, match="the red hammer touches nothing where the red block should be"):
        task.hit(HAMMER.id, BLOCK.id, grasps(subtask))
    assert not goals_hold([GOAL], watch).success
