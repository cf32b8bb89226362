"""Vessels that are tipped: their ways over a container."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import thing
from vcage.base.geometry import Pose
from vcage.tasks.pouring import SETTINGS, balls_in, left_in, lips, pouring_ways, suits, tipped_to

CUP, BOWL = thing("cup", (-0.25, -0.02)), thing("bowl", (0.05, 0.05))
HOLD = CUP.asset.annotation.carrying_points[0]


def test_a_way_begins_upright_and_ends_tipped_past_level() -> None:
    for way in pouring_ways(CUP, BOWL, HOLD):
        leans = [float(np.arccos(np.clip(pose.rotation()[2, 2], -1, 1))) for pose in way]
        assert leans[0] == 0 and leans[-1] == pytest.approx(SETTINGS.lean_rad)
        assert np.all(np.diff(leans) > 0)


def test_all_of_a_vessel_stays_over_the_container() -> None:
    corners = np.concatenate([piece.vertices for piece in CUP.asset.pieces])
    for way in pouring_ways(CUP, BOWL, HOLD):
        assert min(pose.apply(corners)[:, 2].min() for pose in way) >= BOWL.aabb[1, 2] + SETTINGS.clear_m - 1e-6


def test_the_lip_stays_over_the_middle_of_the_container() -> None:
    for way in list(pouring_ways(CUP, BOWL, HOLD))[:40]:
        side = tipped_to(way)
        lip = [*(side * 0.0345), CUP.asset.size[2]]
        off = [np.linalg.norm(pose.apply(lip)[:2] - BOWL.pose.p[:2]) for pose in way]
        assert max(off) <= SETTINGS.flight_m + 0.005


def test_a_cup_is_tipped_over_the_sides_where_the_fingers_are() -> None:
    sides = lips(CUP, HOLD)
    assert len(sides) == 6 and abs(sides[0] @ HOLD.closing[:2]) == pytest.approx(1.0)
    assert all(abs(side @ HOLD.closing[:2]) >= SETTINGS.with_fingers for side in sides)


def test_balls_do_not_roll_over_fingers_that_hold_a_rim() -> None:
    bowl = thing("small_bowl")
    hold = bowl.asset.annotation.contact_point(0)  # front rim
    assert suits(bowl, hold, np.array([0.0, 1.0]))
    assert not suits(bowl, hold, np.array([0.0, -1.0])) and not suits(bowl, hold, np.array([1.0, 0.0]))


@pytest.mark.parametrize(("lean_deg", "left"), [(0, 1), (110, 1)])
def test_a_ball_between_the_walls_is_in_a_vessel_however_that_leans(lean_deg: float, left: int) -> None:
    half = np.radians(lean_deg) / 2
    cup = CUP.moved(Pose([0.0, 0.0, 1.0], [np.cos(half), np.sin(half), 0.0, 0.0]))
    ball = thing("ball")
    inside, beside = (ball.moved(cup.pose * Pose([x, 0.0, 0.03])) for x in (0.0, 0.08))
    assert left_in(cup, [inside, beside]) == [inside][:left]


def test_only_balls_are_poured() -> None:
    ball, block = (thing(name).moved(Pose(CUP.pose.p + [0.0, 0.0, 0.006])) for name in ("ball", "small_block"))
    assert balls_in(CUP, [ball, block]) == [ball]
