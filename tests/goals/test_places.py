"""Moved away, left of in a row, facing the robot: where things stand in the end."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from vcage.base.geometry import Pose
from vcage.goals import KINDS
from vcage.goals.kind import State
from vcage.schema.goals import Goal


def complaint(goal: Goal, start: dict[str, Pose], now: dict[str, Pose]) -> str | None:
    """Why a goal does not hold of blocks of 5 cm."""

    def at(poses: dict[str, Pose], name: str) -> SimpleNamespace:
        pose = poses[name]
        return SimpleNamespace(pose=pose, aabb=np.stack([pose.p - [0.025, 0.025, 0], pose.p + [0.025, 0.025, 0.05]]))

    state = SimpleNamespace(thing=lambda name: at(now, name), at_start=lambda name: at(start, name))
    return KINDS[goal.relation].complaint(goal, cast(State, state))


@pytest.mark.parametrize(
    ("x", "to", "away"),
    [(0.1, 0.22, True), (-0.1, -0.22, True), (0.1, 0.15, False), (0.1, -0.3, False), (0, 0.2, True)],
)
def test_moved_away_is_outwards_on_its_own_side(x: float, to: float, away: bool):
    goal = Goal(subject="card", relation="moved_away")
    assert (complaint(goal, {"card": Pose([x, 0, 0])}, {"card": Pose([to, 0.1, 0])}) is None) is away


@pytest.mark.parametrize(
    ("x", "y", "stands"), [(-0.1, 0.02, True), (-0.1, 0.05, False), (-0.2, 0.0, False), (0.1, 0.0, False)]
)
def test_neighbours_in_a_row_are_near_and_in_line(x: float, y: float, stands: bool):
    goal = Goal(subject="red", relation="row_left_of", reference="blue")
    now = {"red": Pose([x, y, 0]), "blue": Pose()}
    assert (complaint(goal, now, now) is None) is stands


@pytest.mark.parametrize(("yaw", "faces"), [(0, True), (20, True), (60, False), (180, False)])
def test_a_front_faces_the_robot(yaw: float, faces: bool):
    now = {"box": Pose.from_yaw([0, 0, 0], np.radians(yaw))}
    assert (complaint(Goal(subject="box", relation="facing_robot"), now, now) is None) is faces


@pytest.mark.parametrize(("x", "there"), [(0.3, True), (0.32, True), (0.35, False), (-0.1, False)])
def test_a_thing_is_in_place_of_another_where_that_stood(x: float, there: bool):
    goal = Goal(subject="apple", relation="in_place_of", reference="lemon")
    start = {"apple": Pose([-0.1, 0, 0]), "lemon": Pose([0.3, 0, 0])}
    now = {"apple": Pose([x, 0, 0]), "lemon": Pose([0.0, 0.2, 0])}
    assert (complaint(goal, start, now) is None) is there


@pytest.mark.parametrize(
    ("around", "alone"),
    [
        ({"basket": {"apple", "table"}, "apple": {"basket"}}, True),
        ({"basket": {"apple", "table"}, "apple": {"basket", "table"}}, False),
        ({"basket": {"apple", "table"}, "apple": {"basket", "left"}}, False),
        ({"basket": {"table", "left"}}, True),
    ],
    ids=["in it", "beside it", "in a hand", "a hand at it"],
)
def test_a_thing_stands_on_the_table_with_what_lies_in_it(around: dict[str, set[str]], alone: bool):
    thing = SimpleNamespace(aabb=np.array([[0, 0, 0.74], [0.2, 0.2, 0.84]]))
    state = SimpleNamespace(
        arms=("left", "right"), table_height=0.74, thing=lambda _: thing, touching=lambda name: around[name]
    )
    goal = Goal(subject="basket", relation="on", reference="table")
    assert (goal.kind.complaint(goal, cast(State, state)) is None) is alone
