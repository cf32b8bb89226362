"""Contacts of an arm and its load on their way."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import TABLE_TOP, block_and_plate, thing, world_of
from vcage.base.geometry import Pose
from vcage.sim.collision import Held
from vcage.sim.motion import MotionPlanner
from vcage.sim.paths import JointPath, Leg, Load
from vcage.tasks.slots import Slot
from vcage.tasks.task import Task
from vcage.tasks.touching import SETTINGS, Allowance, at_rest
from vcage.tasks.workcell import TaskFailed, Workcell

HERE = Pose([0.1, 0.2, 1.0])


def beside(metres: float) -> Pose:
    return Pose(HERE.p + [metres, 0.0, 0.3], HERE.q)


@pytest.mark.parametrize(
    ("by", "may", "allowed"),
    [
        ("hand", "hand", True),
        ("hand", "fingers", True),
        ("fingers", "fingers", True),
        ("fingers", "hand", False),
        ("load", "load", True),
        ("load", "fingers", False),
        ("hand", "load", False),
    ],
)
def test_the_fingers_may_touch_everything_the_hand_may_touch_and_not_vice_versa(by, may, allowed):
    assert Allowance(by, frozenset(["box"])).allows(may, "box", HERE) is allowed


def test_unnamed_objects_may_not_be_touched():
    assert not Allowance("load", frozenset(["box"])).allows("load", "bottle", HERE)


def test_an_allowance_around_a_point_holds_above_it_and_nowhere_else():
    allowance = Allowance("load", frozenset(["box"]), HERE)
    assert allowance.allows("load", "box", beside(0.9 * SETTINGS.near_m))
    assert not allowance.allows("load", "box", beside(1.1 * SETTINGS.near_m))


def test_the_fingers_may_touch_the_support_of_a_picked_object_and_the_palm_may_not():
    allowed = at_rest(HERE, "block", {"table"})
    assert any(one.allows("fingers", "table", HERE) for one in allowed)
    assert not any(one.allows("hand", "table", HERE) for one in allowed)


@pytest.mark.slow
def test_an_arm_that_presses_on_a_bystander_ends_the_attempt_and_names_it():
    objects = [*block_and_plate(), thing("thermos", (0.0, 0.0))]
    cell = Workcell(world_of(objects), {o.id: o for o in objects})
    cell.world.settle()
    start = cell.begun("left").end
    kinematics = cell.planner("left").kinematics
    there = kinematics.ik(Pose([0.0, 0.0, TABLE_TOP + 0.08], kinematics.fk(start).q), start)
    blind = JointPath((Leg(start + np.linspace(0, 1, 40)[:, None] * (there - start), Load()),))
    with pytest.raises(TaskFailed, match=r"the left arm touches the silver thermos flask on its way") as failed:
        cell.carry_out("left", blind)
    assert failed.value.stage == "grasp"


def test_a_carried_objects_overhang_pressing_on_a_bystander_ends_the_attempt_and_names_it():
    cup, lipstick = thing("pencil_cup", (0.0, 0.0)), thing("lipstick", (0.0, 0.0), height=TABLE_TOP + 0.01)
    objects = {o.id: o for o in (cup, lipstick, thing("thermos", (0.2, 0.0)))}
    cell = Workcell(world_of(list(objects.values())), objects)
    cell.world.settle()
    cell.take("pencil_cup")
    held = cell.held("pencil_cup", cell.world.arms["left"].tool_pose)
    turn = np.linspace(0, 0.1, 10)[:, None] * np.eye(len(cell.begun("left").end))[-1]
    elsewhere = JointPath((Leg(cell.begun("left").end + turn, Load(held=held)),))
    standing = [Allowance("load", frozenset(["table"]))]
    cell.carry_out("left", elsewhere, standing)
    top = cell.object("lipstick").around_boxes[1, 2]
    cell.world.set_object_pose("thermos", Pose([0.0, 0.0, top + 0.001]))  # it falls on what sticks out
    with pytest.raises(TaskFailed, match="the red lipstick touches the silver thermos flask on its way") as failed:
        cell.carry_out("left", JointPath((Leg(elsewhere.end - turn, Load(held=held)),)), standing)
    assert failed.value.stage == "place"


@pytest.mark.slow
def test_a_bowl_held_by_its_rim_is_put_on_a_tall_cabinet_without_moving_it():
    bowl, cabinet = thing("bowl", (-0.3, 0.1)), thing("hinged_cabinet", (0.05, 0.1))
    world = world_of([bowl, cabinet])
    world.settle()
    floor = cabinet.asset.opening(cabinet.asset.annotation.functional_point(0)).floor
    task = Task(
        world, {"bowl": bowl, "hinged_cabinet": cabinet}, {"bowl": Slot("hinged_cabinet", 0, Pose([0, 0.02, floor]))}
    )
    task.pick("bowl", [(point.id, "left") for point in bowl.asset.annotation.carrying_points])
    task.place("hinged_cabinet")
    task.home()
    assert np.linalg.norm(world.object_pose("hinged_cabinet").p - cabinet.pose.p) < 0.01
    assert world.object_pose("bowl").p[2] == pytest.approx(TABLE_TOP + floor, abs=0.01)


def test_objects_to_keep_clear_below_a_carried_object_are_checked():
    block, plate = block_and_plate()
    world = world_of([block, plate])
    planner = MotionPlanner(Workcell(world, {"block": block, "plate": plate}).planner("left").scene)
    home = planner.kinematics.home
    low = planner.kinematics.ik(Pose([*plate.pose.p[:2], TABLE_TOP + 0.09], planner.kinematics.fk(home).q), home)
    held = Held("block", block.asset.model, Pose([0.0, 0.0, 0.02]))
    assert planner.scene.first_contact(low, 0.5, held) is None
    contact = planner.scene.first_contact(low, 0.5, Load(0.5, held).above(0.06).held)
    assert contact is not None
    assert contact.moving == "block"
