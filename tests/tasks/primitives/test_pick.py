"""The gripper's way in a pick."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.example_scenes import TABLE_TOP, robot, thing, world_of
from vcage.base.geometry import Pose
from vcage.sim.kinematics import kinematics_of
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import JointPath, Load
from vcage.sim.robots import load_robot
from vcage.tasks.grasps import GraspPose, grasp_poses
from vcage.tasks.primitives.pick import (
    KnownPaths,
    carry_out_pick,
    lift_heights,
    pick_way,
    plan_pick,
    reached_lift,
    transfer_height,
    transfer_heights,
)
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.workcell import Workcell

GRIPPER = robot().arms["left"].gripper

CLEAR = 0.03


def grasps_of(target: SceneObject) -> list[GraspPose]:
    contact = target.asset.annotation.contact_point(0)
    return list(grasp_poses(target.pose, contact, GRIPPER, target.box.bottom))


def test_an_object_is_carried_over_the_highest_thing_on_the_table():
    bottle, block = thing("lotion_bottle", (0.2, 0.1)), thing("block")
    assert transfer_height([block, bottle], TABLE_TOP) == pytest.approx(bottle.box.top + CLEAR)


def test_an_empty_table_asks_for_the_clearance_alone():
    assert transfer_height([], TABLE_TOP) == TABLE_TOP + CLEAR


def test_a_short_arm_carries_an_object_lower_but_over_its_target():
    bottle, box = thing("lotion_bottle", (0.2, 0.1)), thing("packaging_box", (-0.2, 0.1))
    highest, middle, least = transfer_heights([bottle, box], TABLE_TOP, [box.rim(0)])
    rim = max(wall.top for wall in box.walls(0))
    assert (highest, least) == pytest.approx((bottle.box.top + CLEAR, rim + CLEAR))
    assert least < middle < highest


def test_an_object_is_carried_over_the_flat_top_it_is_put_on():
    cabinet = thing("hinged_cabinet")
    assert transfer_heights([cabinet], TABLE_TOP, [cabinet.rim(0)])[-1] >= cabinet.rim(0) + CLEAR


def test_an_object_is_lifted_out_of_its_container():
    box = thing("packaging_box")
    inside = thing("block", height=TABLE_TOP + box.asset.opening(box.asset.annotation.functional_points[0]).floor)
    rim = max(wall.top for wall in box.walls(0))
    assert lift_heights(inside, [box, thing("thermos", (0.3, 0.1))], TABLE_TOP)[-1] == pytest.approx(rim + CLEAR)
    assert lift_heights(thing("block", (0.3, 0.0)), [box], TABLE_TOP)[-1] == pytest.approx(TABLE_TOP + CLEAR)


def test_a_short_arm_lifts_as_high_as_it_reaches():
    arm = kinematics_of(load_robot("aloha_agilex").arms["left"])
    block = thing("block", (-0.3, -0.1))
    grasp = next(grasp_poses(block.pose, block.asset.annotation.contact_point(1), arm.arm.gripper, TABLE_TOP))
    heights = (TABLE_TOP + 0.4, TABLE_TOP + 0.08, TABLE_TOP + 0.05)
    height, path = reached_lift(arm, block, grasp, heights)
    assert height == heights[1]
    assert path is not None
    lifted = pick_way(block, grasp, arm.arm.gripper, height).lifted
    np.testing.assert_allclose(arm.fk(path[-1]).p, lifted.p, atol=1e-3)
    assert reached_lift(arm, block, grasp, heights[:1]) == (heights[0], None)


@given(st.integers(0, 9))
def test_a_pick_comes_along_the_approach_and_lifts_straight_up(number: int):
    block = thing("block", (0.3, 0.0))
    grasp = grasps_of(block)[number]
    way = pick_way(block, grasp, GRIPPER, TABLE_TOP + 0.2)
    approach = grasp.pose.rotation()[:, 2]
    np.testing.assert_allclose(way.grasp.p - way.before.p, GRIPPER.approach * approach, atol=1e-9)
    np.testing.assert_allclose(way.lifted.p - way.grasp.p, [0, 0, 0.2], atol=1e-9)


def test_a_lift_is_never_shorter_than_the_approach():
    block = thing("block", (0.3, 0.0))
    grasp = grasps_of(block)[0]
    assert pick_way(block, grasp, GRIPPER, TABLE_TOP).lifted.p[2] - grasp.pose.p[2] == pytest.approx(GRIPPER.approach)


def test_a_grasp_that_cannot_lift_the_object_is_not_planned(monkeypatch: pytest.MonkeyPatch):
    block = thing("block", (0.0, -0.1))
    cell, line = Workcell(world_of([block]), {"block": block}), MotionPlanner.line

    def blocked(planner: MotionPlanner, q: np.ndarray, pose: Pose, load: Load) -> JointPath:
        if planner.kinematics.arm == robot().arms["left"] and "table" in load.ignore:
            raise MotionFailed("something is above it")
        return line(planner, q, pose, load)

    grasps = [(0, "left"), (0, "right")]
    assert plan_pick(cell, block, grasps).arm == "left"
    monkeypatch.setattr(MotionPlanner, "line", blocked)
    assert plan_pick(cell, block, grasps).arm == "right"


def test_a_path_to_a_grasp_is_planned_once_whether_there_is_one_or_not(monkeypatch):
    block = thing("block", (0.0, -0.1))
    cell, known, grasps = Workcell(world_of([block]), {"block": block}), KnownPaths(), [(0, "left"), (0, "right")]
    move, planned = MotionPlanner.move, []

    def counted(planner: MotionPlanner, q: np.ndarray, goal: Pose, load: Load, then: list[Pose]) -> JointPath:
        planned.append(goal)
        if planner.kinematics.arm == robot().arms["left"]:
            raise MotionFailed("it is blocked")
        return move(planner, q, goal, load, then)

    monkeypatch.setattr(MotionPlanner, "move", counted)
    first = plan_pick(cell, block, grasps, known=known)
    count = len(planned)
    assert plan_pick(cell, block, grasps, known=known).way == first.way and first.arm == "right"
    assert len(planned) == count > 1


def test_what_is_held_far_from_its_middle_is_measured_when_it_is_lifted():
    scanner = thing("barcode_scanner", (-0.15, -0.1), 0.5)
    world = world_of([scanner], load_robot("aloha_agilex"))
    world.settle()
    cell = Workcell(world, {scanner.id: scanner})
    handle = scanner.asset.annotation.carrying_points[0].id
    grip = carry_out_pick(cell, plan_pick(cell, scanner, [(handle, "left")]))
    assert cell.object(scanner.id).lowest > TABLE_TOP + 0.05
    now = cell.held(scanner.id, world.arms["left"].tool_pose).in_gripper
    assert np.allclose(grip.load.held.in_gripper.p, now.p, atol=1e-4)
    assert grip.load.speed == 1.0 and grip.grasped is None
