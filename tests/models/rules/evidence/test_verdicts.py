"""Measurements become verdicts, and a no says what went wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vcage.base.geometry import Pose
from vcage.models.rules.critic import judge_others
from vcage.models.rules.evidence.handed import Between
from vcage.models.rules.evidence.parts import PartEvidence
from vcage.models.rules.evidence.placed import Placed
from vcage.models.rules.evidence.raised import SETTINGS, Raised
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
            Between(0.9, 0.9, (0.3, 0.4), STANDS, STANDS),
            True,
            "is in the air while both arms reach out: 30 % and 40 %",
        ),
        (Between(0.1, 0.9, (0.3, 0.4), STANDS, STANDS), False, "lies where it was at the moment"),
        (Between(0.9, 0.1, (0.3, 0.4), STANDS, STANDS), False, "was put down before the moment"),
        (Between(0.9, 0.9, (0.3, 0.01), STANDS, STANDS), False, "not both arms reach out"),
    ],
)
def test_a_hand_over_needs_both_arms(evidence: Between, accepted: bool, words: str):
    verdict = evidence.verdict("red hammer")
    assert verdict.accepted is accepted
    assert words in verdict.reason


@pytest.mark.parametrize(
    ("vacated", "seen", "words"),
    [
        (0.9, 0.8, "80 % of the mug is seen 12 cm above its place"),
        (0.1, 0.8, "stands where it was"),
        (0.9, 0.1, "10 % of"),
    ],
)
def test_what_was_lifted_is_seen_in_the_air_and_not_below(vacated: float, seen: float, words: str):
    verdict = Raised(vacated, seen, 0.0, 0.12, STANDS, STANDS).verdict("mug")
    assert verdict.accepted is (min(vacated, seen) > 0.5)
    assert words in verdict.reason


def test_what_both_arms_lift_must_be_seen_more_plainly():
    raised = Raised(0.9, 0.62, 0.0, 0.1, STANDS, STANDS)
    assert raised.verdict("thing").accepted
    assert not raised.verdict("thing", SETTINGS.with_both_share).accepted


@pytest.mark.parametrize(("leans", "words"), [(0.3, "tilted in the air"), (0.0, "upright"), (-0.3, "upright")])
def test_what_was_shaken_is_seen_tilted(leans: float, words: str):
    verdict = Raised(0.9, 0.8, leans, 0.12, STANDS, STANDS).leaning("mug")
    assert verdict.accepted is (leans > 0.2)
    assert words in verdict.reason


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
    evidence = PartEvidence(500, 0.0, 1.0, costs, np.inf, np.zeros((2, 2), bool))
    told = evidence.moved(Goal(subject="laptop", relation="open", part="screen"), "laptop")
    assert told.accepted is accepted
