"""Decisions of a person say so, with a reason of their own."""

from __future__ import annotations

import pytest

from vcage.runs.accepted import decided
from vcage.schema.episodes import BY_HAND, Verdict

YES = Verdict(accepted=True, reason="it stands there", confidence=0.9, provider="offline")


def edited(**changes: object) -> Verdict:
    return decided(YES, YES.model_copy(update=changes))


def test_a_verdict_that_was_not_edited_stays_the_critic_s():
    assert edited() == YES


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"accepted": False}, "refused by hand"),
        ({"accepted": False, "reason": "upside down"}, "upside down"),
        ({"confidence": 0.1}, "it stands there"),
    ],
)
def test_an_edited_verdict_is_by_hand_and_never_keeps_a_reason_of_the_contrary(changes, reason):
    assert (edited(**changes).provider, edited(**changes).reason) == (BY_HAND, reason)


def test_a_verdict_that_is_accepted_by_hand_has_no_failure():
    no = YES.model_copy(update={"accepted": False, "failure": "lost"})
    now = decided(no, no.model_copy(update={"accepted": True}))
    assert (now.failure, now.reason) == (None, "accepted by hand")
