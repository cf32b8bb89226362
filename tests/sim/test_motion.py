from __future__ import annotations

import numpy as np
import pytest

from vcage.base.geometry import Pose, frame_from_axes
from vcage.sim.bodies import Body
from vcage.sim.collision import CollisionScene, Contact, Held
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import Load
from vcage.sim.world import World

UP = np.array([0.0, 0.0, 1.0])


def above(pose: Pose, height: float) -> Pose:
    return Pose(pose.p + height * UP, pose.q)


def grasp_of(world: World, object_id: str, height: float = 0.02) -> Pose:
    pose = world.object_pose(object_id)
    return frame_from_axes(pose.p + height * UP, [0, 0, -1], [np.cos(pose.yaw), np.sin(pose.yaw), 0])


def planner_of(world: World, arm: str = "right") -> MotionPlanner:
    return MotionPlanner(CollisionScene.of_world(world, arm))


def pick(world: World) -> Held:
    """The right arm holds the cube, lifted by 12 cm."""
    arm, grasp = world.arms["right"], grasp_of(world, "cube")
    planner = planner_of(world)
    reach = planner.move(arm.joints, above(grasp, 0.09), then=[grasp])
    arm.move(planner.fastest(reach.then(planner.line(reach.end, grasp, Load(ignore={"cube"})))))
    arm.grip(0.0)
    held = Held("cube", world.bodies["cube"].model, arm.tool_pose.inverse() * world.object_pose("cube"))
    arm.move(planner.fastest(planner.line(arm.joints, above(grasp, 0.12), Load(opening=arm.opening, held=held))))
    return held


def test_a_grasped_cube_is_lifted(world):
    before = world.object_pose("cube").p
    pick(world)
    assert world.holds("right", "cube")
    assert world.arms["right"].finger_width == pytest.approx(0.04, abs=0.002)
    assert np.allclose(world.object_pose("cube").p - before, [0, 0, 0.12], atol=0.01)


def test_a_carried_cube_is_set_down_where_it_was_planned(world):
    held = pick(world)
    arm, planner = world.arms["right"], planner_of(world)
    goal = Pose.from_yaw([0.03, 0.1, 0.748], 0.0) * held.in_gripper.inverse()
    load = Load(opening=arm.opening, held=held)
    carry = planner.move(arm.joints, above(goal, 0.12), load, then=[goal])
    arm.move(planner.fastest(carry.then(planner.line(carry.end, goal, load))))
    arm.grip(0.8)
    away = planner_of(world)
    arm.move(away.fastest(away.line(arm.joints, above(goal, 0.12), Load(opening=0.8, ignore={"cube"}))))
    assert world.settle().settled
    assert "tray" in world.touching("cube")
    assert np.allclose(world.object_pose("cube").p, [0.03, 0.1, 0.745], atol=0.005)


def test_the_same_pick_twice_gives_the_same_states_bit_for_bit(template, bodies, robot):
    snapshots = []
    for _ in range(2):
        world = World(template.table, bodies, robot)
        pick(world)
        snapshots.append(world.snapshot())
    assert snapshots[0] == snapshots[1]


def test_the_gripper_stays_on_a_straight_line(world):
    arm, planner = world.arms["right"], planner_of(world)
    start = grasp_of(world, "cube", 0.15)
    q = planner.move(arm.joints, start).end
    goal = Pose(start.p + np.array([0.1, 0.05, 0.05]), start.q)
    direction = (goal.p - start.p) / np.linalg.norm(goal.p - start.p)
    for point in planner.fastest(planner.line(q, goal)).q[::20]:
        offset = planner.kinematics.fk(point).p - start.p
        assert np.linalg.norm(offset - (offset @ direction) * direction) < 0.002


def test_a_line_into_the_table_names_the_table(world):
    arm, planner = world.arms["right"], planner_of(world)
    start = grasp_of(world, "cube", 0.15)
    q = planner.move(arm.joints, start).end
    with pytest.raises(MotionFailed, match=r"finger would touch (cube|table)"):
        planner.line(q, Pose(start.p - [0, 0, 0.25], start.q))


def test_a_pose_out_of_reach_is_refused_with_a_reason(world):
    with pytest.raises(MotionFailed, match=r"cannot move to .*joint"):
        planner_of(world).move(world.arms["right"].joints, grasp_of(world, "cube", 1.5))


def test_a_move_goes_around_a_wall(template, models, robot):
    """A stack of cubes between start and goal, higher than a straight way."""
    wall = {
        f"c{i}{j}": Body(models["cube"], Pose([0.2, -0.1 + 0.04 * i, 0.74 + 0.04 * j]))
        for i in range(6)
        for j in range(5)
    }
    world = World(template.table, wall, robot)
    planner = planner_of(world)
    down = ([0, 0, -1], [1, 0, 0])
    start, goal = frame_from_axes([0.04, 0, 0.8], *down), frame_from_axes([0.37, 0, 0.8], *down)
    q = planner.kinematics.ik(start)
    assert planner.scene.first_contact(q) is None
    with pytest.raises(MotionFailed):
        planner.line(q, goal)
    way = planner.move(q, goal)
    assert not any(wall.keys() & planner.scene.beside(x) for leg in way.legs for x in leg.points)
    path = planner.fastest(way)
    assert all(planner.scene.first_contact(x) is None for x in path.q[::10])
    assert np.allclose(planner.kinematics.fk(path.end).p, goal.p, atol=1e-3)
    assert np.array_equal(path.q, planner.fastest(planner_of(world).move(q, goal)).q)


def test_arms_at_home_touch_nothing(world):
    for name, arm in world.arms.items():
        assert CollisionScene.of_world(world, name).first_contact(arm.joints) is None


def test_a_held_object_counts_as_part_of_the_hand(world):
    planner = planner_of(world)
    q = planner.kinematics.ik(grasp_of(world, "tray", 0.16))
    long = Held("bar", world.bodies["bar"].model, Pose([0, 0, 0.1], [0.7071, 0, 0.7071, 0]))
    assert planner.scene.first_contact(q) is None
    assert planner.scene.first_contact(q, held=long) == Contact("bar", "tray")


def test_arms_do_not_pass_through_each_other(template, robot):
    left, right = robot.arms["left"], robot.arms["right"]
    scene = CollisionScene(robot, "right", template.table, {}, {"left": np.array(left.home)})
    down = ([0, 0, -1], [1, 0, 0])
    q = scene.kinematics.ik(frame_from_axes([0.0, 0.0, 0.9], *down))
    other = CollisionScene(robot, "left", template.table, {}).kinematics.ik(frame_from_axes([0.0, 0.0, 0.9], *down))
    assert scene.first_contact(q) is None
    crossed = CollisionScene(robot, "right", template.table, {}, {"left": other}).first_contact(q)
    assert crossed is not None and crossed.other.startswith("left/")
    assert right.home == left.home


def test_the_gripper_passes_through_all_poses_in_one_motion(world):
    arm, planner = world.arms["right"], planner_of(world)
    start = grasp_of(world, "cube", 0.15)
    q = planner.move(arm.joints, start).end
    turns = np.linspace(0, np.pi / 2, 13)[1:]
    arc = [Pose(start.p + 0.08 * np.array([np.sin(a), 0, 1 - np.cos(a)]), start.q) for a in turns]
    path = planner.fastest(planner.follow(q, arc))
    passed = np.array([planner.kinematics.fk(x).p for x in path.q])
    for pose in arc:
        assert np.linalg.norm(passed - pose.p, axis=1).min() < 0.004
    speeds = np.abs(path.velocity).max(axis=1)
    assert speeds[len(path) // 4 : 3 * len(path) // 4].min() > 0.2  # it does not stop in between
    assert speeds[-1] < 0.01


def test_following_a_path_into_the_table_names_the_pose(world):
    arm, planner = world.arms["right"], planner_of(world)
    start = grasp_of(world, "cube", 0.15)
    q = planner.move(arm.joints, start).end
    poses = [Pose(start.p + [0.1, 0, 0], start.q), Pose(start.p + [0.1, 0, -0.25], start.q)]
    with pytest.raises(MotionFailed, match=r"at pose 2 of 2: .* would touch table"):
        planner.follow(q, poses)


def test_an_arm_stays_on_its_targets_all_the_way(world):
    """The drives alone lag where the arm speeds up, and would have to be waited for."""
    arm, planner = world.arms["right"], planner_of(world)
    lag = []
    world.before_step.append(lambda _world: lag.append(np.abs(arm.joints - arm.command[:-1]).max()))
    trajectory = planner.fastest(planner.move(arm.joints, grasp_of(world, "cube", 0.15)))
    arm.move(trajectory)
    assert max(lag) < 0.02
    assert len(lag) == len(trajectory)  # it need not be waited for
