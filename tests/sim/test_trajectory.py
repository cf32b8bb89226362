from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from vcage.sim.robots import load_robot
from vcage.sim.trajectory import minimum_jerk

HZ = 250
ARM = load_robot("dual_panda").arms["left"]
PATHS = arrays.arrays(np.float64, st.tuples(st.integers(2, 8), st.just(3)), elements=st.floats(-2, 2, width=32))


@settings(max_examples=60, deadline=None)
@given(path=PATHS)
def test_speed_and_acceleration_keep_their_limits(path):
    trajectory = minimum_jerk(path, HZ, ARM)
    steps = np.diff(np.concatenate([path[:1], trajectory.q]), axis=0) * HZ
    assert np.abs(steps).max() <= ARM.max_speed * 1.05
    assert np.abs(np.diff(trajectory.velocity, axis=0) * HZ).max(initial=0) <= ARM.max_acceleration * 1.1


@settings(max_examples=60, deadline=None)
@given(path=PATHS)
def test_it_ends_at_the_last_point_at_rest(path):
    trajectory = minimum_jerk(path, HZ, ARM)
    assert np.allclose(trajectory.end, path[-1], atol=1e-5)
    assert np.allclose(trajectory.velocity[-1], 0, atol=1e-9)


def test_it_passes_through_every_point():
    path = np.array([[0.0, 0.0], [0.5, 0.1], [0.6, 0.8]])
    trajectory = minimum_jerk(path, 5000, ARM)
    for point in path:
        assert np.linalg.norm(trajectory.q - point, axis=1).min() < 1e-3


def test_a_path_that_goes_nowhere_is_one_sample_at_rest():
    trajectory = minimum_jerk(np.zeros((3, 2)), HZ, ARM)
    assert len(trajectory) == 1 and not trajectory.velocity.any()


def test_half_the_speed_takes_twice_as_long():
    path = np.array([[0.0], [1.0]])
    assert abs(len(minimum_jerk(path, HZ, ARM, speed=0.5)) - 2 * len(minimum_jerk(path, HZ, ARM))) <= 2


def test_an_arm_that_may_go_twice_as_fast_takes_half_as_long():
    path = np.array([[0.0], [1.0]])
    steady = ARM.model_copy(update={"max_acceleration": 1e6})
    faster = steady.model_copy(update={"max_speed": 2 * ARM.max_speed})
    assert abs(len(minimum_jerk(path, HZ, steady)) - 2 * len(minimum_jerk(path, HZ, faster))) <= 2
