"""Legs that follow each other, and the bends between them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vcage.sim.paths import JointPath, Leg, Load, Stretch, stretches


def leg(*corners: tuple[float, float], speed: float = 1.0, opens: float | None = None) -> Leg:
    start, end = np.array(corners[0], dtype=float), np.array(corners[1], dtype=float)
    return Leg(start + np.linspace(0, 1, 21)[:, None] * (end - start), Load(speed=speed), opens)


AROUND = JointPath((leg((0, 0), (1, 0)), leg((1, 0), (1, 1), speed=0.5, opens=0.7)))
"""A right angle, the second leg slower and with fingers that open."""


def bent(path: JointPath, free: bool = True) -> list[Stretch]:
    return list(stretches(path, lambda _q, _load: free))


def test_a_free_corner_is_passed_without_a_stop():
    (stretch,) = bent(AROUND)
    assert np.linalg.norm(stretch.points - [1, 0], axis=1).min() > 0.15
    np.testing.assert_array_equal(stretch.points[[0, -1]], [[0, 0], [1, 1]])


def test_a_bend_leaves_the_legs_along_them():
    (stretch,) = bent(AROUND)
    steps = np.diff(stretch.points, axis=0)
    turns = np.degrees(np.abs(np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0])))))
    assert turns.max() < 20


def test_the_path_stops_at_a_corner_that_cannot_be_bent():
    first, second = bent(AROUND, free=False)
    np.testing.assert_array_equal(first.points, AROUND.legs[0].points)
    np.testing.assert_array_equal(second.points, AROUND.legs[1].points)


def test_a_bend_is_made_narrower_until_it_is_free():
    (stretch,) = stretches(AROUND, lambda q, _load: bool(q[0] > 0.7 or q[1] == 0))
    assert np.linalg.norm(stretch.points - [1, 0], axis=1).min() < 0.15


def test_a_bend_must_be_free_with_the_loads_of_both_legs():
    first, second = leg((0, 0), (1, 0)), leg((1, 0), (1, 1))
    path = JointPath((first, replace(second, load=Load(opening=0.2))))
    for refused in (0.2, 1.0):
        assert len(list(stretches(path, lambda _q, load, refused=refused: load.opening != refused))) == 2


def test_a_bend_is_as_slow_as_the_slower_leg():
    (stretch,) = bent(AROUND)
    off = (stretch.points[:, 0] < 0.999) & (stretch.points[:, 1] > 0.001)
    assert set(stretch.speed[off]) == {0.5}
    assert stretch.speed[0] == 1.0 and stretch.speed[-1] == 0.5


@pytest.mark.parametrize("free", [True, False])
def test_the_fingers_open_when_their_leg_has_begun(free: bool):
    (index, opening) = bent(AROUND, free)[-1].opens[0]
    assert opening == 0.7
    np.testing.assert_allclose(bent(AROUND, free)[-1].points[index], [1, 0.5 if free else 0], atol=0.06)


def test_a_leg_between_two_bends_keeps_its_middle():
    path = JointPath((leg((0, 0), (1, 0)), leg((1, 0), (1, 1)), leg((1, 1), (2, 1))))
    (stretch,) = bent(path)
    assert np.linalg.norm(stretch.points - [1, 0.5], axis=1).min() < 0.03
    assert np.all(np.diff(stretch.points[:, 0]) >= -1e-9) and np.all(np.diff(stretch.points[:, 1]) >= -1e-9)


def test_legs_that_go_nowhere_are_left_out():
    here = Leg(np.zeros((1, 2)), Load())
    (stretch,) = bent(JointPath((here, leg((0, 0), (1, 0)))))
    np.testing.assert_array_equal(stretch.points, leg((0, 0), (1, 0)).points)


def test_a_path_that_goes_nowhere_stays_there():
    (stretch,) = bent(JointPath((Leg(np.ones((1, 2)), Load()),)))
    np.testing.assert_array_equal(stretch.points, [[1, 1]])
