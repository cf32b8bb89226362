"""Failures of hanging, made from a hanging that succeeded in the simulator."""

from __future__ import annotations

import pytest

from benchmarks._critic.hangs import fell_beside, leans_on_it, still_in_the_hand, stood_beside
from benchmarks._critic.kinds import nothing
from benchmarks._critic.played import Kind, Played
from tests.benchmarks.one_played import one_played
from tests.tasks.templates.test_hang import GOAL, MUG, RACK
from vcage.tasks.hanging import hangs_on


@pytest.fixture(scope="module")
def played() -> Played:
    """A mug that was hung on a rack."""
    return one_played("hang", [MUG, RACK], GOAL, lambda task, grasps: task.hang(MUG.id, RACK.id, grasps), seed=1)


def test_the_hanging_itself_succeeds(played: Played) -> None:
    assert played.shots.truth.success, played.shots.truth.reason


@pytest.mark.parametrize("kind", [nothing, stood_beside, fell_beside, leans_on_it])
def test_no_peg_passes_through_the_handle_afterwards(played: Played, kind: Kind) -> None:
    shots = kind(played)
    assert shots is not None and not shots.truth.success
    now = played.now(shots.after)
    assert not hangs_on(now[MUG.id], now[RACK.id])


def test_a_mug_that_is_still_held_is_on_the_peg_and_in_the_hand(played: Played) -> None:
    shots = still_in_the_hand(played)
    assert shots is not None and not shots.truth.success
    now = played.now(shots.after)
    assert hangs_on(now[MUG.id], now[RACK.id]) and now[MUG.id].pose.rotation()[2, 2] > 0.99
