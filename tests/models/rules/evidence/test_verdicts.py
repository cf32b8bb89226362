"""Measurements become verdicts, and a no says what went wrong."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from vcage.base.geometry import Pose
from vcage.models.rules.critic import judge_others
from vcage.models.rules.evidence.handed import Between
from vcage.models.rules.evidence.held_up import SETTINGS
from vcage.models.rules.evidence.in_hand import InHand
from vcage.models.rules.evidence.parts import PartEvidence
from vcage.models.rules.evidence.placed import Placed
from vcage.models.rules.evidence.raised import Raised
from vcage.models.rules.evidence.shaken import Shaken, TurnInHand
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


RAISED = Raised(0.9, 0.9, 0.0, 0.0, 0.8, 0.12, True, 0.0, None, None, STANDS, STANDS)
"""A mug that one arm holds up, without a camera on its hand."""

SURE, UNSURE, DOUBTED = InHand(0.9, 0.5), InHand(None, 0.5), InHand(None, -0.2)

APART: dict[str, Any] = {"fingers_touch": False}
UNTOLD: dict[str, Any] = {"vacated": None, "changed": None}
"""The customer does not tell if it left its place."""


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({}, "80 % of the mug is seen 12 cm above its place"),
        ({"seen": 0.4, "hand": SURE}, "the camera on the hand sees it between the fingers"),
        ({"vacated": None}, "80 % of"),
        ({**UNTOLD, "hand": SURE}, "sees it between the fingers"),
        ({**UNTOLD, "hand": SURE, "stays": None}, "sees it between the fingers"),
        ({**UNTOLD, "hand": SURE, "stays": 0.5}, "sees it between the fingers"),
        ({**UNTOLD, "hand": UNSURE, "stays": 0.1}, "80 % of"),
        ({"seen": 0.7, "hand": UNSURE}, "70 % of"),
        ({"seen": 0.9, "hand": DOUBTED}, "90 % of"),
        ({"lies": 0.7, "hand": UNSURE}, "80 % of"),
        ({"lies": 0.5}, "80 % of"),
        ({"through": 0.55, "hand": UNSURE}, "80 % of"),
        ({"seen": 0.4, "stays": 0.45, "hand": SURE}, "sees it between the fingers"),
        ({"through": 0.8, "hand": SURE}, "80 % of"),
        ({"through": 0.8}, "80 % of"),
        ({"through": 0.8, "hand": InHand(0.9, -0.2)}, "80 % of"),
        ({**APART, "seen": 0.35, "hand": UNSURE}, "35 % of"),
        ({**APART, "seen": 0.35, "through": 0.7, "hand": SURE}, "sees it between the fingers"),
        ({**APART, "through": 0.8, "hand": UNSURE}, "80 % of"),
        ({**APART, "hand": InHand(0.3, 0.1)}, "80 % of"),
        ({**APART, "hand": InHand(None, -0.08)}, "80 % of"),
        ({**APART, **UNTOLD, "stays": 0.4, "hand": UNSURE}, "80 % of"),
        ({**APART, "seen": 0.0, "is_shown": False, "hand": SURE}, "sees the mug between the fingers, and its place is"),
        ({"seen": 0.4, "is_shown": False, "hand": SURE}, "40 % of"),
    ],
)
def test_what_is_seen_above_its_place_or_in_the_hand_was_lifted(changed: dict[str, Any], words: str):
    verdict = replace(RAISED, **changed).verdict("mug")
    assert verdict.accepted and words in verdict.reason


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"vacated": 0.3}, "stands where it was"),
        (UNTOLD, "nothing shows that the mug left its place"),
        ({"vacated": None, "changed": 0.5}, "stands where it was"),
        ({"vacated": None, "changed": 0.1, "hand": SURE, **APART}, "stands where it was"),
        ({**UNTOLD, "stays": None, "hand": UNSURE}, "nothing shows that the mug left its place"),
        ({**UNTOLD, "hand": InHand(None, 0.05)}, "nothing shows that the mug left its place"),
        ({**UNTOLD, "stays": 0.3, "hand": UNSURE}, "nothing shows that the mug left its place"),
        ({**UNTOLD, "stays": 0.9, "hand": SURE}, "nothing shows that the mug left its place"),
        ({**UNTOLD, "stays": 0.5, "seen": 0.6, "hand": SURE}, "nothing shows that the mug left its place"),
        ({"lies": 0.7}, "lies on the table"),
        ({"lies": 0.9, "hand": UNSURE}, "lies on the table"),
        ({"seen": 0.4, "through": 0.8, "hand": SURE}, "40 % of"),
        ({"seen": 0.4, "stays": 0.7, "hand": SURE}, "40 % of"),
        ({"through": 0.8, "hand": UNSURE}, "the table is seen where the mug would be"),
        ({"seen": 0.4}, "40 % of"),
        ({"seen": 0.7, "hand": DOUBTED}, "70 % of"),
        ({"through": 0.9, "hand": SURE}, "the table is seen where the mug would be"),
        ({"fingers_touch": True, "hand": SURE}, "the fingers have closed on nothing"),
        ({"hand": InHand(0.2, 0.5)}, "does not see the mug between the fingers"),
        ({**APART, "hand": InHand(0.1, 0.5)}, "does not see the mug between the fingers"),
        ({**APART, **UNTOLD, "hand": InHand(0.3, 0.5)}, "does not see the mug between the fingers"),
        ({**APART, "vacated": 0.3, "hand": SURE}, "stands where it was"),
        ({**APART, **UNTOLD, "stays": 0.7, "hand": UNSURE}, "nothing shows that the mug left"),
        ({**APART, **UNTOLD, "stays": 0.4, "seen": 0.6, "hand": SURE}, "nothing shows that the mug left"),
        ({**APART, "seen": 0.9, "through": 0.8, "hand": DOUBTED}, "the table is seen where the mug would be"),
        ({**APART, "seen": 0.25, "hand": SURE}, "25 % of"),
        ({**APART, "seen": 0.4, "stays": 0.7, "hand": SURE}, "40 % of"),
        ({**APART, "seen": 0.4, "lies": 0.7, "hand": SURE}, "40 % of"),
        ({**APART, "seen": 0.4, "through": 0.9, "hand": SURE}, "40 % of"),
        ({"seen": 0.0, "is_shown": False, "hand": SURE}, "0 % of"),
        ({**APART, "seen": 0.0, "is_shown": False, "hand": UNSURE}, "0 % of"),
        ({**APART, "seen": 0.0, "is_shown": False, "hand": SURE, "stays": 0.5}, "0 % of"),
        ({**APART, "seen": 0.0, "is_shown": False, "hand": SURE, "stays": None}, "0 % of"),
    ],
)
def test_what_is_seen_elsewhere_or_too_little_was_not_lifted(changed: dict[str, Any], words: str):
    verdict = replace(RAISED, **changed).verdict("mug")
    assert not verdict.accepted and words in verdict.reason


def test_what_both_arms_lift_must_be_seen_more_plainly():
    raised = replace(RAISED, seen=0.62)
    assert raised.verdict("thing").accepted
    assert not raised.verdict("thing", SETTINGS.with_both_share).accepted


@pytest.mark.parametrize(
    ("swung", "rocked", "upright", "accepted", "words"),
    [
        (0.03, 0.6, None, True, "beside it the arm swung, 300 cm² changed"),
        (0.0, 0.6, None, False, "the hand that holds the mug has not swung"),
        (0.03, 0.1, 1.0, False, "hung upright while the hand leaned"),
        (0.03, 0.1, 1.5, True, "the arm swung"),
        (0.03, 0.1, None, False, "hung upright while the hand leaned"),
        (0.03, 0.3, 0.96, False, "hung upright while the hand leaned"),
        (0.03, 0.3, 0.99, True, "the arm swung"),
        (0.03, 0.3, None, True, "the arm swung"),
        (0.03, 0.55, 0.95, True, "the arm swung"),
        (0.03, None, 0.95, True, "the arm swung"),
        (0.03, None, 0.9, False, "hung upright while the hand leaned"),
        (0.03, None, None, True, "the arm swung"),
    ],
    ids=[
        "leaned",
        "stood still",
        "seems to hang upright",
        "leaned towards the customer",
        "seems to hang upright, no camera on the hand",
        "edges leave it open, the hand sees it upright",
        "edges leave it open, the hand sees it lean",
        "edges leave it open, no camera on the hand",
        "edges likely lean, the hand cannot tell",
        "round, the hand cannot tell",
        "round, the hand sees it upright",
        "round, no camera on the hand",
    ],
)
def test_what_was_shaken_leaned_with_the_hand_that_swung(
    swung: float, rocked: float | None, upright: float | None, accepted: bool, words: str
):
    in_hand = None if upright is None else TurnInHand(upright, kept=0.9)
    verdict = Shaken(RAISED, RAISED, swung, rocked, in_hand).verdict("mug")
    assert verdict.accepted is accepted
    assert words in verdict.reason


@pytest.mark.parametrize(
    ("rocked", "upright", "kept", "accepted"),
    [
        (None, 1.02, 0.6, False),
        (0.3, 1.02, 0.6, False),
        (None, 1.1, 0.6, True),
        (0.55, 0.95, 0.6, True),
        (None, 0.95, 0.75, True),
    ],
    ids=["round", "edges leave it open", "the hand sees it lean", "edges likely lean", "looks the same"],
)
def test_what_looks_turned_in_the_hand_must_be_seen_to_lean(
    rocked: float | None, upright: float, kept: float, accepted: bool
):
    verdict = Shaken(RAISED, RAISED, 0.03, rocked, TurnInHand(upright, kept)).verdict("mug")
    assert verdict.accepted is accepted
    assert ("hung upright" in verdict.reason) is not accepted


def test_what_leans_surely_in_the_hand_may_show_the_table_where_it_is_drawn_upright():
    leaning = replace(RAISED, through=0.9, hand=SURE)
    assert Shaken(leaning, leaning, 0.03, 0.6, None).verdict("mug").accepted


def test_what_is_seen_in_the_air_at_one_side_only_was_not_shaken():
    verdict = Shaken(RAISED, replace(RAISED, seen=0.1), 0.03, 0.6, None).verdict("mug")
    assert not verdict.accepted and "10 % of" in verdict.reason


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
