"""Acceptance: the deciding judge, and the counts."""

from __future__ import annotations

import pytest

from vcage.schema.base import Provenance
from vcage.schema.episodes import BY_HAND, CriticCounts, Truth, Verdict, Verdicts, accepts


def verdict(accepted: bool, provider: str = "offline") -> Verdict:
    return Verdict(accepted=accepted, reason="it looks so", confidence=0.9, provider=provider)


def judged(accept: str, *said: Verdict) -> Verdicts:
    none = CriticCounts.of([])
    return Verdicts(
        provenance=Provenance(producer="test", seed=0),
        accept=accept,
        episodes={"episodes/episode_000000.hdf5": list(said)},
        critic=none,
        earlier_critic=none,
        not_kept=0,
        differences=[],
    )


@pytest.mark.parametrize(
    ("accept", "critic", "state", "accepted"),
    [
        ("both", True, True, True),
        ("both", True, False, False),
        ("both", False, True, False),
        ("critic", True, False, True),
        ("critic", False, True, False),
        ("state", False, True, True),
        ("state", True, False, False),
    ],
)
def test_a_sub_task_needs_the_yes_of_the_deciding_judges(accept, critic, state, accepted):
    assert accepts(accept, verdict(critic), Truth(success=state, reason="it is so")) is accepted


@pytest.mark.parametrize("accept", ["both", "critic"])
def test_a_critic_that_looks_again_refuses_an_episode(accept):
    assert list(judged(accept, verdict(True), verdict(False)).refused.values()) == ["it looks so"]


def test_no_critic_refuses_an_episode_that_the_state_accepted():
    assert judged("state", verdict(False)).refused == {}


def test_a_hand_refuses_any_episode():
    assert judged("state", verdict(False, BY_HAND)).refused != {}
