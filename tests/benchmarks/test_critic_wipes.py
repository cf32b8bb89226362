"""Failures of wiping, made from a wiping that succeeded in the simulator."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks._critic.kinds import nothing
from benchmarks._critic.played import Kind, Played
from benchmarks._critic.tools import dropped_tool, swept
from benchmarks._critic.wipes import wiped_above, wiped_another, wiped_beside, wiped_spot
from tests.benchmarks.one_played import one_played
from tests.example_scenes import thing
from vcage.schema.goals import Goal

BOARD, SPONGE = thing("cutting_board", (0.05, 0.05), 0.3), thing("sponge", (-0.25, -0.02), 0.6)
OBJECTS = [BOARD, SPONGE, thing("plate", (0.35, 0.1))]


@pytest.fixture(scope="module")
def played() -> Played:
    """A board that was wiped with a sponge, beside a plate."""
    goal = Goal(subject=BOARD.id, relation="wiped")
    return one_played("wipe", OBJECTS, goal, lambda task, grasps: task.wipe(SPONGE.id, BOARD.id, grasps), seed=1)


def test_the_wiping_itself_succeeds(played: Played) -> None:
    assert played.shots.truth.success, played.shots.truth.reason


@pytest.mark.parametrize("kind", [nothing, wiped_above, wiped_spot, wiped_beside, wiped_another, dropped_tool])
def test_the_tool_is_elsewhere_at_one_moment_or_both(played: Played, kind: Kind) -> None:
    shots = next(filter(None, (kind(played) for _ in range(20))))
    assert not shots.truth.success and shots.moment is not None and shots.later is not None
    done = (played.shots.moment, played.shots.later)
    moved = [
        np.linalg.norm(now.objects[SPONGE.id].p - was.objects[SPONGE.id].p)
        for now, was in zip((shots.moment, shots.later), done, strict=True)
        if was is not None
    ]
    assert max(moved) > 0.03
    assert np.allclose(shots.after.objects[BOARD.id].p, played.shots.after.objects[BOARD.id].p, atol=0.002)


def test_what_was_swept_away_stands_elsewhere_afterwards(played: Played) -> None:
    shots = swept(played)
    assert shots is not None and not shots.truth.success
    assert np.linalg.norm(shots.after.objects[BOARD.id].p - played.shots.after.objects[BOARD.id].p) > 0.03
