"""Progress of an episode: goals by the simulator's state, touches, lifts and collisions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from tests.example_scenes import TABLE_TOP, block_and_plate, kinematics, subtask, thing, world_of
from vcage.base.geometry import Pose
from vcage.evaluation.attained import Attained, Task
from vcage.tasks.scene_objects import SceneObject

ON = subtask()
TASK = Task.of([ON], ON.goals)


def attained(objects: Sequence[SceneObject]) -> Attained:
    world = world_of(objects)
    world.settle()
    return Attained(world, {o.id: o for o in objects}, TASK)


def put(found: Attained, name: str, place: Pose, steps: int = 100) -> None:
    """Move an object as no hand does, and let it come to rest."""
    state = found.world.state()
    found.world.set_state(replace(state, objects={**state.objects, name: place}))
    found.world.step(steps)
    found.look()
    found.judge()


def test_nothing_is_attained_at_the_start() -> None:
    found = attained(block_and_plate())
    assert (found.success, found.goals) == (False, {"block on plate": False})
    assert not found.touched and not found.lifted and not found.brushed and not found.collisions


def test_what_lies_where_it_should_is_done_when_no_hand_touches_it() -> None:
    block, plate = block_and_plate()
    found = attained([block.moved(Pose(plate.pose.p + np.array([0, 0, 0.03]))), plate])
    assert found.success and found.goals == {"block on plate": True}


@pytest.mark.parametrize(("name", "touched", "hit"), [("block", {"block"}, set()), ("mug", set(), {"mug"})])
def test_a_hand_touches_the_object_of_the_task_and_hits_others(name: str, touched: set[str], hit: set[str]) -> None:
    found = attained([*block_and_plate(), thing("mug", (-0.4, 0.2))])
    finger = found.world.arms["left"].fingers[0].pose.p
    put(found, name, Pose(np.array(finger) - [0, 0, 0.01]), steps=3)
    assert (found.touched, found.brushed | found.collisions) == (touched, hit)


def lowered(found: Attained, height: float, steps: int = 50) -> None:
    """Drive the hand of the left arm, which points down, to a height above the free table, and look."""
    arm = found.world.arms["left"]
    joints = kinematics()["left"].ik(Pose([-0.2, 0.0, height], [0, 0.5**0.5, 0.5**0.5, 0]), arm.joints)
    assert joints is not None
    arm.command_joints(joints)
    found.world.step(steps)
    found.look()


def test_fingers_that_brush_the_table_collide_only_when_they_are_pushed_onto_it() -> None:
    found = attained(block_and_plate())
    heights = iter(np.arange(TABLE_TOP + 0.05, TABLE_TOP - 0.05, -0.002))
    lowered(found, TABLE_TOP + 0.1, steps=500)
    while not found.brushed:
        lowered(found, next(heights))
        assert not found.collisions
    assert found.brushed == {"table"}
    for _ in range(15):
        lowered(found, next(heights))
    assert (found.brushed, found.collisions) == (set(), {"table"})
