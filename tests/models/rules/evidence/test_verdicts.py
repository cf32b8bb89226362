"""Measurements become verdicts, and a no says what went wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vcage.base.geometry import Pose
from vcage.models.rules.critic import judge_others
from vcage.models.rules.evidence.in_the_air import InTheAir
from vcage.models.rules.evidence.parts import PartEvidence
from vcage.models.rules.evidence.placed import Placed
from vcage.models.rules.standing import Standing
from vcage.schema.episodes import Failure
from vcage.schema.goals import Goal

IN = Placed(
    left=0.9,
    shifted=0,
    stirred=0,
    inside=0.8,
    share=0.9,
    alike=0.9,
    beside=0,
    margin=0.1,
    explained=np.zeros((1, 1), bool),
)
"""What is where it should be."""

STANDS = Standing(Pose(), (0.1, 0.1, 0.1), 0.0, np.ones((1, 1), bool))


@pytest.mark.parametrize(
    ("evidence", "accepted", "words"),
    [
        (
            InTheAir(0.9, 0.9, (0.3, 0.4), STANDS, STANDS),
            True,
            "is in the air while both arms reach out: 30 % and 40 %",
        ),
        (InTheAir(0.1, 0.9, (0.3, 0.4), STANDS, STANDS), False, "lies where it was at the moment"),
        (InTheAir(0.9, 0.1, (0.3, 0.4), STANDS, STANDS), False, "was put down before the moment"),
        (InTheAir(0.9, 0.9, (0.3, 0.01), STANDS, STANDS), False, "not both arms reach out"),
    ],
)
def test_a_hand_over_needs_both_arms(evidence: InTheAir, accepted: bool, words: str):
    verdict = evidence.verdict("red hammer", 2, "the hand-over")
    assert verdict.accepted is accepted
    assert words in verdict.reason


@pytest.mark.parametrize(("arms", "accepted"), [((0.3, 0.01), True), ((0.01, 0.01), False)])
def test_a_lift_needs_one_arm(arms: tuple[float, float], accepted: bool):
    verdict = InTheAir(0.9, 0.9, arms, STANDS, STANDS).verdict("red hammer", 1, "the lift")
    assert verdict.accepted is accepted


@pytest.mark.parametrize(
    ("changed", "failure"),
    [
        ({}, None),
        ({"left": 0.1}, "lost"),
        ({"inside": 0.0}, "lost"),
        ({"inside": 0.0, "beside": 0.9}, "astray"),
        ({"share": 0.2}, "astray"),
        ({"shifted": 0.2}, "astray"),
        ({"stirred": 0.5}, "astray"),
        ({"plain": False}, None),
        ({"share": 0.8, "margin": 0.01}, "astray"),
        ({"alike": 0.0}, None),
    ],
)
def test_a_no_about_a_placement_says_what_went_wrong(changed: dict[str, float], failure: Failure | None):
    goal = Goal(subject="block", relation="inside", reference="box")
    verdict = replace(IN, **changed).verdict(goal, "red block", "brown box")
    assert (verdict.accepted, verdict.failure) == (not changed, failure)


@pytest.mark.parametrize(
    ("area", "vanished", "failure"), [(0.0, [], None), (0.01, [], "disturbed"), (0.0, ["white bowl"], "disturbed")]
)
def test_another_moved_object_is_reported(area: float, vanished: list[str], failure: Failure | None):
    assert judge_others(area, vanished).failure == failure


@pytest.mark.parametrize(
    ("rest", "accepted"), [(8.0, True), (2.05, False)], ids=["others are unlike", "another is as like"]
)
def test_a_part_counts_as_open_only_where_the_picture_sets_it_apart_from_a_shut_one(rest: float, accepted: bool):
    costs = np.array([rest, *[9.0] * 12, 6.0, 5.0, 3.0, 2.0])
    evidence = PartEvidence(500, 0.0, 1.0, costs, np.inf, 0.0, np.zeros((2, 2), bool))
    told = evidence.moved(Goal(subject="laptop", relation="open", part="screen"), "laptop")
    assert told.accepted is accepted
