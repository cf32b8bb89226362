from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from vcage.sim.robots import load_robot
from vcage.sim.speed_profile import time_optimal

HZ = 250
ARM = load_robot("dual_panda").arms["left"]
PATHS = arrays.arrays(np.float64, st.tuples(st.integers(2, 6), st.just(7)), elements=st.floats(-2, 2, width=16))
ONE = np.eye(7)[0]
"""A turn of the first joint alone."""


def assert_limits_hold(path, speed):
    trajectory = time_optimal(path, HZ, ARM, speed)
    q = np.concatenate([path[:1], path[:1], trajectory.q, trajectory.q[-1:], trajectory.q[-1:]])
    velocity, acceleration, jerk = (np.diff(q, n, axis=0) * HZ**n for n in (1, 2, 3))
    assert np.all(np.abs(velocity) <= 1.01 * speed * np.array(ARM.speeds))
    assert np.all(np.abs(acceleration) <= 1.05 * speed**2 * np.array(ARM.accelerations))
    assert np.all(np.abs(jerk) <= 1.05 * speed**3 * np.array(ARM.jerks))


@settings(max_examples=30, deadline=None)
@given(path=PATHS, speed=st.sampled_from([0.4, 0.85, 1.0]))
def test_every_joint_keeps_its_own_limits_of_speed_acceleration_and_jerk(path, speed):
    assert_limits_hold(path, speed)


@settings(max_examples=30, deadline=None)
@given(path=PATHS, apart=st.sampled_from([1e-5, 1e-3, 5e-3]), speed=st.sampled_from([0.4, 1.0]))
def test_points_that_are_hardly_apart_break_no_limit(path, apart, speed):
    near = path + apart * np.random.default_rng(len(path)).uniform(-1, 1, path.shape)
    assert_limits_hold(np.stack([path, near], axis=1).reshape(-1, path.shape[1]), speed)


@pytest.mark.parametrize("points", [31, 61, 101])
def test_evenly_spaced_points_cost_no_time(points):
    """They fall together with points of the grid, but for rounding."""
    path = np.outer(np.linspace(0.0, 0.05, points), ONE)
    assert len(time_optimal(path, HZ, ARM)) == pytest.approx(len(time_optimal(path[[0, -1]], HZ, ARM)), abs=1)
    assert_limits_hold(path, 1.0)


@settings(max_examples=30, deadline=None)
@given(path=PATHS)
def test_velocity_and_acceleration_match_the_positions(path):
    trajectory = time_optimal(path, HZ, ARM)
    assert np.allclose(path[0] + trajectory.velocity.cumsum(axis=0) / HZ, trajectory.q, atol=0.03)
    assert np.allclose(trajectory.acceleration.cumsum(axis=0) / HZ, trajectory.velocity, atol=0.3)


@settings(max_examples=30, deadline=None)
@given(path=PATHS)
def test_it_ends_at_the_last_point_at_rest(path):
    trajectory = time_optimal(path, HZ, ARM)
    assert np.allclose(trajectory.end, path[-1], atol=1e-5)
    assert not trajectory.velocity[-1].any() and not trajectory.acceleration[-1].any()


def test_it_passes_through_every_point():
    path = np.outer([0.0, 0.5, 0.6], ONE) + np.outer([0.0, 0.1, 0.8], np.eye(7)[1])
    trajectory = time_optimal(path, HZ, ARM)
    for point in path:
        assert np.linalg.norm(trajectory.q - point, axis=1).min() < 0.01


def test_a_path_that_goes_nowhere_is_one_sample_at_rest():
    trajectory = time_optimal(np.zeros((3, 7)), HZ, ARM)
    assert len(trajectory) == 1 and not trajectory.velocity.any()


def test_a_short_turn_is_as_fast_as_its_acceleration_allows():
    """Half of the way speeding up, half slowing down: 2 √(d / a)."""
    shortest = 2 * np.sqrt(0.2 / ARM.accelerations[0])
    assert len(time_optimal(np.outer([0.0, 0.2], ONE), HZ, ARM)) / HZ == pytest.approx(shortest, abs=0.012)


def test_a_long_turn_is_as_fast_as_its_speed_allows():
    """d / v, and v / a for speeding up and slowing down."""
    shortest = 2.0 / ARM.speeds[0] + ARM.speeds[0] / ARM.accelerations[0]
    assert len(time_optimal(np.outer([0.0, 2.0], ONE), HZ, ARM)) / HZ == pytest.approx(shortest, abs=0.012)


def test_half_the_speed_takes_twice_as_long():
    path = np.outer([0.0, 1.0], ONE)
    assert len(time_optimal(path, HZ, ARM, speed=0.5)) == pytest.approx(2 * len(time_optimal(path, HZ, ARM)), abs=4)


def test_only_the_part_that_shall_be_slow_is_slow():
    path = np.outer(np.linspace(0.0, 2.0, 41), ONE)
    trajectory = time_optimal(path, HZ, ARM, np.where(path[:, 0] > 1.5, 0.3, 1.0))
    speeds = np.abs(trajectory.velocity[:, 0])
    assert speeds.max() > 0.95 * ARM.speeds[0]
    assert speeds[trajectory.q[:, 0] > 1.6].max() < 0.32 * ARM.speeds[0]


def test_a_gentler_jerk_takes_longer_and_keeps_to_it():
    gentle = ARM.model_copy(update={"max_jerk": 150.0})
    path = np.outer([0.0, 0.5], ONE)
    trajectory = time_optimal(path, HZ, gentle)
    assert len(trajectory) > len(time_optimal(path, HZ, ARM))
    assert np.abs(np.diff(trajectory.acceleration[:, 0]) * HZ).max() <= 155


def test_a_bend_slows_the_bend_alone():
    straight, bent = np.linspace(0.0, 3.0, 40), np.full(40, 3.0)
    path = np.zeros((79, 7))
    path[:, 0] = np.concatenate([straight, bent[1:]])
    path[:, 1] = np.concatenate([np.zeros(39), straight])
    speed = np.abs(time_optimal(path, HZ, ARM).velocity)
    assert speed[:, 0].max() > 0.97 * ARM.speeds[0]
    assert speed[:, 1].max() > 0.97 * ARM.speeds[1]
