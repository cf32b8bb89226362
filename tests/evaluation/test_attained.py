"""Progress of an episode: goals by the simulator's state, touches, lifts and collisions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from tests.example_scenes import block_and_plate, subtask, thing, world_of
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
    assert not found.touched and not found.lifted and not found.collisions


def test_what_lies_where_it_should_is_done_when_no_hand_touches_it() -> None:
    block, plate = block_and_plate()
    found = attained([block.moved(Pose(plate.pose.p + np.array([0, 0, 0.03]))), plate])
    assert found.success and found.goals == {"block on plate": True}


@pytest.mark.parametrize(("name", "touched", "hit"), [("block", {"block"}, set()), ("mug", set(), {"mug"})])
def test_a_hand_touches_the_object_of_the_task_and_collides_with_others(
    name: str, touched: set[str], hit: set[str]
) -> None:
    found = attained([*block_and_plate(), thing("mug", (-0.4, 0.2))])
    finger = found.world.arms["left"].fingers[0].pose.p
    put(found, name, Pose(np.array(finger) - [0, 0, 0.01]), steps=3)
    assert (found.touched, found.collisions) == (touched, hit)
