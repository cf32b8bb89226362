"""Failures of pouring, made from a pouring that succeeded in the simulator."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks._critic.kinds import nothing
from benchmarks._critic.played import Kind, Played
from benchmarks._critic.pours import (
    half_beside,
    missed,
    poured_elsewhere,
    poured_half,
    poured_nothing,
    vessel_dropped,
)
from tests.benchmarks.one_played import one_played
from tests.example_scenes import thing
from tests.tasks.templates.test_pour import BOWL, CUP, GOAL, ROBOT, filled, workplace

BALLS = filled(CUP)
OBJECTS = [CUP, BOWL, *BALLS, thing("basket", (0.3, 0.1))]


@pytest.fixture(scope="module")
def played() -> Played:
    """A cup that was poured into a bowl, beside a basket."""
    arms = {"place": workplace(OBJECTS), "robot": ROBOT}
    return one_played("pour", OBJECTS, GOAL, lambda task, grasps: task.pour(CUP.id, BOWL.id, grasps), seed=1, **arms)


def away(played: Played, name: str, shots) -> float:
    """Distance of an object afterwards from where it really was then, metres."""
    return float(np.linalg.norm(shots.after.objects[name].p - played.shots.after.objects[name].p))


def test_the_pouring_itself_succeeds(played: Played) -> None:
    assert played.shots.truth.success, played.shots.truth.reason


@pytest.mark.parametrize(
    ("kind", "balls"),
    [(nothing, 3), (poured_nothing, 3), (missed, 3), (poured_elsewhere, 3), (poured_half, 2), (half_beside, 2)],
)
def test_some_or_all_balls_are_elsewhere_afterwards(played: Played, kind: Kind, balls: int) -> None:
    shots = kind(played)
    assert shots is not None and not shots.truth.success
    assert sum(away(played, ball.id, shots) > 0.03 for ball in BALLS) == balls


def test_a_dropped_vessel_lies_on_its_side_and_the_balls_in_the_container(played: Played) -> None:
    shots = vessel_dropped(played)
    assert shots is not None and not shots.truth.success
    assert abs(shots.after.objects[CUP.id].rotation()[2, 2]) < 0.1
    assert all(away(played, ball.id, shots) == 0 for ball in BALLS)
