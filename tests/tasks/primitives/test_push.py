"""What no hand can hold is pushed along the table by two finger tips."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import robot, thing, world_of
from vcage.base.errors import UnknownName
from vcage.base.geometry import Pose
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.tasks.grasps import hand_boxes
from vcage.tasks.primitives.push import push_ways
from vcage.tasks.scene_objects import SceneObject, SolidBox
from vcage.tasks.slots import Slot
from vcage.tasks.task import Task, TaskFailed

GRIPPER = robot().arms["left"].gripper


def moved(of: SceneObject, x: float, y: float) -> Pose:
    return Pose(of.pose.p + [x, y, 0.0], of.pose.q)


def task_with(goal: Pose, *objects: SceneObject) -> Task:
    """In a settled world, the first object having its slot at ``goal``."""
    world = world_of(objects)
    world.settle()
    return Task(world, {o.id: o for o in objects}, {objects[0].id: Slot("table", None, goal, turns=(0.0,))})


@pytest.mark.parametrize(("asset", "way"), [("plate", (0.12, 0.0)), ("book", (0.0, 0.08))])
def test_it_is_pushed_to_its_target_without_turning(asset: str, way: tuple[float, float]):
    pushed = thing(asset, (-0.12, 0.0))
    goal = moved(pushed, *way)
    task = task_with(goal, pushed)
    task.push(asset)
    task.home()
    now = task.world.object_pose(asset)
    np.testing.assert_allclose(now.p, goal.p, atol=0.006)
    assert now.yaw == pytest.approx(goal.yaw, abs=0.02)
    assert (task.arm, task.contact) == ("left", None)
    for control in task.world.arms.values():
        np.testing.assert_allclose(control.joints, control.arm.home, atol=0.01)


def test_a_blocking_object_is_an_obstacle_and_nothing_moves():
    pushed = thing("plate", (-0.15, 0.0))
    task = task_with(moved(pushed, 0.2, 0.0), pushed, thing("mug", (0.05, 0.0)))
    before = task.world.steps
    with pytest.raises(TaskFailed, match=r"no way to push .* can be planned: .*would touch mug") as caught:
        task.push("plate", arms=["left"])
    assert caught.value.stage == "plan"
    assert task.world.steps == before


def test_a_lost_object_is_reported_with_its_distance():
    pushed = thing("plate", (-0.12, 0.0))
    task = task_with(moved(pushed, 0.12, 0.0), pushed)
    task.world.before_step.append(lambda world: world.set_object_pose("plate", pushed.pose))
    with pytest.raises(TaskFailed, match=r"is 1\d\.\d cm from where it was pushed to") as caught:
        task.push("plate")
    assert caught.value.stage == "place"


def test_an_obstacle_that_stopped_the_hand_is_reported(monkeypatch):
    pushed = thing("plate", (-0.12, 0.0))
    task = task_with(moved(pushed, 0.12, 0.0), pushed)
    task.world.before_step.append(lambda world: world.set_object_pose("plate", pushed.pose))
    begun, line, stops = task.world.steps, MotionPlanner.line, ["left/hand would touch table"]

    def only_as_planned(*args, **options):
        if task.world.steps > begun and stops:
            raise MotionFailed(stops.pop())
        return line(*args, **options)

    monkeypatch.setattr(MotionPlanner, "line", only_as_planned)
    with pytest.raises(TaskFailed, match="pushed to, and the hand could not go on: left/hand would touch table"):
        task.push("plate")


def test_it_needs_an_existing_slot_and_arm():
    pushed = thing("plate")
    task = task_with(moved(pushed, 0.1, 0.0), pushed, thing("mug", (0.3, 0.0)))
    with pytest.raises(UnknownName, match="slot"):
        task.push("mug")
    with pytest.raises(UnknownName, match="arm"):
        task.push("plate", arms=["third"])


@pytest.mark.parametrize("asset", ["plate", "vase"])
def test_the_fingers_come_behind_the_face_and_the_palm_stays_outside_tall_objects(asset: str):
    pushed = thing(asset)
    ways = list(push_ways(pushed, moved(pushed, 0.1, 0.0), GRIPPER))
    assert ways
    upright = [way.touch.rotation()[2, 2] < -0.99 for way in ways]
    assert upright[0] == (asset == "plate")
    for way in ways:
        np.testing.assert_allclose(way.pushed.p - way.touch.p, [0.1, 0.0, 0.0], atol=1e-9)
        assert abs(way.touch.rotation()[:, 1] @ [0.0, 1.0, 0.0]) == pytest.approx(1.0)
        *_, palm = hand_boxes(GRIPPER, way.opening)
        assert not SolidBox(palm, way.touch).overlaps(pushed.box)
        assert way.before.p[0] < way.touch.p[0] < pushed.outline[:, 0].min()
