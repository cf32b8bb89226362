"""The critic that needs no model: compares two top views, with the assets' own renders as reference."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from vcage.base.errors import InputFileError
from vcage.models.protocols import CriticQuestion
from vcage.models.rules import PROVIDER
from vcage.models.rules.evidence import Evidence, gather
from vcage.models.rules.evidence_of_parts import PartEvidence, gather_part
from vcage.schema.episodes import Verdict
from vcage.schema.goals import OF_A_PART, Goal, part_words
from vcage.vision.protocols import View

LEFT = 0.5
"""Share of the old outline that must have changed."""

INSIDE = {"inside": 0.2, "on": 0.4}
"""Share of the object's area that must be seen in or on the receptacle; walls and other contents hide some."""

TOO_MUCH = 1.8
"""More new pixels than that, over the object's area, are of something larger."""

SEEN_OPEN, SEEN_CLOSED = 0.7, 0.15
"""Share of its range at which a part must seem to be at least, or at most, to count as open or turned, or as closed."""

FEWEST = 25
"""So many pixels must tell a part's positions apart."""

TOUCHED = 0.15
"""Share of an object that the hand covers while it presses a button of it."""

MAX_SHIFT = 0.06
"""A receptacle that moved farther was knocked away, metres."""

MAX_WORSE = 0.3
"""A receptacle whose rim fits its reference so much worse than before lies on its side."""


class OfflineCritic:
    """Implements :class:`vcage.models.protocols.Critic` for things put in or on others, and for moving parts.

    It sees pictures, the top camera's calibration and references, and nothing of the simulator's state.
    """

    provider = PROVIDER

    def judge(self, question: CriticQuestion) -> Verdict:
        """The verdict on all goals: accepted when each is; the reason is that of the least certain one.

        Raises:
            InputFileError: a picture or a reference that the question needs is missing.
        """
        verdicts = [
            self._judge_part(question, goal) if goal.relation in OF_A_PART else self._judge_goal(question, goal)
            for goal in question.goals
        ]
        failed = [verdict for verdict in verdicts if not verdict.accepted]
        if not verdicts:
            raise InputFileError("the critic was asked about no goal", hint="give the sub-task's goals")
        return max(failed, key=lambda v: v.confidence) if failed else min(verdicts, key=lambda v: v.confidence)

    def _judge_part(self, question: CriticQuestion, goal: Goal) -> Verdict:
        before, after, moment = _view(question.before), _view(question.after), question.moment.get("top")
        if question.draw is None or question.background is None:
            raise InputFileError(
                f"whether the {part_words(str(goal.part))} of {goal.subject!r} moved is told beside the empty table",
                hint="give pictures that lie in episodes/critic, as collect keeps them",
            )
        was = question.looks[goal.subject]
        evidence = gather_part(
            before.picture,
            after.picture,
            before.camera,
            question.table_height,
            was,
            partial(question.draw, goal),
            question.background,
            start=float(goal.relation == "closed"),
            moment=None if moment is None else moment.picture,
        )
        return decide_part(evidence, goal, was.phrase)

    def _judge_goal(self, question: CriticQuestion, goal: Goal) -> Verdict:
        for name in (goal.subject, goal.reference or ""):
            if name not in question.references:
                raise InputFileError(
                    f"no reference picture of {name!r}", hint="render one for each object of the scene"
                )
        before, after = _view(question.before), _view(question.after)
        moved, place = question.references[goal.subject], question.references[goal.reference or ""]
        evidence = gather(
            before.picture, after.picture, before.camera, question.table_height, moved, place, question.background
        )
        return decide(evidence, goal, moved.phrase, place.phrase)


def _view(views: Mapping[str, View]) -> View:
    if "top" not in views:
        raise InputFileError("the critic needs a 'top' view before and after", hint="render the top camera")
    return views["top"]


def decide_part(evidence: PartEvidence, goal: Goal, thing: str) -> Verdict:
    """Turn measurements of a moving part into a verdict with one sentence of reason."""
    part = part_words(str(goal.part))
    if goal.relation == "pressed":
        seen = f"{100 * evidence.touched:.0f} % of the {thing} is under the hand at the moment of the press"
        return _verdict(evidence.touched >= TOUCHED, seen, 0.5 + 0.5 * abs(evidence.touched - TOUCHED))
    if evidence.told_by < FEWEST:
        return _verdict(False, f"whether the {part} of the {thing} moved cannot be seen from above", 0.5)
    seen, limit = evidence.after, SEEN_CLOSED if goal.relation == "closed" else SEEN_OPEN
    accepted = seen <= limit if goal.relation == "closed" else seen >= limit
    looks = f"the {part} of the {thing} looks {100 * seen:.0f} % {'turned' if goal.relation == 'turned' else 'open'}"
    return _verdict(accepted, f"{looks}, {100 * evidence.before:.0f} % before", 0.5 + min(0.5, abs(seen - limit)))


def decide(evidence: Evidence, goal: Goal, thing: str, place: str) -> Verdict:
    """Turn measurements into a verdict with one sentence of reason."""
    needed = INSIDE["inside" if goal.relation == "inside" else "on"]
    word = "in" if goal.relation == "inside" else "on"
    seen = f"{100 * evidence.inside:.0f} % of it is seen {word} the {place}"
    if evidence.left < LEFT:
        return _verdict(False, f"the {thing} still lies where it was", 1 - evidence.left)
    if evidence.shifted > MAX_SHIFT or evidence.worse > MAX_WORSE:
        return _verdict(False, f"the {place} was knocked away or tipped over", 0.7)
    if evidence.outside > max(evidence.inside, 0.25):
        return _verdict(False, f"the {thing} lies outside the {place}: only {seen}", min(1.0, evidence.outside))
    if evidence.inside < needed:
        return _verdict(False, f"the {thing} left its place and is not found {word} the {place}: {seen}", 0.75)
    if evidence.inside > TOO_MUCH:
        return _verdict(False, f"something larger than the {thing} came to be {word} the {place}: {seen}", 0.6)
    return _verdict(True, f"the {thing} left its place, and {seen}", 0.5 + 0.5 * min(1.0, evidence.inside / 0.8))


def _verdict(accepted: bool, reason: str, confidence: float) -> Verdict:
    return Verdict(accepted=accepted, reason=reason, confidence=min(1.0, max(0.0, confidence)), provider=PROVIDER)
