"""Failures of standing something up, made from a can that was stood up in the simulator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks._critic.played import Case, Kind, Played
from benchmarks._critic.uprights import fell_over, on_its_head, still_held, still_lying
from tests.example_scenes import script_of, thing, workplace, world_of
from vcage.schema.goals import Goal
from vcage.tasks.chain_slots import slots_for_chain
from vcage.tasks.task import Task
from vcage.tasks.templates import TEMPLATES

CAN = thing("can", (-0.15, -0.05), 2.0, variant="corn_lying")
OTHER = thing("block", (0.2, 0.1))
GOAL = Goal(subject="can", relation="upright")


@pytest.fixture(scope="module")
def played() -> Played:
    """A can that was stood up beside a block."""
    objects, place = [CAN, OTHER], workplace([CAN, OTHER])
    (proposal, *_), _ = TEMPLATES["set_down"].proposals([CAN], [GOAL])
    step, refused = proposal.examine(place)
    assert step is not None, refused

    def play(task: Task) -> None:
        task.pick("can", [(grasp.contact, grasp.arm) for grasp in step.grasps])
        task.place()
        task.home()

    return Case(
        subtask=step,
        script=script_of(step, play),
        objects={o.id: o for o in objects},
        slots={"can": slots_for_chain([step], place)[step.id]},
        build=lambda: world_of(objects),
        others=(),
        rng=np.random.default_rng(1),
    ).play()


def up(played: Played, state) -> float:
    """The cosine of its lean in a state."""
    return float(CAN.moved(state.objects["can"]).as_standing.pose.rotation()[2, 2])


def test_the_standing_up_itself_succeeds(played: Played) -> None:
    assert played.shots.truth.success, played.shots.truth.reason
    assert up(played, played.shots.after) > 0.999


@pytest.mark.parametrize("kind", [still_lying, fell_over])
def test_it_lies_on_its_side_afterwards(played: Played, kind: Kind) -> None:
    shots = kind(played)
    assert shots is not None and not shots.truth.success
    assert abs(up(played, shots.after)) < 0.2


def test_on_its_head_it_stands_where_it_should_stand(played: Played) -> None:
    shots = on_its_head(played)
    assert shots is not None and not shots.truth.success
    headed = CAN.moved(shots.after.objects["can"]).as_standing
    assert up(played, shots.after) < -0.999
    assert headed.lowest == pytest.approx(CAN.lowest, abs=0.002)


def test_what_is_still_held_is_seen_in_the_hand(played: Played) -> None:
    shots = still_held(played)
    assert shots is not None and not shots.truth.success and shots.after is played.shots.moment


def test_of_what_did_not_lie_no_such_failure_is_made(played: Played) -> None:
    case = replace(played.case, objects={"can": thing("can", (-0.15, -0.05)), OTHER.id: OTHER})
    standing = replace(played, case=case)
    assert [kind(standing) for kind in (still_lying, fell_over, on_its_head, still_held)] == [None] * 4
