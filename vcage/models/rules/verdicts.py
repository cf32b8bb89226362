"""Measurements from pictures become verdicts, each with one sentence of reason."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vcage.models.rules import PROVIDER
from vcage.models.rules.evidence import LEFT
from vcage.models.rules.evidence_of_parts import POSITIONS, PartEvidence
from vcage.models.rules.evidence_of_places import Handed, Moved, Returned
from vcage.models.rules.evidence_of_placing import Placed
from vcage.models.rules.evidence_of_scans import Shown
from vcage.models.rules.evidence_of_support import SETTINGS
from vcage.models.rules.standing import Standing
from vcage.plans.relations import holds
from vcage.schema.episodes import Failure, Verdict
from vcage.schema.goals import Goal, part_words

INSIDE = {"inside": 0.2, "on": 0.4}
"""Share of the object's area that must be seen in or on the receptacle; walls and other contents hide some."""

MOSTLY = 0.6
"""Share of what looks like an object around its receptacle that must be seen where it should be."""

NEARLY_ALL, WELL_IN = 0.9, 0.025
"""That share of what has its middle nearer to the edge than this, metres: it may well balance there."""

STIRRED_PLACE = 0.27
"""A receptacle of which more than this share changed, and shows no more of the object, was knocked over."""

SEEN_OPEN, SEEN_CLOSED = 0.7, 0.15
"""Share of its range at which a part must seem to be at least, or at most, to count as open or turned, or as closed."""

STIRRED = 0.2
"""Share of its range by which a part must be seen to have moved."""

TOLD = 0.08
"""Share of the range of costs by which the positions that a goal allows must beat all others."""

FEWEST = 25
"""So many pixels must tell a part's positions apart."""

TOUCHED = 0.15
"""Share of what is seen of a button that the hand covers while it presses it."""

MAX_SHIFT = 0.05
"""A receptacle that moved farther was knocked away, metres."""

OTHERS = 3e-4
"""Largest patch that may change where nothing should, square metres."""

LOOKS = 0.2
"""Share of what came to be seen somewhere that must have the object's colours: what leans shows other sides."""

UNLIKE = 14.0
"""Mean colour distance between what stands somewhere and drawings of an object from which on it is another."""

BARE = 0.8
"""Share of the outline of what stands on the table that must have been empty table before."""

FACING = np.radians(40)
"""Largest angle between where a front is seen to face and the customer."""

BACK_AGAIN = 0.6
"""Share of its outline at the start that must look so again, of what was put back."""

NEAR_ENOUGH = 0.02
"""What is seen no farther from where it stood is back there, metres."""

HELD = 0.55
"""Share of the drawing of what is held before another that must be found at the moment; the hand hides some."""

REACHING = 0.09
"""Share of one half of the robot's edge of the picture that an arm which reaches out changes."""

STILL = 0.25
"""Share of the outline of what lies on a scale that may change while it is weighed."""

BESIDE = 0.2
"""Share of an object's area that must be seen beside a receptacle for it to have been brought there."""


def decide_part(evidence: PartEvidence, goal: Goal, thing: str) -> Verdict:
    """Turn measurements of a moving part into a verdict with one sentence of reason."""
    part = part_words(str(goal.part))
    if goal.relation == "pressed":
        seen = (
            f"{100 * evidence.touched:.0f} % of the {part} of the {thing} is under the hand at the moment of the press"
        )
        return _verdict(evidence.touched >= TOUCHED, seen, 0.5 + 0.5 * abs(evidence.touched - TOUCHED))
    if evidence.told_by < FEWEST:
        return refuse(f"whether the {part} of the {thing} moved cannot be seen from above", 0.5)
    if abs(evidence.after - evidence.before) < STIRRED:
        return refuse(f"the {part} of the {thing} stays {100 * evidence.before:.0f} % of its way from rest", 0.8)
    seen, limit = evidence.after, SEEN_CLOSED if goal.relation == "closed" else SEEN_OPEN
    accepted = seen <= limit if goal.relation == "closed" else seen >= limit
    looks = f"the {part} of the {thing} looks {100 * seen:.0f} % {'turned' if goal.relation == 'turned' else 'open'}"
    if accepted and evidence.rival <= 0:
        return refuse(f"it looks as if another part of the {thing} moved, not its {part}", 0.7)
    if accepted and _margin(evidence.costs, goal) < TOLD:
        return refuse(f"{looks}, but nearly as much as if it were not", 0.5)
    return _verdict(accepted, f"{looks}, {100 * evidence.before:.0f} % before", 0.5 + min(0.5, abs(seen - limit)))


def _margin(costs: np.ndarray, goal: Goal) -> float:
    """By how much the best of the positions that a goal allows beats the best of all others, over the costs' range."""
    meant = POSITIONS <= SEEN_CLOSED if goal.relation == "closed" else POSITIONS >= SEEN_OPEN
    return float((costs[~meant].min() - costs[meant].min()) / max(np.ptp(costs), 1e-6))


def decide_placed(evidence: Placed | None, goal: Goal, thing: str, place: str) -> Verdict:
    """Whether an object came to be in or on another."""
    word = "in" if goal.relation == "inside" else "on"
    if evidence is None:
        return refuse(f"the {thing} or the {place} is not found before", 0.5)
    seen = f"{100 * min(1.0, evidence.inside):.0f} % of it is seen {word} the {place}"
    if evidence.left < LEFT:
        return refuse(f"the {thing} still lies where it was", 1 - evidence.left, "lost")
    if evidence.shifted > MAX_SHIFT or evidence.stirred > STIRRED_PLACE:
        return refuse(f"the {place} was moved away or tipped over", 0.8, "astray")
    if evidence.inside < INSIDE[goal.relation]:
        failure: Failure = "astray" if evidence.beside >= BESIDE else "lost"
        return refuse(f"the {thing} left its place and is not found {word} the {place}: {seen}", 0.8, failure)
    if evidence.aloft is not None and evidence.aloft < SETTINGS.aloft_share:
        seen = f"{100 * evidence.aloft:.0f} % of it is seen there from the side"
        return refuse(f"the {thing} does not lie as high as {word} the {place}: {seen}", 0.8, "astray")
    if evidence.alike < LOOKS or not evidence.plain:
        return refuse(f"what came to be {word} the {place} does not look like the {thing}", 0.7)
    if not evidence.support_seen:
        return refuse(f"whether the {place} is under the {thing}, which hides it, cannot be told from above", 0.5)
    balances = evidence.margin <= (WELL_IN if evidence.aloft is None else 0.0)
    if evidence.share < (NEARLY_ALL if balances else MOSTLY):
        return refuse(
            f"the {thing} lies across the edge of the {place}: {100 * evidence.share:.0f} % {word} it", 0.7, "astray"
        )
    return _verdict(True, f"the {thing} left its place, and {seen}", 0.5 + 0.5 * min(1.0, evidence.inside / 0.8))


def decide_others(area: float, vanished: Sequence[str]) -> Verdict:
    """Whether nothing else was moved.

    Args:
        area: of the largest patch that changed where nothing should, square metres on the table.
        vanished: what is no longer where it was, in words.
    """
    if vanished:
        return refuse(f"no longer where it stood: the {' and the '.join(vanished)}", 0.8, "disturbed")
    seen = f"{1e4 * area:.0f} cm² of the table changed where nothing should"
    return _verdict(area <= OTHERS, seen, 0.5 + min(0.5, abs(area - OTHERS) / OTHERS / 2), "disturbed")


def decide_moved(evidence: Moved, thing: str) -> Verdict:
    """Whether an object left its place and stands on the bare table."""
    if evidence.old is None or evidence.left < LEFT:
        return refuse(f"the {thing} still lies where it was", 1 - evidence.left, "lost")
    if evidence.new is None or evidence.alike < LOOKS:
        return refuse(f"the {thing} left its place and is not found on the table", 0.7, "lost")
    seen = f"{100 * evidence.bare:.0f} % of where it is now was empty table"
    return _verdict(
        evidence.bare >= BARE, f"the {thing} left its place, and {seen}", 0.5 + abs(evidence.bare - BARE), "astray"
    )


def decide_relation(evidence: Moved, reference: Standing | None, goal: Goal, thing: str, other: str) -> Verdict:
    """Whether an object that was moved stands as it should beside another."""
    moved = decide_moved(evidence, thing)
    if not moved.accepted:
        return moved
    word = goal.relation.replace("_", " ")
    if reference is None or reference.unlike > UNLIKE:
        return refuse(f"the {other} is not found, so that nothing is told to be {word} it", 0.6)
    there = holds(goal.relation, evidence.new.aabb, reference.aabb)  # pyrefly: ignore
    return _verdict(
        there, f"the {thing} left its place and is {'' if there else 'not '}seen {word} the {other}", 0.8, "astray"
    )


def decide_presented(evidence: Moved, towards: Sequence[float], thing: str) -> Verdict:
    """Whether an object that was moved shows its front to the customer, on the customer's half of the table.

    Args:
        towards: (3,) from the middle of the table to the customer.
    """
    moved = decide_moved(evidence, thing)
    if not moved.accepted:
        return moved
    stands = evidence.new.pose  # pyrefly: ignore
    angle = float(np.arccos(np.clip(-stands.rotation()[:, 1] @ towards, -1, 1)))
    seen = f"the front of the {thing} is seen {np.degrees(angle):.0f}° from the customer"
    if stands.p @ towards < 0:
        return refuse(f"the {thing} is not on the customer's half of the table", 0.8, "astray")
    return _verdict(angle <= FACING, seen, 0.5 + min(0.5, abs(angle - FACING)), "astray")


def decide_returned(evidence: Returned | None, thing: str) -> Verdict:
    """Whether an object is again where it stood."""
    if evidence is None:
        return refuse(f"where the {thing} stood at the start is not found", 0.6)
    if evidence.came < LEFT:
        return refuse(f"nothing came back to where the {thing} stood", 1 - evidence.came, "lost")
    seen = f"{100 * evidence.same:.0f} % of where the {thing} stood looks as at the start"
    if evidence.off <= NEAR_ENOUGH:  # its label may be turned away
        return _verdict(True, f"the {thing} is seen {100 * evidence.off:.0f} cm from where it stood, and {seen}", 0.8)
    return _verdict(evidence.same >= BACK_AGAIN, seen, 0.5 + abs(evidence.same - BACK_AGAIN))


def decide_scan(evidence: Shown, moved: str, still: str) -> Verdict:
    """Whether one object was held before another so that a code was read."""
    if evidence.left < LEFT:
        return refuse(f"the {moved} lies where it was at the moment of the scan", 1 - evidence.left, "lost")
    seen = f"{100 * evidence.seen:.0f} % of the {moved} is seen before the {still} at the moment of the scan"
    accepted = evidence.seen >= max(HELD, evidence.elsewhere)
    return _verdict(accepted, f"{seen}, {100 * evidence.elsewhere:.0f} % farther away", 0.5 + abs(evidence.seen - HELD))


def decide_handed(evidence: Handed | None, thing: str) -> Verdict:
    """Whether an object was in the air, and both arms out, at the moment of a hand-over."""
    if evidence is None:
        return refuse(f"the {thing} is not found before and after", 0.6)
    if evidence.left < LEFT:
        return refuse(f"the {thing} lies where it was at the moment of the hand-over", 1 - evidence.left, "lost")
    if evidence.to_come < LEFT:
        return refuse(f"the {thing} was put down before the moment of the hand-over", 1 - evidence.to_come)
    seen = " and ".join(f"{100 * share:.0f} %" for share in evidence.arms)
    least = min(evidence.arms)
    if least < REACHING:
        return refuse(f"not both arms reach out at the moment of the hand-over: {seen} of their sides changed", 0.8)
    return _verdict(True, f"the {thing} is in the air while both arms reach out: {seen} of their sides changed", 0.7)


def decide_weighed(on_scale: Verdict, change: float, thing: str) -> Verdict:
    """Whether what came to lie on a scale lay there still."""
    if not on_scale.accepted:
        return on_scale
    seen = f"{100 * change:.0f} % of the {thing} changed while it was weighed"
    return _verdict(change <= STILL, seen, 0.5 + abs(change - STILL))


def refuse(reason: str, confidence: float, failure: Failure | None = None) -> Verdict:
    """A no, and what went wrong where that can be told."""
    return _verdict(False, reason, confidence, failure)


def _verdict(accepted: bool | np.bool_, reason: str, confidence: float, failure: Failure | None = None) -> Verdict:
    """A yes, or a no because of ``failure``."""
    return Verdict(
        accepted=bool(accepted),
        reason=reason,
        confidence=min(1.0, max(0.0, confidence)),
        provider=PROVIDER,
        failure=None if accepted else failure,
    )
