"""A thing that goes from arm to arm in the air, physically."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.example_scenes import TABLE_TOP, thing, world_of
from vcage.base.errors import UnknownName
from vcage.base.geometry import Pose
from vcage.schema.goals import Goal
from vcage.sim.arms import ArmControl
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import Slot
from vcage.tasks.state import Watch
from vcage.tasks.task import Task, TaskFailed
from vcage.tasks.truth import goals_hold

SLOT = Slot("table", None, Pose([0.25, 0.0, TABLE_TOP]), turns=(0.0, np.pi))
HANDED = Goal(subject="hammer", relation="handed", reference="right")


def task_with(target: SceneObject) -> Task:
    world = world_of([target])
    world.settle()
    return Task(world, {target.id: target}, {target.id: SLOT})


def grasps(target: SceneObject) -> list[tuple[int, str]]:
    return [(contact.id, "left") for contact in target.asset.annotation.carrying_points]


@pytest.fixture(scope="module")
def done() -> tuple[Task, Watch, list[set[str]]]:
    """A hammer that was handed to the right arm and put down, and who held it when."""
    hammer = thing("hammer", (-0.2, 0.0), 0.4)
    task = task_with(hammer)
    watch, holders = Watch(task.world, {"hammer": hammer}, [HANDED], "hammer"), [set()]

    def note(world) -> None:
        now = {name.partition("/")[0] for name in world.touching("hammer")}
        if now != holders[-1]:
            holders.append(now)

    task.world.before_step.append(note)
    task.pick("hammer", grasps(hammer), hand_to="right")
    task.hand_over("right")
    holders.append({"taken"})
    task.place()
    task.home()
    return task, watch, holders


@pytest.mark.slow
def test_it_goes_from_hand_to_hand_with_nothing_else_beneath_it(done):
    _, _, holders = done
    until = holders[: holders.index({"taken"})]
    assert until[-3:] == [{"left"}, {"left", "right"}, {"right"}]


def test_it_ends_where_the_other_arm_puts_it(done):
    task, _, _ = done
    np.testing.assert_allclose(task.world.object_pose("hammer").p, SLOT.pose.p, atol=0.02)


def test_the_truth_is_that_it_was_handed(done):
    _, watch, _ = done
    told = goals_hold([HANDED], watch)
    assert told.success, told.reason


def test_the_watch_names_the_giving_and_the_taking_arm(done):
    _, watch, _ = done
    assert watch.hands == ["left", "right"]


def test_both_hands_hold_it_at_the_moment(done):
    task, _, _ = done
    task.world.set_state(task.moment)
    tips = [control.tool_pose.p for control in task.world.arms.values()]
    assert np.linalg.norm(tips[0] - tips[1]) < 0.2
    assert task.world.object_pose("hammer").p[2] > TABLE_TOP + 0.15


def test_a_thing_without_room_for_two_hands_is_refused_with_its_length():
    can = thing("can", (-0.2, 0.0))
    with pytest.raises(TaskFailed, match=r"no room side by side on red tin can: it is 9\.0 cm long") as caught:
        task_with(can).pick("can", grasps(can), hand_to="right")
    assert caught.value.stage == "plan"


def test_fingers_that_close_beside_it_fail_the_hand_over():
    hammer = thing("hammer", (-0.2, 0.0), 0.4)
    task = task_with(hammer)
    task.pick("hammer", grasps(hammer), hand_to="right")
    _before_grip(task.world.arms["right"], lambda: task.world.set_object_pose("hammer", Pose([-0.5, 0.2, TABLE_TOP])))
    with pytest.raises(TaskFailed, match="the right arm closed its fingers on nothing") as caught:
        task.hand_over("right")
    assert caught.value.stage == "grasp"


def _before_grip(control: ArmControl, happens: Callable[[], None]) -> None:
    closed = control.grip

    def grip(opening: float) -> None:
        happens()
        closed(opening)

    control.grip = grip


def test_an_object_not_held_is_not_handed_over():
    task = task_with(thing("hammer", (-0.2, 0.0)))
    with pytest.raises(TaskFailed, match="nothing was picked up before handing it over"):
        task.hand_over("right")


def test_a_missing_arm_takes_nothing():
    hammer = thing("hammer", (-0.2, 0.0))
    with pytest.raises(UnknownName, match="third"):
        task_with(hammer).pick("hammer", grasps(hammer), hand_to="third")
