from __future__ import annotations

import itertools

import numpy as np

from vcage.sim.rrt import connect

LOWER, UPPER = np.full(2, -3.0), np.full(2, 3.0)


def misses_wall(a, b):
    """A wall at x = 0 with a gap above y = 1.5."""
    points = a + np.linspace(0, 1, 50)[:, None] * (b - a)
    return bool(np.all((np.abs(points[:, 0]) > 0.2) | (points[:, 1] > 1.5)))


def test_it_finds_the_gap_in_a_wall():
    start, goal = np.array([-1.0, 0.0]), np.array([1.0, 0.0])
    path = connect(start, goal, misses_wall, LOWER, UPPER, np.random.default_rng(0))
    assert np.array_equal(path[0], start) and np.array_equal(path[-1], goal)
    assert all(misses_wall(a, b) for a, b in itertools.pairwise(path))


def test_the_same_seed_gives_the_same_path():
    paths = [
        connect(np.array([-1.0, 0]), np.array([1.0, 0]), misses_wall, LOWER, UPPER, np.random.default_rng(3))
        for _ in range(2)
    ]
    assert np.array_equal(paths[0], paths[1])


def test_it_gives_up_without_a_path():
    closed = connect(
        np.array([-1.0, 0]), np.array([1.0, 0]), lambda a, b: b[0] < -0.5, LOWER, UPPER, np.random.default_rng(0)
    )
    assert closed is None
