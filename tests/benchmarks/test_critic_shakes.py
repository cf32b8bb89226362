"""Failures of a shake, made from a shake that succeeded in the simulator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks._critic.kinds import not_lifted, nothing, off_table, wrong_words
from benchmarks._critic.played import Kind, Played
from benchmarks._critic.shakes import hung_plumb, hung_still, leaned_once
from tests.benchmarks.one_played import one_played
from tests.example_scenes import TABLE_TOP, thing
from vcage.base.geometry import Pose, tilt_between
from vcage.goals.kind import TABLE
from vcage.schema.goals import Goal
from vcage.sim.state import WorldState
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import Slot
from vcage.tasks.task import Task

BLOCK = thing("block", (-0.2, -0.05), 0.3)
ASIDE = Slot(TABLE, None, Pose([-0.3, 0.08, TABLE_TOP]))
OTHERS = [thing("plate", (0.0, 0.1)), thing("mug", (0.3, 0.1))]


def shaken(subject: SceneObject = BLOCK) -> Played:
    """Something that was shaken, and put aside."""

    def shake(task: Task, grasps: list[tuple[int, str]]) -> None:
        task.pick(subject.id, grasps)
        task.shake()
        task.place()

    goal = Goal(subject=subject.id, relation="shaken")
    return one_played("shake", [subject, *OTHERS], goal, shake, seed=1, slots={subject.id: ASIDE})


@pytest.fixture(scope="module")
def played() -> Played:
    return shaken()


def leaned(state: WorldState | None) -> float:
    """How far the block leans, degrees."""
    assert state is not None
    return float(np.degrees(tilt_between(state.objects[BLOCK.id], BLOCK.pose)))


def test_only_what_is_no_ball_is_seen_to_hang_upright(played: Played) -> None:
    assert hung_plumb(played) is None
    bottle = thing("bottle", (-0.2, -0.05))
    shots = hung_plumb(shaken(bottle))
    assert shots is not None and not shots.truth.success
    poses = [state.objects[bottle.id] for state in shots.moments]
    assert all(np.degrees(tilt_between(pose, bottle.pose)) < 1 for pose in poses)


@pytest.mark.parametrize("kind", [hung_still, leaned_once])
def test_a_hand_that_did_not_tilt_it_to_both_sides_is_a_failure(played: Played, kind: Kind) -> None:
    shots = kind(played)
    assert shots is not None and not shots.truth.success
    upright = kind is not leaned_once
    assert all((leaned(state) < 1) is upright for state in shots.moments)


def test_a_hand_that_hung_still_stands_between_the_leans(played: Played) -> None:
    shots, done = hung_still(played), played.shots.moments
    assert shots is not None and shots.moment is not None
    for name, joints in shots.moment.joints.items():
        assert np.allclose(joints, (done[0].joints[name] + done[1].joints[name]) / 2)


@pytest.mark.parametrize("kind", [nothing, not_lifted, off_table])
def test_what_was_not_carried_is_in_the_hand_at_neither_side(played: Played, kind: Kind) -> None:
    shots = kind(played)
    assert shots is not None and len(shots.moments) == 2
    for now, was in zip(shots.moments, played.shots.moments, strict=True):
        assert np.linalg.norm(now.objects[BLOCK.id].p - was.objects[BLOCK.id].p) > 0.05


def test_what_was_shaken_is_not_asked_about_as_if_it_had_not_been_lifted(played: Played) -> None:
    lifted = played.subtask.model_copy(update={"goals": [Goal(subject=BLOCK.id, relation="lifted")]})
    assert wrong_words(replace(played, case=replace(played.case, others=[lifted]))) is None
