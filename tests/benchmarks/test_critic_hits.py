"""Failures of a hit, made from a hit that succeeded in the simulator."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks._critic.hits import hit_another, hit_beside, not_down
from benchmarks._critic.played import Case, Kind, Played
from benchmarks._critic.tools import dropped_tool, swept
from tests.example_scenes import script_of, thing, workplace, world_of
from vcage.schema.goals import Goal
from vcage.tasks.templates import TEMPLATES

OBJECTS = [thing("block", (0.05, 0.05)), thing("hammer", (-0.2, -0.05), 0.6), thing("apple", (0.3, 0.15))]


@pytest.fixture(scope="module")
def played() -> Played:
    """A block that was hit with a hammer, beside an apple."""
    ((proposal,), _) = TEMPLATES["hit"].proposals(OBJECTS, [Goal(subject="block", relation="hit")])
    step, _ = proposal.examine(workplace(OBJECTS))
    assert step is not None
    grasps = [(grasp.contact, grasp.arm) for grasp in step.grasps]

    def play(task) -> None:
        task.hit("hammer", "block", grasps)
        task.home()

    return Case(
        subtask=step,
        script=script_of(step, play),
        objects={o.id: o for o in OBJECTS},
        slots={},
        build=lambda: world_of(OBJECTS),
        others=(),
        rng=np.random.default_rng(0),
    ).play()


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
