"""A judgement of one goal: a verdict with one sentence of reason, and where it explains a change of the picture."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from vcage.models.rules import PROVIDER
from vcage.models.rules.critic_view import CriticView
from vcage.schema.episodes import Failure, Verdict
from vcage.schema.goals import Goal

LEFT_SHARE = 0.5
"""Share of the old outline of an object that was moved that must have changed."""

LOOKS_SHARE = 0.2
"""Share of what came to be seen somewhere that must have the object's colours: what leans shows other sides."""


class Judged(NamedTuple):
    """The outcome of a judgement.

    Args:
        verdict: on one goal.
        explained: (H, W) bool, where the view from above changes when it is done.
    """

    verdict: Verdict
    explained: np.ndarray


Judgement = Callable[[CriticView, Goal], Judged]
"""Measures in pictures whether a goal was brought about, and decides."""


def decided(accepted: bool | np.bool_, reason: str, confidence: float, failure: Failure | None = None) -> Verdict:
    """A yes, or a no because of ``failure``."""
    return Verdict(
        accepted=bool(accepted),
        reason=reason,
        confidence=min(1.0, max(0.0, confidence)),
        provider=PROVIDER,
        failure=None if accepted else failure,
    )


def refused(reason: str, confidence: float, failure: Failure | None = None) -> Verdict:
    """A no, with the failure if it is known."""
    return decided(False, reason, confidence, failure)


def unseen(view: CriticView, what: str) -> Judged:
    """A no for want of a picture."""
    return Judged(refused(f"no picture shows {what}", 0.5), view.nowhere)


def surest(judged: Iterable[Judged], none: Judged) -> Judged:
    """The surest of several verdicts, a yes before any no; ``none`` where there are none."""
    return max(judged, key=lambda one: (one.verdict.accepted, one.verdict.confidence), default=none)
