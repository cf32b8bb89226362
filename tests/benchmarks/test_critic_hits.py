"""Failures of a hit, made from a hit that succeeded in the simulator."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks._critic.hits import hit_another, hit_beside, not_down
from benchmarks._critic.played import Kind, Played
from benchmarks._critic.tools import dropped_tool, swept
from tests.benchmarks.one_played import one_played
from tests.example_scenes import thing
from vcage.schema.goals import Goal

OBJECTS = [thing("block", (0.05, 0.05)), thing("hammer", (-0.2, -0.05), 0.6), thing("apple", (0.3, 0.15))]


@pytest.fixture(scope="module")
def played() -> Played:
    """A block that was hit with a hammer, beside an apple."""
    goal = Goal(subject="block", relation="hit")
    return one_played("hit", OBJECTS, goal, lambda task, grasps: task.hit("hammer", "block", grasps), seed=0)


def test_the_hit_itself_succeeds(played: Played) -> None:
    assert played.shots.truth.success, played.shots.truth.reason


@pytest.mark.parametrize("kind", [hit_beside, not_down, hit_another, dropped_tool])
def test_the_tool_is_elsewhere_at_the_moment(played: Played, kind: Kind) -> None:
    shots = kind(played)
    assert shots is not None and not shots.truth.success
    assert shots.moment is not None and played.shots.moment is not None
    moved = shots.moment.objects["hammer"].p - played.shots.moment.objects["hammer"].p
    assert np.linalg.norm(moved) > 0.03
    assert np.allclose(shots.after.objects["block"].p, played.shots.after.objects["block"].p)


def test_what_was_swept_away_stands_elsewhere_afterwards(played: Played) -> None:
    shots = swept(played)
    assert shots is not None and not shots.truth.success
    assert np.linalg.norm(shots.after.objects["block"].p - played.shots.after.objects["block"].p) > 0.03
