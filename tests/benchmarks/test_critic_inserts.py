"""Failures of inserting, made from an insertion that succeeded in the simulator."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks._critic.hangs import still_in_the_hand
from benchmarks._critic.inserts import block_pushed, half_in, lies_before_the_hole, lies_beside, lies_on_top
from benchmarks._critic.kinds import nothing
from benchmarks._critic.played import Kind, Played
from tests.benchmarks.one_played import one_played
from tests.tasks.templates.test_insert import BLOCK, GOAL, PEG
from vcage.goals.thresholds import THRESHOLDS
from vcage.tasks.inserting import inserted


@pytest.fixture(scope="module")
def played() -> Played:
    """A peg that was inserted in a block."""
    return one_played("insert", [PEG, BLOCK], GOAL, lambda task, grasps: task.insert(PEG.id, BLOCK.id, grasps), seed=1)


def filled(played: Played, kind: Kind) -> float:
    """The share of the length of the hole that is filled after a failure."""
    shots = kind(played)
    assert shots is not None and not shots.truth.success
    now = played.now(shots.after)
    lies = inserted(now[PEG.id], now[BLOCK.id])
    assert lies is not None
    return lies.share


def test_the_inserting_itself_succeeds(played: Played) -> None:
    assert played.shots.truth.success, played.shots.truth.reason


@pytest.mark.parametrize("kind", [nothing, lies_beside, lies_before_the_hole, lies_on_top])
def test_no_part_of_the_peg_is_in_the_hole_afterwards(played: Played, kind: Kind) -> None:
    assert filled(played, kind) == 0.0


def test_a_peg_in_the_mouth_fills_too_little_of_the_hole(played: Played) -> None:
    assert 0.0 < filled(played, half_in) < THRESHOLDS.inserted_share


def test_a_block_that_was_pushed_away_has_the_peg_in_it(played: Played) -> None:
    assert filled(played, block_pushed) == pytest.approx(1.0)
    shots = block_pushed(played)
    assert shots is not None and "was moved by" in shots.truth.reason
    assert np.linalg.norm(shots.after.objects[BLOCK.id].p - BLOCK.pose.p) > THRESHOLDS.disturbed_m


def test_a_peg_that_is_still_held_is_in_the_hole(played: Played) -> None:
    assert filled(played, still_in_the_hand) == pytest.approx(1.0)
