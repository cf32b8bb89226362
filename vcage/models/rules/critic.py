"""The critic that needs no model: compares pictures, with the assets' own renders as reference."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from vcage.base.errors import InputFileError
from vcage.base.geometry import Camera, Pose
from vcage.models.protocols import CriticQuestion, DrawObject
from vcage.models.rules import PROVIDER
from vcage.models.rules.evidence import gather
from vcage.models.rules.evidence_of_parts import gather_part
from vcage.models.rules.evidence_of_places import (
    gather_handed,
    gather_moved,
    gather_restless,
    gather_returned,
    gather_shown,
)
from vcage.models.rules.standing import Draw, find_standing
from vcage.models.rules.verdicts import (
    decide,
    decide_handed,
    decide_moved,
    decide_part,
    decide_presented,
    decide_relation,
    decide_returned,
    decide_scan,
    decide_weighed,
    refuse,
)
from vcage.schema.episodes import Verdict
from vcage.schema.goals import OF_A_PART, Goal, part_words
from vcage.schema.plan import TABLE
from vcage.sim.drawer import Drawing, Window
from vcage.vision.protocols import Reference, View


class OfflineCritic:
    """Implements :class:`vcage.models.protocols.Critic` for every goal that there is.

    It sees pictures, the cameras' calibration and references, and nothing of the simulator's state.
    """

    provider = PROVIDER

    def judge(self, question: CriticQuestion) -> Verdict:
        """The verdict on all goals: accepted when each is; the reason is that of the least certain one.

        Raises:
            InputFileError: a picture or a reference that the question needs is missing.
        """
        verdicts = [self._judge(question, goal) for goal in question.goals]
        failed = [verdict for verdict in verdicts if not verdict.accepted]
        if not verdicts:
            raise InputFileError("the critic was asked about no goal", hint="give the sub-task's goals")
        return max(failed, key=lambda v: v.confidence) if failed else min(verdicts, key=lambda v: v.confidence)

    def _judge(self, question: CriticQuestion, goal: Goal) -> Verdict:
        if goal.relation in OF_A_PART:
            return self._judge_part(question, goal)
        if goal.relation == "weighed":
            return self._judge_weighed(question, goal)
        if goal.relation == "scanned":
            return self._judge_scan(question, goal)
        if goal.relation == "handed":
            return self._judge_handed(question, goal)
        if goal.relation == "back":
            return self._judge_returned(question, goal)
        if goal.relation in ("inside", "on") and goal.reference != TABLE:
            return self._judge_place(question, goal)
        return self._judge_moved(question, goal)

    def _judge_part(self, question: CriticQuestion, goal: Goal) -> Verdict:
        before, after, moment = _top(question.before), _top(question.after), question.moment.get("top")
        if question.draw is None or question.background is None:
            raise InputFileError(
                f"whether the {part_words(str(goal.part))} of {goal.subject!r} moved is told beside the empty table",
                hint="give pictures that lie in episodes/critic, as collect keeps them",
            )
        was, draw = question.looks[goal.subject], question.draw
        evidence = gather_part(
            before.picture,
            after.picture,
            before.camera,
            question.table_height,
            was,
            lambda pose, camera, window, share: draw(goal.subject, pose, camera, window, {str(goal.part): share}),
            question.background,
            start=float(goal.relation == "closed"),
            moment=None if moment is None else moment.picture,
        )
        return decide_part(evidence, goal, was.phrase)

    def _judge_place(self, question: CriticQuestion, goal: Goal) -> Verdict:
        before, after = _top(question.before), _top(question.after)
        moved, place = _look(question, goal.subject), _look(question, goal.reference or "")
        evidence = gather(
            before.picture, after.picture, before.camera, question.table_height, moved, place, question.background
        )
        return decide(evidence, goal, moved.phrase, place.phrase)

    def _judge_weighed(self, question: CriticQuestion, goal: Goal) -> Verdict:
        on = next((g for g in question.goals if g.subject == goal.subject and g.relation == "on"), None)
        thing, moment = _look(question, goal.subject).phrase, question.moment.get("top")
        if on is None or moment is None:
            return refuse(f"nothing shows the {thing} lying on a scale", 0.5)
        restless = gather_restless(_top(question.before), moment, _top(question.after))
        return decide_weighed(self._judge_place(question, on), restless, thing)

    def _judge_moved(self, question: CriticQuestion, goal: Goal) -> Verdict:
        """Of what stands on the table: anywhere, beside another, or shown to the customer."""
        look, draw, height = _look(question, goal.subject), _draw(question, goal.subject), question.table_height
        moved = gather_moved(question.before, question.after, question.background, height, look, draw)
        if goal.relation == "presented":
            return decide_presented(moved, question.towards_customer, look.phrase)
        if goal.reference == TABLE:
            return decide_moved(moved, look.phrase)
        name = str(goal.reference)
        other = _look(question, name)
        stands = find_standing(question.after, question.background, height, other, _draw(question, name))
        return decide_relation(moved, stands, goal, look.phrase, other.phrase)

    def _judge_returned(self, question: CriticQuestion, goal: Goal) -> Verdict:
        look = _look(question, goal.subject)
        if "top" not in question.start:
            return refuse(f"no picture shows where the {look.phrase} stood at the start", 0.5)
        told = (question.background, question.table_height, look, _draw(question, goal.subject))
        return decide_returned(gather_returned(question.start, question.before, question.after, *told), look.phrase)

    def _judge_handed(self, question: CriticQuestion, goal: Goal) -> Verdict:
        look = _look(question, goal.subject)
        if "top" not in question.moment:
            return refuse(f"no picture shows the moment at which the {look.phrase} changes hands", 0.5)
        views = (question.before, question.moment, question.after)
        told = (question.background, question.table_height, look, _draw(question, goal.subject))
        return decide_handed(gather_handed(*views, *told), look.phrase)

    def _judge_scan(self, question: CriticQuestion, goal: Goal) -> Verdict:
        """Of the scanner held before the thing, or the thing before the scanner."""
        if question.readings is None or "top" not in question.moment:
            return refuse(
                f"no picture shows the moment at which the {_look(question, goal.subject).phrase} is read", 0.5
            )
        moved = question.grasped or goal.subject
        others = [goal.subject] if moved in question.readers else question.readers
        verdicts = [self._judge_shown(question, moved, still) for still in others]
        return max(verdicts, key=lambda v: (v.accepted, v.confidence), default=refuse("there is no scanner", 1.0))

    def _judge_shown(self, question: CriticQuestion, moved: str, still: str) -> Verdict:
        looks = _look(question, moved), _look(question, still)
        draws = _draw(question, moved), _draw(question, still)
        told = (question.before, question.background, question.table_height)
        held, stands = (
            find_standing(*told, look, draw, tops=question.tops) for look, draw in zip(looks, draws, strict=True)
        )
        if held is None or stands is None:
            return refuse(f"the {looks[held is not None].phrase} is not found", 0.5)
        evidence = gather_shown(
            question.before,
            question.moment,
            held,
            stands,
            *draws,
            lambda at, there: question.readings(moved, at, still, there),  # pyrefly: ignore
        )
        return decide_scan(evidence, looks[0].phrase, looks[1].phrase)


def _top(views: Mapping[str, View]) -> View:
    if "top" not in views:
        raise InputFileError("the critic needs a 'top' view before and after", hint="render the top camera")
    return views["top"]


def _look(question: CriticQuestion, name: str) -> Reference:
    if name not in question.references:
        raise InputFileError(f"no reference picture of {name!r}", hint="render one for each object of the scene")
    return question.references[name]


def _draw(question: CriticQuestion, name: str) -> Draw:
    """Draws an object with its parts at rest."""
    if question.draw is None:
        raise InputFileError(f"nothing draws {name!r}", hint="give the run's scene, as collect and verify do")
    return partial(_drawn, question.draw, name)


def _drawn(draw: DrawObject, name: str, pose: Pose, camera: Camera, window: Window) -> Drawing:
    return draw(name, pose, camera, window, {})
