"""The robot aloha_agilex: its published numbers, its reach, the view of its cameras, and its 14 numbers of state."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from vcage.base.geometry import Pose
from vcage.schema.robot import Robot
from vcage.sim import collision
from vcage.sim.cameras import robot_cameras
from vcage.sim.collision import CollisionScene, CollisionSettings
from vcage.sim.kinematics import ArmKinematics, kinematics_of
from vcage.sim.motion import MotionPlanner
from vcage.sim.paths import OPEN_HAND
from vcage.sim.robots import load_robot, load_template
from vcage.sim.world import World

JOINTS = (
    ((0, 0, 0.0603), 0, "z", (-2.87, 3.14)),
    ((0.02, 0, 0.0402), 0, "y", (0, 3.66)),
    ((-0.264, 0, 0), np.pi, "y", (0, 3.14)),
    ((0.245, 0, -0.056), 0, "y", (-1.57, 1.57)),
    ((0.06575, -0.001, -0.0825), 0, "z", (-1.57, 1.57)),
    ((0.02845, 0, 0.0825), np.pi, "x", (-1.57, 1.57)),
)
"""Of the public description: origin in the parent (metres), roll (radians), axis, limits (radians)."""

GRIPPER_AHEAD = 0.145
"""From link 6 to the middle between the finger tips, along its x, metres."""

FASTEST = 5.0
"""Limit of each joint, rad/s."""

TABLE_TOP = 0.74
BASES = {"left": (-0.3, -0.417, 0.7775), "right": (0.307, -0.417, 0.7775)}

REACHED = [
    # height above the table (m), tilt (degrees), headings of four at .2, .3, .4, .5 and .6 m from the base
    (0.02, 0, (4, 4, 4, 4, 0)),
    (0.02, 30, (4, 4, 4, 4, 4)),
    (0.02, 60, (0, 4, 4, 4, 4)),
    (0.15, 0, (4, 4, 4, 0, 0)),
    (0.15, 30, (4, 4, 4, 4, 4)),
    (0.15, 60, (4, 4, 4, 4, 4)),
]


@pytest.fixture(scope="module")
def aloha() -> Robot:
    return load_robot("aloha_agilex")


@pytest.fixture(scope="module")
def left(aloha) -> ArmKinematics:
    return kinematics_of(aloha.arms["left"])


@pytest.fixture(scope="module")
def world(aloha) -> World:
    return World(load_template("table").table, {}, aloha)


def published_tip(q: np.ndarray) -> np.ndarray:
    """(3,) the middle between the finger tips in the frame of the base, by the published numbers."""
    turn, at = Rotation.identity(), np.zeros(3)
    for angle, (origin, roll, axis, _) in zip(q, JOINTS, strict=True):
        at = at + turn.apply(origin)
        turn = turn * Rotation.from_euler("x", roll) * Rotation.from_euler(axis, angle)
    return at + turn.apply([GRIPPER_AHEAD, 0, 0])


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(0, 1), min_size=6, max_size=6))
def test_the_gripper_is_where_the_published_numbers_say(share):
    arm = kinematics_of(load_robot("aloha_agilex").arms["left"])
    q = arm.lower + np.array(share) * (arm.upper - arm.lower)
    np.testing.assert_allclose(arm.arm.base.pose().inverse().apply(arm.fk(q).p), published_tip(q), atol=1e-4)


def test_the_joints_go_as_far_and_no_faster_than_published(aloha):
    for arm in aloha.arms.values():
        kinematics = kinematics_of(arm)
        np.testing.assert_allclose(kinematics.lower, [limits[0] for *_, limits in JOINTS], atol=0.0109)
        np.testing.assert_allclose(kinematics.upper, [limits[1] for *_, limits in JOINTS], atol=0.0109)
        assert max(arm.speeds) <= FASTEST


def test_inverse_kinematics_keeps_the_published_limits(left):
    """The quarter turns of joints 4 to 6 are widened in the file by the margin that inverse kinematics keeps."""
    lower, upper = np.array([limits for *_, limits in JOINTS]).T
    for q in (lower, upper):
        assert not left.within_limits(q + np.sign(q - (lower + upper) / 2) * 0.002)


def test_both_arms_stand_behind_the_table_and_look_at_it(aloha):
    for side, place in BASES.items():
        base = aloha.arms[side].base.pose()
        np.testing.assert_allclose(base.p, place)
        np.testing.assert_allclose(base.rotation()[:, 0], [0, 1, 0], atol=1e-6)


@pytest.mark.parametrize(("height", "tilt", "counts"), REACHED)
def test_the_reach_is_that_of_the_published_kinematics(left, height, tilt, counts):
    base = left.arm.base.pose()
    for ahead, count in zip((0.2, 0.3, 0.4, 0.5, 0.6), counts, strict=True):
        at = [base.p[0], base.p[1] + ahead, TABLE_TOP + height]
        # Straight down, tilted away from the base, then turned about its own approach.
        tilted = Pose(at) * Pose(q=[np.cos(np.radians(tilt) / 2), np.sin(np.radians(tilt) / 2), 0, 0])
        hands = [tilted * Pose(q=[0, 1, 0, 0]) * Pose.from_yaw([0, 0, 0], np.radians(h)) for h in (0, 45, 90, 135)]
        flipped = Pose.from_yaw([0, 0, 0], np.pi)
        assert sum(left.reachable(hand) or left.reachable(hand * flipped) for hand in hands) == count, ahead


def test_the_state_has_seven_numbers_for_each_arm_and_the_gripper_opens_from_0_to_1(world):
    state = np.concatenate([arm.qpos for arm in world.arms.values()])
    assert state.shape == (14,)
    assert list(world.arms) == ["left", "right"]
    for arm in world.arms.values():
        assert arm.qpos[-1] == pytest.approx(1.0, abs=0.01)
        arm.grip(0.0)
        assert arm.qpos[-1] == pytest.approx(0.0, abs=0.01)
        assert arm.command.shape == (7,)
        assert arm.command[-1] == 0.0


def test_the_arms_at_home_touch_nothing(world):
    for arm in world.arms.values():
        planner = MotionPlanner(CollisionScene.of_world(world, arm.name))
        planner.check(planner.kinematics.home, OPEN_HAND)


def test_there_are_the_cameras_of_aloha_and_one_in_front(aloha):
    assert set(aloha.cameras) == {"cam_high", "cam_left_wrist", "cam_right_wrist", "front"}
    assert {(c.width, c.height) for c in aloha.cameras.values()} == {(320, 240)}


def test_every_camera_looks_at_the_table_when_the_arms_are_at_home(aloha):
    table = load_template("table").table
    world = World(table, {}, aloha)
    (x0, y0), (x1, y1) = np.array(table.rectangle)
    for name, camera in robot_cameras(world).items():
        eye, forward = camera.pose.p, camera.pose.rotation()[:, 0]
        assert forward[2] < 0, name
        met = eye + forward * (table.height - eye[2]) / forward[2]
        assert x0 < met[0] < x1 and y0 < met[1] < y1, name


def test_the_front_camera_sees_the_whole_table_and_both_hands(world):
    camera = robot_cameras(world)["front"]
    (x0, y0), (x1, y1) = world.table.rectangle
    corners = [[x, y, world.table.height] for x in (x0, x1) for y in (y0, y1)]
    assert camera.sees(np.array([*corners, *(arm.tool_pose.p for arm in world.arms.values())])).all()


def test_an_arm_keeps_its_distance_from_the_other(world, monkeypatch):
    home = np.array(world.arms["left"].arm.home)
    assert CollisionScene.of_world(world, "left").first_contact(home) is None
    monkeypatch.setattr(collision, "SETTINGS", CollisionSettings(clearance_m=0.5))  # the hands at home are 0.44 m apart
    contact = CollisionScene.of_world(world, "left").first_contact(home)
    assert contact is not None and contact.other.startswith("right/")


def test_a_hand_keeps_its_distance_from_what_its_fingers_may_not_touch(world, monkeypatch):
    home = np.array(world.arms["left"].arm.home)
    monkeypatch.setattr(collision, "SETTINGS", CollisionSettings(hand_clearance_m=0.5))  # the table is nearer
    scene = CollisionScene.of_world(world, "left")
    contact = scene.first_contact(home)
    assert contact is not None and contact.moving not in scene.kinematics.finger_links
    assert scene.first_contact(home, fingers_may_touch=["table", *world.object_ids]) is None


def test_arms_that_are_apart_do_not_press_on_each_other():
    robot, table, rng = load_robot("aloha_agilex"), load_template("office_desk").table, np.random.default_rng(0)
    near = {"left": [0.001, 0.299, 0.798, -1.103, -0.004, 0.001], "right": [1.276, 2.151, 1.413, 0.456, 0.784, 0.186]}
    world, apart = World(table, {}, robot), 0
    for _ in range(40):  # a hand of one beside a finger of the other
        joints = {arm: np.array(values) + rng.normal(0.0, 0.003, 6) for arm, values in near.items()}
        if CollisionScene(robot, "right", table, {}, joints).first_contact(joints["right"]) is None:
            apart += 1
            for arm, control in world.arms.items():
                control.reset(joints[arm] - control.arm.home)
            world.step()
            assert not list(world.presses(near))
    assert apart > 30
