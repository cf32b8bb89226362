"""Measurements of a hand-over become a verdict."""

from __future__ import annotations

import pytest

from vcage.models.rules.evidence_of_places import Handed
from vcage.models.rules.verdicts import decide_handed


@pytest.mark.parametrize(
    ("evidence", "accepted", "words"),
    [
        (Handed(0.9, 0.9, (0.3, 0.4)), True, "is in the air while both arms reach out: 30 % and 40 %"),
        (Handed(0.1, 0.9, (0.3, 0.4)), False, "lies where it was at the moment"),
        (Handed(0.9, 0.1, (0.3, 0.4)), False, "was put down before the moment"),
        (Handed(0.9, 0.9, (0.3, 0.01)), False, "not both arms reach out"),
        (None, False, "is not found before and after"),
    ],
)
def test_a_hand_over_needs_a_thing_in_the_air_and_both_arms(evidence: Handed | None, accepted: bool, words: str):
    verdict = decide_handed(evidence, "red hammer")
    assert verdict.accepted is accepted
    assert words in verdict.reason
