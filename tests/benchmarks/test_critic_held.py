"""Failures to hold something up, made from a hold that succeeded in the simulator."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks._critic.grips import only_gripped
from benchmarks._critic.kinds import lost, not_lifted, nothing, off_table, wrong_object, wrong_place
from benchmarks._critic.played import Kind, Played
from tests.benchmarks.one_played import one_played
from tests.example_scenes import thing
from vcage.schema.goals import Goal
from vcage.sim.state import WorldState
from vcage.tasks.task import Task

BLOCK = thing("block", (-0.2, -0.05), 0.3)
OTHERS = [thing("plate", (0.0, 0.1)), thing("mug", (0.3, 0.1))]


@pytest.fixture(scope="module")
def played() -> Played:
    """A block that the left arm holds up."""

    def hold(task: Task, grasps: list[tuple[int, str]]) -> None:
        task.pick(BLOCK.id, grasps)
        task.hold()

    goal = Goal(subject=BLOCK.id, relation="held_up")
    return one_played("hold_up", [BLOCK, *OTHERS], goal, hold, seed=1, goes_home=False)


def widths(played: Played, state: WorldState | None) -> dict[str, float]:
    """Distance between the fingers of each arm, metres."""
    assert state is not None
    world = played.case.build()
    world.set_state(state)
    return {name: arm.finger_width for name, arm in world.arms.items()}


def test_the_hand_that_holds_it_up_has_its_fingers_apart(played: Played) -> None:
    assert played.shots.truth.success
    assert widths(played, played.shots.after)["left"] == pytest.approx(BLOCK.asset.size[0], abs=2e-3)


@pytest.mark.parametrize("kind", [lost, wrong_place])
def test_the_simulator_closes_a_hand_on_what_is_taken_out_of_it(played: Played, kind: Kind) -> None:
    shots = kind(played)
    assert shots is not None and not shots.truth.success
    assert widths(played, shots.after)["left"] < 1e-3


@pytest.mark.parametrize("kind", [lost, off_table, wrong_place, not_lifted, nothing])
def test_a_hand_without_it_is_shown_closed_and_the_other_one_open(played: Played, kind: Kind) -> None:
    shots = kind(played)
    assert shots is not None and not shots.truth.success and shots.moments
    for state in shots.moments:
        assert np.allclose(list(widths(played, state).values()), [0.0, 0.08], atol=1e-3)


@pytest.mark.parametrize("kind", [off_table, not_lifted])
def test_it_is_closed_at_the_end_too(played: Played, kind: Kind) -> None:
    shots = kind(played)
    assert shots is not None
    assert widths(played, shots.after)["left"] < 1e-3


def test_what_was_only_gripped_stands_where_it_stood_between_the_fingers(played: Played) -> None:
    shots = only_gripped(played)
    assert shots is not None and not shots.truth.success
    for state in (*shots.moments, shots.after):
        assert state.objects[BLOCK.id].p == pytest.approx(shots.before.objects[BLOCK.id].p)
        assert widths(played, state) == pytest.approx(widths(played, played.shots.after))
        assert hand(played, state) == pytest.approx(hand(played, played.shots.after), abs=1e-3)


def test_a_hand_that_took_another_thing_keeps_its_fingers_around_it(played: Played) -> None:
    shots = wrong_object(played)
    assert shots is not None and shots.moment is not None
    assert widths(played, shots.after)["left"] > 5e-3
    assert widths(played, shots.moment)["left"] == pytest.approx(widths(played, shots.after)["left"])


def hand(played: Played, state: WorldState) -> np.ndarray:
    """(3,) where the block is in the left hand."""
    world = played.case.build()
    world.set_state(state)
    return (world.arms["left"].tool_pose.inverse() * state.objects[BLOCK.id]).p
