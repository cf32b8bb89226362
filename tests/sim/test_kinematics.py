from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vcage.base.geometry import Pose, frame_from_axes
from vcage.sim.kinematics import ArmKinematics, kinematics_of
from vcage.sim.robots import load_robot

POSITION, TURN = 5e-4, 2e-3


@pytest.fixture(scope="module")
def right() -> ArmKinematics:
    return kinematics_of(load_robot("dual_panda").arms["right"])


def grasp_from_above(x: float, y: float, z: float, yaw: float) -> Pose:
    return frame_from_axes([x, y, z], [0, 0, -1], [np.cos(yaw), np.sin(yaw), 0])


@settings(max_examples=40, deadline=None)
@given(x=st.floats(0.0, 0.45), y=st.floats(-0.2, 0.1), z=st.floats(0.76, 0.9), yaw=st.floats(-1.5, 1.5))
def test_the_arm_is_where_inverse_kinematics_says(x, y, z, yaw):
    arm = kinematics_of(load_robot("dual_panda").arms["right"])
    pose = grasp_from_above(x, y, z, yaw)
    q = arm.ik(pose)
    if q is None:  # half a turn on, the same grasp is within the limits of the last joint
        pose = grasp_from_above(x, y, z, yaw + np.pi)
        q = arm.ik(pose)
    assert q is not None
    assert arm.within_limits(q)
    reached = arm.fk(q)
    assert np.linalg.norm(reached.p - pose.p) < POSITION
    assert 2 * np.arccos(min(1, abs(reached.q @ pose.q))) < TURN


def test_a_pose_out_of_reach_has_no_solution(right):
    assert right.ik(Pose([3, 3, 3])) is None
    assert not right.reachable(Pose([0.3, -0.5, 0.2]))


@settings(max_examples=40, deadline=None)
@given(st.lists(st.floats(0, 1), min_size=7, max_size=7))
def test_no_pose_that_the_arm_comes_to_is_too_far(share):
    arm = kinematics_of(load_robot("dual_panda").arms["right"])
    assert not arm.too_far(arm.fk(arm.lower + np.array(share) * (arm.upper - arm.lower)))


def test_a_pose_beyond_the_stretched_arm_is_too_far(right):
    stretched = right.fk(right.home * [1, 0, 1, 0, 1, 0, 1])  # straight up
    assert not right.too_far(stretched)
    assert right.too_far(Pose(stretched.p + [0, 0, 0.15], stretched.q))


def test_solutions_do_not_depend_on_earlier_requests(right):
    pose = grasp_from_above(0.2, 0.0, 0.8, 0.3)
    first = right.ik(pose)
    right.ik(grasp_from_above(0.4, -0.1, 0.8, 1.0))
    assert np.array_equal(first, right.ik(pose))
    assert np.array_equal(first, ArmKinematics(right.arm).ik(pose))


def test_the_solution_stays_near_the_seed(right):
    q = right.ik(grasp_from_above(0.2, 0.0, 0.8, 0.3))
    near = right.ik(grasp_from_above(0.2, 0.005, 0.8, 0.3), seed_q=q)
    assert np.abs(near - q).max() < 0.1


def test_all_solutions_reach_the_pose_and_differ(right):
    pose = grasp_from_above(0.2, 0.0, 0.8, 0.3)
    solutions = right.ik_all(pose)
    assert all(np.linalg.norm(right.fk(q).p - pose.p) < POSITION for q in solutions)
    for i, a in enumerate(solutions):
        assert all(np.abs(a - b).max() > 0.1 for b in solutions[:i])


def test_kinematics_agree_with_the_simulated_arm(world):
    arm = world.arms["right"]
    assert np.allclose(kinematics_of(arm.arm).fk(arm.joints).p, arm.tool_pose.p, atol=1e-5)


def test_both_arms_together_reach_the_whole_workspace(template, robot):
    arms = [kinematics_of(arm) for arm in robot.arms.values()]
    (x0, y0), (x1, y1) = template.workspace.lower, template.workspace.upper
    for x in np.linspace(x0, x1, 7):
        for y in np.linspace(y0, y1, 4):
            assert any(arm.reachable(grasp_from_above(x, y, 0.76, yaw)) for arm in arms for yaw in (0, np.pi)), (x, y)


def test_only_a_link_of_the_hand_has_a_pose_in_the_gripper_frame(right):
    palm = right.on_hand("panda_hand")
    assert palm is not None and 0.05 < -palm.p[2] < 0.15  # behind the tips
    assert right.on_hand("panda_link5") is None
