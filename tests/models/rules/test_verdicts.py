"""Measurements of a hand-over become a verdict."""

from __future__ import annotations

import numpy as np
import pytest

from vcage.base.geometry import Pose
from vcage.models.rules.evidence_of_places import Handed
from vcage.models.rules.standing import Standing
from vcage.models.rules.verdicts import decide_handed

STANDS = Standing(Pose(), (0.1, 0.1, 0.1), 0.0, np.ones((1, 1), bool))


@pytest.mark.parametrize(
    ("evidence", "accepted", "words"),
    [
        (Handed(0.9, 0.9, (0.3, 0.4), STANDS, STANDS), True, "is in the air while both arms reach out: 30 % and 40 %"),
        (Handed(0.1, 0.9, (0.3, 0.4), STANDS, STANDS), False, "lies where it was at the moment"),
        (Handed(0.9, 0.1, (0.3, 0.4), STANDS, STANDS), False, "was put down before the moment"),
        (Handed(0.9, 0.9, (0.3, 0.01), STANDS, STANDS), False, "not both arms reach out"),
        (None, False, "is not found before and after"),
    ],
)
def test_a_hand_over_needs_a_thing_in_the_air_and_both_arms(evidence: Handed | None, accepted: bool, words: str):
    verdict = decide_handed(evidence, "red hammer")
    assert verdict.accepted is accepted
    assert words in verdict.reason
