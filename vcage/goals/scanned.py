"""Scanned: a scanner read the bar code of an object."""

from __future__ import annotations

from vcage.goals.kind import GoalKind, Shown, State, Stated, cm, degrees, too_short
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def _meaning(limits: Thresholds) -> str:
    return f"""
    Scanned: a bar code of the thing was before the window of a scanner for {limits.scanned_s:g} s: at most
    {cm(limits.code_away_m)} away, at most {cm(limits.code_aside_m)} beside the window's axis, and facing the window to
    within {degrees(limits.code_slant_rad)}. `moment` shows it. It does not matter which of the two was moved, nor where
    it was put afterwards: neither counts as also moved.
    """


def _complaint(goal: Stated, state: State) -> str | None:
    return too_short(goal, state, THRESHOLDS.scanned_s)


def _happens(goal: Stated, state: State, notes: set[str]) -> bool:
    return state.is_read(goal.subject)


SCANNED = GoalKind(
    word="scanned",
    complaint=_complaint,
    evidence="scanned",
    meaning=_meaning,
    says="scan scanned scanner code",
    claims="scan scanned",
    plain="{thing} was scanned",
    commands="Scan {0}.|Scan the bar code of {0}.|Read the bar code of {0}.|Scan {0} with the scanner."
    "|Hold the scanner to the code of {0}.|Please scan {0}.|Could you scan {0}?|Have {0} scanned.|Get {0} scanned."
    "|Use the scanner on {0}.|{1} must be scanned.",
    event=True,
    happens=_happens,
    tool="reads_codes",
    shown=Shown(customer=True, moment=True, close_up=True),
)
