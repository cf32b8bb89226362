"""Shakes: about which axes, how high, and what fails."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.benchmarks.test_critic_shakes import BLOCK, shaken
from tests.example_scenes import TABLE_TOP, thing
from vcage.base.geometry import Pose, frame_from_axes
from vcage.tasks.primitives import shake
from vcage.tasks.primitives.shake import leans

BOTTLE = thing("bottle", (0.0, 0.0))
LIFTED = BOTTLE.moved(Pose(BOTTLE.pose.p + [0.0, 0.0, 0.1], BOTTLE.pose.q))


def hand(closing: tuple[float, float, float]) -> Pose:
    """A hand from above whose fingers close along an axis of the world."""
    return frame_from_axes(LIFTED.aabb.mean(axis=0), (0.0, 0.0, -1.0), closing)


@pytest.mark.parametrize("closing", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
def test_it_leans_first_across_the_line_from_finger_to_finger(closing: tuple[float, float, float]) -> None:
    gripper = hand(closing)
    (there, back), still = next(leans(gripper, LIFTED, TABLE_TOP))
    turn = back.inverse() * there
    axis = back.rotation() @ turn.q[1:] / np.linalg.norm(turn.q[1:])
    assert abs(axis @ closing) < 1e-6
    assert 2 * np.degrees(np.arccos(abs(turn.q[0]))) == pytest.approx(50)
    assert np.allclose(still.p, gripper.p)


def test_no_lean_brings_any_part_lower_than_it_may_be() -> None:
    gripper, lowest = hand((1.0, 0.0, 0.0)), TABLE_TOP + 0.12
    found = list(leans(gripper, LIFTED, lowest))
    assert found
    for poses, _ in found:
        for pose in poses:
            leaning = LIFTED.moved(pose * gripper.inverse() * LIFTED.pose)
            assert leaning.lowest >= lowest - 1e-6


def test_a_shake_shows_the_first_and_the_last_lean() -> None:
    played = shaken()
    assert played.shots.truth.success, played.shots.truth.reason
    there, back = (state.objects[BLOCK.id].rotation()[:2, 2] for state in played.shots.moments)
    assert there @ back < 0


def test_what_sags_in_the_hand_that_shakes_it_fails_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shake, "SETTINGS", replace(shake.SETTINGS, tilts_rad=0.0))
    played = shaken()
    assert played.gave_up and "in the hand that shook it" in played.shots.truth.reason
