"""The critic that needs no model: compares pictures, with the assets' own renders as reference."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.errors import InputFileError
from vcage.models.protocols import CriticQuestion
from vcage.models.rules import PROVIDER
from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.drawings import drawn_whole
from vcage.models.rules.evidence import EVIDENCE
from vcage.models.rules.evidence.judgement import decided, refused
from vcage.models.rules.pixels import PIXELS, displaced
from vcage.models.rules.standing import SETTINGS as STANDING
from vcage.schema.episodes import Verdict
from vcage.vision.colour import distance, smoothed


@dataclass(frozen=True)
class OthersSettings:
    """Limits from which on another object counts as moved.

    Args:
        nudged_m: an object moved by less counts as left in place; the state calls it disturbed from 5 cm on.
        vanished_share: share of the object's visible area that must show the bare table for it to have been moved.
        fewest_px: visible pixels of an object needed to tell that it is gone.
        patch_m2: largest patch of the table that may change where nothing should.
    """

    nudged_m: float = 0.035
    vanished_share: float = 0.45
    fewest_px: int = 25
    patch_m2: float = 3e-4


SETTINGS = OthersSettings()


class OfflineCritic:
    """Implements :class:`vcage.models.protocols.Critic` for every kind of goal.

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
        view = CriticView(question)
        judged = [EVIDENCE[goal.kind.evidence](view, goal) for goal in question.goals]
        failed = [verdict for verdict, _ in judged if not verdict.accepted]
        if failed:
            return max(failed, key=lambda v: v.confidence)
        explained = np.any([mask for _, mask in judged], axis=0)
        far = SETTINGS.nudged_m / view.metres_per_pixel
        pixels = displaced(view.change, explained, view.stood_before, view.stands_after, far)
        others = judge_others(pixels * view.metres_per_pixel**2, sorted(_vanished(view, explained)))
        return others if not others.accepted else min((verdict for verdict, _ in judged), key=lambda v: v.confidence)


def judge_others(area_m2: float, vanished: Sequence[str]) -> Verdict:
    """Judge whether nothing else was moved.

    Args:
        area_m2: area of the largest patch of the table that changed outside the sub-task.
        vanished: objects that left their place, in words.
    """
    if vanished:
        return refused(f"no longer where it stood: the {' and the '.join(vanished)}", 0.8, "disturbed")
    seen = f"{1e4 * area_m2:.0f} cm² of the table changed where nothing should"
    sure = 0.5 + min(0.5, abs(area_m2 - SETTINGS.patch_m2) / SETTINGS.patch_m2 / 2)
    return decided(area_m2 <= SETTINGS.patch_m2, seen, sure, "disturbed")


def _vanished(view: CriticView, explained: np.ndarray) -> Iterator[str]:
    """Objects outside the goals that left their place in the layout, in words."""
    question = view.question
    if question.background is None:
        return
    pictures = (view.before["top"].picture, view.after["top"].picture, question.background)
    was, now, bare = (smoothed(picture) for picture in pictures)
    stood = (distance(was, bare) > PIXELS.changed_lab) & ~explained
    empty = stood & (distance(now, bare) < distance(now, was))
    about = {name for goal in question.goals for name in (goal.subject, goal.reference)} | {question.grasped}
    for name in question.planned.keys() - (about - _to_stay(question)):
        thing = view.sought(name)
        here = stood & drawn_whole(thing.draw, question.planned[name], view.camera).covered
        if here.sum() < SETTINGS.fewest_px or empty[here].mean() <= SETTINGS.vanished_share:
            continue
        still = thing.where_planned(view.after)
        stays = still is not None and not thing.gone(still, view.after["top"]) and still.unlike < STANDING.unlike_lab
        if not stays or np.linalg.norm(still.pose.p - question.planned[name].p) > SETTINGS.nudged_m:
            yield thing.look.phrase


def _to_stay(question: CriticQuestion) -> set[str]:
    """Objects declared unmoved and not moved by a goal, receptacles included."""
    moved = {*(goal.subject for goal in question.goals), question.grasped}
    return {s.subject for s in question.statements if s.word == "unmoved"} - moved
