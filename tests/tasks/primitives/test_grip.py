"""Fingers hold things level or let them hang, with what lies in them."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import TABLE_TOP, thing, with_fingers, world_of
from vcage.base.geometry import Pose
from vcage.schema.robot import Robot
from vcage.sim.robots import load_robot
from vcage.tasks.primitives.grip import SETTINGS, sag, stays_level, turning_command
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import Slot
from vcage.tasks.state import resting_point
from vcage.tasks.task import Task
from vcage.tasks.workcell import TaskFailed, Workcell


def filled(content: str, holder: SceneObject) -> list[SceneObject]:
    """A thing, and another that lies in it."""
    floor = holder.asset.opening(holder.asset.annotation.functional_points[0]).floor
    xy = (float(holder.pose.p[0]), float(holder.pose.p[1]))
    return [holder, thing(content, xy, height=TABLE_TOP + floor + 0.002, container=holder.id)]


def task_with(objects: list[SceneObject], moved: str, to: SceneObject, who: Robot | None = None) -> Task:
    """A task in a settled world that brings an object to the middle of another."""
    world = world_of([*objects, to], who)
    world.settle()
    opening = to.asset.opening(to.asset.annotation.functional_points[0])
    slot = Slot(to.id, to.asset.annotation.functional_points[0].id, Pose([*opening.centre, opening.floor]))
    return Task(world, {o.id: o for o in [*objects, to]}, {moved: slot})


@pytest.mark.slow
def test_a_mug_is_carried_with_its_contents():
    objects, plate = filled("block", thing("mug", (-0.2, 0.0))), thing("plate", (0.05, 0.05))
    task = task_with(objects, "mug", plate)
    task.pick("mug", [(point.id, "left") for point in objects[0].asset.annotation.carrying_points])
    task.place("plate")
    task.home()
    cell = Workcell(task.world, {o.id: o for o in [*objects, plate]})
    assert resting_point(cell.object("mug"), cell.object("plate")) is not None
    assert cell.contents("mug") == {"block"}


def test_soft_fingers_do_not_take_a_bowl_with_something_in_it_by_its_rim():
    bowl, hands = thing("bowl", (-0.2, 0.0)), with_fingers(None)
    assert not stays_level(bowl, hands.arms.values())
    task = task_with(filled("apple", bowl), "bowl", thing("tray", (0.2, 0.05)), hands)
    with pytest.raises(TaskFailed, match="held at 'front rim', white bowl tips with what lies in it"):
        task.pick("bowl", [(0, "left")])


@pytest.mark.parametrize("hands", [with_fingers(10_000.0), load_robot("aloha_agilex")], ids=["firm", "aloha_agilex"])
def test_firm_fingers_hold_a_laden_basket_level_by_its_wall(hands: Robot):
    objects = filled("toy_car", thing("basket", (-0.15, -0.05), 0.0))
    assert stays_level(objects[0], hands.arms.values())
    world = world_of(objects, hands)
    world.settle()
    task = Task(world, {o.id: o for o in objects}, {})
    task.pick("basket", [(0, "left"), (1, "left")])
    task.hold()
    stands = world.object_pose("basket").rotation()[2, 2]
    assert np.degrees(np.arccos(stands)) < 3
    assert task.moment is not None and "toy_car" in Workcell(world, {o.id: o for o in objects}).contents("basket")


@pytest.mark.parametrize(("width", "tips"), [(0.004, True), (0.008, False)])
def test_a_box_counts_as_tipping_where_firm_fingers_press_too_little_on_its_thin_wall(width: float, tips: bool):
    box, gripper = thing("packaging_box", (-0.2, 0.0)), with_fingers(10_000.0).arms["left"].gripper
    walls = [c for c in box.asset.annotation.carrying_points if abs(box.asset.grasp_width(c) - width) < 1e-6]
    assert walls and all((sag(box, wall, gripper) > 0) is tips for wall in walls)


def test_contents_are_planned_with_their_container():
    objects, tray = filled("block", thing("mug", (-0.2, 0.0))), thing("tray", (0.2, 0.05))
    cell = Workcell(world_of([*objects, tray]), {o.id: o for o in [*objects, tray]})
    cell.world.settle()
    held = cell.held("mug", cell.object("mug").pose)
    assert [name for name, _ in held.contents] == ["block"]
    assert set(held.parts) == {"mug", "block"}


def test_the_support_of_a_flat_object_is_not_its_contents():
    tray = thing("tray")
    floor = tray.asset.opening(tray.asset.annotation.functional_points[0]).floor
    objects = [tray, thing("plate", height=TABLE_TOP + floor)]
    cell = Workcell(world_of(objects), {o.id: o for o in objects})
    assert cell.contents("tray") == {"plate"}
    assert cell.contents("plate") == frozenset()


def test_a_bar_stays_in_the_middle_between_the_fingers_of_aloha_agilex():
    bar = thing("chocolate_bar", (-0.2, -0.02), 0.3)
    world = world_of([bar], load_robot("aloha_agilex"))
    world.settle()
    task = Task(world, {bar.id: bar}, {})
    task.pick(bar.id, [(bar.asset.annotation.carrying_points[0].id, "left")])
    task.hold()
    at = world.arms["left"].tool_pose.inverse() * world.object_pose(bar.id)
    assert abs(at.p[1]) < 0.004
    world.step(500)
    assert np.allclose((world.arms["left"].tool_pose.inverse() * world.object_pose(bar.id)).p, at.p, atol=3e-4)


def test_firm_fingers_between_which_something_turns_press_with_little_force():
    gripper = with_fingers(10_000.0).arms["left"].gripper
    pressed = 0.014 - turning_command(gripper, 0.014) * gripper.max_width
    assert pressed / 2 * 10_000.0 == pytest.approx(SETTINGS.loose_n)
    assert turning_command(gripper, 0.0001) == 0.0


def test_soft_fingers_between_which_something_turns_are_closed():
    assert turning_command(with_fingers(None).arms["left"].gripper, 0.014) == 0.0
