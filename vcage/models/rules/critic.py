"""The critic that needs no model: compares pictures, with the assets' own renders as reference."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial

import numpy as np

from vcage.base.errors import InputFileError
from vcage.base.geometry import Camera, Pose
from vcage.models.protocols import CriticQuestion, DrawObject
from vcage.models.rules import PROVIDER
from vcage.models.rules.change import Change, displaced, grown
from vcage.models.rules.drawings import drawn_whole
from vcage.models.rules.evidence import CHANGED, salience
from vcage.models.rules.evidence_of_parts import DrawPart, gather_part
from vcage.models.rules.evidence_of_places import (
    Moved,
    gather_handed,
    gather_moved,
    gather_restless,
    gather_returned,
)
from vcage.models.rules.evidence_of_placing import AROUND, gather_placed
from vcage.models.rules.evidence_of_scans import gather_shown
from vcage.models.rules.standing import Sought, Standing
from vcage.models.rules.verdicts import (
    UNLIKE,
    decide_handed,
    decide_moved,
    decide_others,
    decide_part,
    decide_placed,
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
from vcage.vision.colour import distance, smoothed
from vcage.vision.protocols import Reference, View

NUDGED = 0.035
"""What was moved less than this, metres, counts as left where it was; the state calls it disturbed from 5 cm on."""

VANISHED = 0.45
"""Share of what was seen of a thing that must show the bare table for it to have been moved."""

FEWEST_SEEN = 25
"""So many pixels of a thing must have been seen to tell that it is gone."""

PUT_BACK = 12.0
"""So near to where it was what was held up is put back, pixels."""


class OfflineCritic:
    """Implements :class:`vcage.models.protocols.Critic` for every goal that there is.

    It sees pictures, the cameras' calibration and references, and nothing of the simulator's state.
    """

    provider = PROVIDER

    def judge(self, question: CriticQuestion) -> Verdict:
        """The verdict on all goals: accepted when each is, and nothing else was moved. The reason is that of the surest
        refusal, else of the least sure yes.

        Raises:
            InputFileError: a picture or a reference that the question needs is missing.
        """
        if not question.goals:
            raise InputFileError("the critic was asked about no goal", hint="give the sub-task's goals")
        moved = cache(lambda name: gather_moved(question.before, question.after, _sought(question, name)))
        told = [self._judge(question, goal, moved) for goal in question.goals]
        failed = [verdict for verdict, _ in told if not verdict.accepted]
        if failed:
            return max(failed, key=lambda v: v.confidence)
        before, after = _top(question.before), _top(question.after)
        explained = np.any([mask for _, mask in told], axis=0)
        apart = (before.camera.pose.p[2] - question.table_height) / before.camera.focal  # metres of table per pixel
        stood = [salience(view.picture, question.background) > 0.5 for view in (before, after)]
        pixels = displaced(Change.between(before, after), explained, *stood, far=NUDGED / apart)
        other = decide_others(pixels * apart**2, self._vanished(question, explained))
        return other if not other.accepted else min((verdict for verdict, _ in told), key=lambda v: v.confidence)

    def _vanished(self, question: CriticQuestion, explained: np.ndarray) -> list[str]:
        """What no goal is about and no longer stands where the layout put it, in words."""
        if question.background is None:
            return []
        before, after = _top(question.before), _top(question.after)
        was, now, bare = (smoothed(picture) for picture in (before.picture, after.picture, question.background))
        stood = (distance(was, bare) > CHANGED) & ~explained
        empty = stood & (distance(now, bare) < distance(now, was))
        about = {name for goal in question.goals for name in (goal.subject, goal.reference)} | {question.grasped}
        about -= _to_stay(question)
        found = []
        for name in question.planned.keys() - about:
            thing = _sought(question, name)
            here = stood & drawn_whole(thing.draw, question.planned[name], before.camera).covered
            if here.sum() < FEWEST_SEEN or empty[here].mean() <= VANISHED:
                continue
            still = thing.where_planned(question.after)
            stays = still is not None and not thing.gone(still, after) and still.unlike < UNLIKE
            if not stays or np.linalg.norm(still.pose.p - question.planned[name].p) > NUDGED:
                found.append(thing.look.phrase)
        return sorted(found)

    def _judge(self, question: CriticQuestion, goal: Goal, moved: Callable[[str], Moved]) -> _Told:
        """Judge one goal; ``moved`` tells where an object was and is, and remembers it for further goals."""
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
        return self._judge_moved(question, goal, moved(goal.subject))

    def _judge_part(self, question: CriticQuestion, goal: Goal) -> _Told:
        before, after, moment = _top(question.before), _top(question.after), question.moment.get("top")
        if question.draw is None or question.background is None:
            raise InputFileError(
                f"whether the {part_words(str(goal.part))} of {goal.subject!r} moved is told beside the empty table",
                hint="give pictures that lie in episodes/critic, as collect keeps them",
            )
        draw, look = question.draw, question.looks[goal.subject]
        part, start = str(goal.part), float(goal.relation == "closed")
        stands = {**dict.fromkeys(question.opened.get(goal.subject, ()), 1.0), part: start}

        def with_part(name: str) -> DrawPart:
            return lambda pose, camera, window, share: draw(goal.subject, pose, camera, window, {**stands, name: share})

        evidence = gather_part(
            before,
            after,
            replace(_sought(question, goal.subject), look=look, draw=partial(_drawn, draw, goal.subject, stands)),
            start,
            with_part(part),
            [with_part(name) for name in question.parts.get(goal.subject, ()) if name != part],
            question.background,
            moment=moment,
        )
        if evidence is None:
            return refuse(f"the {look.phrase} is not found", 0.5), _nowhere(question)
        return decide_part(evidence, goal, look.phrase), grown(evidence.covered, AROUND)

    def _judge_place(self, question: CriticQuestion, goal: Goal) -> _Told:
        thing, place = _sought(question, goal.subject), _sought(question, goal.reference or "", question.tops)
        if goal not in question.rooms:
            raise InputFileError(f"nothing says where in or on {goal.reference!r} {goal.subject!r} may be")
        others = [
            (_sought(question, name).draw, pose)
            for name, pose in question.planned.items()
            if name not in (goal.subject, goal.reference)
        ]
        evidence = gather_placed(question.before, question.after, thing, place, question.rooms[goal], UNLIKE, others)
        verdict = decide_placed(evidence, goal, thing.look.phrase, place.look.phrase)
        return verdict, _nowhere(question) if evidence is None else evidence.explained

    def _judge_weighed(self, question: CriticQuestion, goal: Goal) -> _Told:
        on = next((g for g in question.goals if g.subject == goal.subject and g.relation == "on"), None)
        thing, moment = _look(question, goal.subject).phrase, question.moment.get("top")
        if on is None or moment is None:
            return refuse(f"nothing shows the {thing} lying on a scale", 0.5), _nowhere(question)
        restless = gather_restless(_top(question.before), moment, _top(question.after))
        lies, explained = self._judge_place(question, on)
        return decide_weighed(lies, restless, thing), explained

    def _judge_moved(self, question: CriticQuestion, goal: Goal, moved: Moved) -> _Told:
        """Of what stands on the table: anywhere, beside another, or shown to the customer."""
        look = _look(question, goal.subject)
        explained = _around(question, moved.old, moved.new)
        if goal.relation == "presented":
            return decide_presented(moved, question.towards_customer, look.phrase), explained
        if goal.reference == TABLE:
            return decide_moved(moved, look.phrase), explained
        other = _sought(question, str(goal.reference))
        told = decide_relation(moved, other.found(question.after), goal, look.phrase, other.look.phrase)
        return told, explained

    def _judge_returned(self, question: CriticQuestion, goal: Goal) -> _Told:
        thing = _sought(question, goal.subject)
        if "top" not in question.start:
            return _unseen(question, f"where the {thing.look.phrase} stood at the start")
        evidence = gather_returned(question.start, question.before, question.after, thing)
        places = () if evidence is None else (evidence.stood, evidence.was)
        return decide_returned(evidence, thing.look.phrase), _around(question, *places)

    def _judge_handed(self, question: CriticQuestion, goal: Goal) -> _Told:
        thing = _sought(question, goal.subject)
        if "top" not in question.moment:
            return _unseen(question, f"the moment at which the {thing.look.phrase} changes hands")
        evidence = gather_handed(question.before, question.moment, question.after, thing)
        places = () if evidence is None else (evidence.old, evidence.new)
        return decide_handed(evidence, thing.look.phrase), _around(question, *places)

    def _judge_scan(self, question: CriticQuestion, goal: Goal) -> _Told:
        """Of the scanner held before the thing, or the thing before the scanner."""
        phrase = _look(question, goal.subject).phrase
        if question.readings is None or "top" not in question.moment:
            return _unseen(question, f"the moment at which the {phrase} is read")
        moved = question.grasped or goal.subject
        others = [goal.subject] if moved in question.readers else question.readers
        told = [self._judge_shown(question, moved, still) for still in others]
        none = refuse("there is no scanner", 1.0), _nowhere(question)
        return max(told, key=lambda one: (one[0].accepted, one[0].confidence), default=none)

    def _judge_shown(self, question: CriticQuestion, moved: str, still: str) -> _Told:
        one, other = (_sought(question, name, question.tops) for name in (moved, still))
        held, stands = one.found(question.before), other.found(question.before)
        if held is None or stands is None:
            return refuse(f"the {(one if held is None else other).look.phrase} is not found", 0.5), _nowhere(question)
        evidence = gather_shown(
            question.before,
            question.moment,
            held,
            stands,
            one.draw,
            other.draw,
            lambda at, there: question.readings(moved, at, still, there),  # pyrefly: ignore
        )
        return decide_scan(evidence, one.look.phrase, other.look.phrase), grown(held.covered, PUT_BACK)


_Told = tuple[Verdict, np.ndarray]
"""A verdict, and (H, W) bool where the view from above changes when what is asked for is done."""


def _nowhere(question: CriticQuestion) -> np.ndarray:
    return np.zeros(_top(question.before).picture.shape[:2], bool)


def _unseen(question: CriticQuestion, what: str) -> _Told:
    """A no for want of a picture."""
    return refuse(f"no picture shows {what}", 0.5), _nowhere(question)


def _around(question: CriticQuestion, *standing: Standing | None) -> np.ndarray:
    """Where some things stand, and a little around them."""
    masks = [one.covered for one in standing if one is not None]
    return grown(np.any(masks, axis=0), AROUND) if masks else _nowhere(question)


def _top(views: Mapping[str, View]) -> View:
    if "top" not in views:
        raise InputFileError("the critic needs a 'top' view before and after", hint="render the top camera")
    return views["top"]


def _look(question: CriticQuestion, name: str) -> Reference:
    if name not in question.references:
        raise InputFileError(f"no reference picture of {name!r}", hint="render one for each object of the scene")
    return question.references[name]


def _sought(question: CriticQuestion, name: str, tops: Sequence[float] = ()) -> Sought:
    """An object with its parts as they are by the plan, standing on the table or on something as high as ``tops``."""
    if question.draw is None:
        raise InputFileError(f"nothing draws {name!r}", hint="give the run's scene, as collect and verify do")
    shares = dict.fromkeys(question.opened.get(name, ()), 1.0)
    draw = partial(_drawn, question.draw, name, shares)
    planned = question.planned.get(name)
    return Sought(_look(question, name), draw, question.background, question.table_height, tops, planned)


def _drawn(
    draw: DrawObject, name: str, shares: Mapping[str, float], pose: Pose, camera: Camera, window: Window
) -> Drawing:
    return draw(name, pose, camera, window, shares)


def _to_stay(question: CriticQuestion) -> set[str]:
    """Objects that are said to be unmoved and that no goal moves, a receptacle too."""
    moved = {*(goal.subject for goal in question.goals), question.grasped}
    return {s.subject for s in question.statements if s.word == "unmoved"} - moved
