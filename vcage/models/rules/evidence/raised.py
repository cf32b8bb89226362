"""Evidence of an object that one arm lifted, or tilted in the air: drawings of it above its old place, from the side.

Seen from above, an arm hides what it holds, and hides what still lies below it. The customer sees the object before
the arm, and its old place empty below it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import cv2
import numpy as np

from vcage.base.geometry import Pose
from vcage.goals.thresholds import THRESHOLDS
from vcage.models.rules.critic_view import VIEW, CriticView
from vcage.models.rules.drawings import as_bright, drawn_whole
from vcage.models.rules.evidence.handed import REACH, arms_out
from vcage.models.rules.evidence.judgement import LEFT_SHARE, Judged, Judgement, decided, refused, unseen
from vcage.models.rules.evidence.moved import Moved
from vcage.models.rules.evidence.vacated import SETTINGS as VACATED
from vcage.models.rules.evidence.vacated import vacated
from vcage.models.rules.pixels import grown
from vcage.models.rules.standing import Sought, Standing
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.sim.drawer import Drawing
from vcage.vision.colour import distance, smoothed
from vcage.vision.protocols import View


@dataclass(frozen=True)
class RaisedSettings:
    """Places in the air that are drawn, and limits for a yes.

    Args:
        highest_m, step_m: heights over the old place, from the least of the goal up.
        highest_with_both_m: the same of what both arms lift: higher up their joints may look like it.
        leans_rad: angles about the axis towards the customer.
        seen_share, alike_lab: share of the pixels that tell the object from what was there before that must look like
            it, and the colour distance up to which they do: an arm is before what was there, too.
        leaning_seen_share: the same share where it may lean, as the drawings that are looked for do not.
        with_both_share: the same of what both arms lift: their hands over its old place may look like it, by 62 % on a
            silver pot; such a pot and rolling pins in the air have 68 to 95 %.
        near_m: heights of leaning drawings around that of the likeliest upright one.
        cap_lab: colour distance (CIELAB) that counts at most of a pixel.
        joined_px: parts of an arm that are seen this far apart are joined.
        leaning_share: by which the likeliest leaning drawing must be more like the picture than the likeliest upright
            one, of what a drawing gains on a picture without the object.
    """

    highest_m: float = 0.4
    highest_with_both_m: float = 0.14
    step_m: float = 0.01
    leans_rad: tuple[float, ...] = tuple(np.radians([-25.0, -18.0, 18.0, 25.0]))
    seen_share: float = 0.5
    alike_lab: float = 14.0
    leaning_seen_share: float = 0.4
    with_both_share: float = 0.65
    near_m: float = 0.04
    cap_lab: float = 30.0
    joined_px: float = 20.0
    leaning_share: float = 0.1


SETTINGS = RaisedSettings()


@dataclass(frozen=True)
class Raised:
    """Measurements of an object at the moment, seen by the customer.

    Args:
        vacated: share of its old outline, where it is not in the air, that looks as it does afterwards, and not as
            before.
        seen: largest share of what tells it in the air that looks like it.
        leans: by how much better leaning drawings are than upright ones, as a share of what those gain.
        height: above its old place of the likeliest drawing, metres.
        old, new: where it stood and stands; None where it is not found.
    """

    vacated: float
    seen: float
    leans: float
    height: float
    old: Standing
    new: Standing | None

    @classmethod
    def gather(
        cls, view: CriticView, name: str, leans: bool, highest_m: float = SETTINGS.highest_m, alike_lab: float = np.inf
    ) -> Raised | None:
        """Measure an object above its old place; None where that is not found.

        Args:
            view, name: of the question, and of the object.
            leans: drawings lean too.
            highest_m: up to which it is looked for, metres.
            alike_lab: colour distance up to which a pixel looks like it.
        """
        moved = Moved.of(view, name)
        if moved.old is None:
            return None
        before, moment, thing = view.before["customer"], view.moment["customer"], view.sought(name)
        stood = moved.old.pose

        def seen(height: float) -> float:
            there = replace(moved.old, pose=_leaning(stood, height, 0.0, 0.0))  # pyrefly: ignore[bad-argument-type]
            share, pixels = thing.speaks(there, moment, before.picture, alike_lab=alike_lab)
            return share if pixels >= VACATED.fewest_px else 0.0  # out of the picture nothing tells it

        heights = np.arange(THRESHOLDS.lifted_m, highest_m, SETTINGS.step_m)
        share, height = max((seen(height), float(height)) for height in heights)
        poses = (stood, Pose(stood.p + [0.0, 0.0, height], stood.q))
        was, now = (drawn_whole(thing.draw, pose, before.camera).covered for pose in poses)
        left = vacated(before, moment, view.after["customer"], was & ~now) or 0.0
        gain = _leaning_gain(thing, moved.old, height, before, moment) if leans else 0.0
        return cls(left, share, gain, height, moved.old, moved.new)

    def verdict(self, thing: str, seen_share: float = SETTINGS.seen_share) -> Verdict:
        """Judge if the object was in the air.

        Args:
            thing: words for the object.
            seen_share: least share of the pixels that tell it that must look like it.
        """
        if self.vacated < LEFT_SHARE:
            return refused(f"the {thing} stands where it was at the moment of the lift", 1 - self.vacated, "lost")
        words = f"{100 * self.seen:.0f} % of the {thing} is seen {100 * self.height:.0f} cm above its place"
        sure = 0.5 + abs(self.seen - seen_share) / 2
        return decided(self.seen >= seen_share, words, sure, "lost")

    def leaning(self, thing: str) -> Verdict:
        """Judge if the object leaned in the air."""
        verdict = self.verdict(thing, SETTINGS.leaning_seen_share)
        if not verdict.accepted:
            return verdict
        leans = self.leans >= SETTINGS.leaning_share
        how = "tilted" if leans else "upright"
        words = f"the {thing} looks {how} in the air, by {100 * abs(self.leans):.0f} % of its looks"
        return decided(leans, words, 0.5 + min(0.5, abs(self.leans - SETTINGS.leaning_share)))


def _leaning_gain(thing: Sought, old: Standing, height: float, before: View, moment: View) -> float:
    """By how much more like the picture of the moment leaning drawings are than upright ones, as a share of what the
    better of them gain on the picture before."""
    seen, steps = smoothed(moment.picture), np.arange(-SETTINGS.near_m, SETTINGS.near_m + 1e-6, SETTINGS.step_m)

    def drawing(angle: float, up: float, aside: float) -> Drawing:
        pose = _leaning(old.pose, height + up, angle, old.size[2] / 2)
        return drawn_whole(thing.draw, Pose(pose.p + [aside, 0.0, 0.0], pose.q), before.camera)

    edges = product((0.0, *SETTINGS.leans_rad), steps[[0, -1]], steps[[0, -1]])
    where = np.any([drawing(*edge).covered for edge in edges], axis=0)

    def unlike(picture: np.ndarray) -> float:
        return float(np.minimum(distance(smoothed(picture)[where], seen[where]), SETTINGS.cap_lab).mean())

    def least(angle: float) -> float:
        def of(up: float, aside: float) -> float:
            one = drawing(angle, up, aside)
            lit = as_bright(one, moment.picture)
            return unlike(np.where(one.covered[..., None], lit, before.picture).astype(np.uint8))

        _, up = min((of(up, 0.0), up) for up in steps)
        return min(of(up, aside) for aside in steps)

    upright, leaning = least(0.0), min(map(least, SETTINGS.leans_rad))
    return (upright - leaning) / max(unlike(before.picture) - min(upright, leaning), 1e-6)


def _leaning(stood: Pose, height: float, angle: float, middle: float) -> Pose:
    """A pose above another, turned about the axis towards the customer through a point ``middle`` above its origin."""
    up, turn = Pose([0.0, 0.0, middle]), Pose(q=[np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0])
    return Pose(stood.p + [0.0, 0.0, height]) * up * turn * up.inverse() * Pose(q=stood.q)


def in_the_air(
    leans: bool,
    highest_m: float = SETTINGS.highest_m,
    seen_share: float = SETTINGS.seen_share,
    alike_lab: float = SETTINGS.alike_lab,
) -> Judgement:
    """Judge if an object was in the air at the moment, and leaned there."""

    def judge(view: CriticView, goal: Goal) -> Judged:
        thing = view.phrase(goal.subject)
        if any("customer" not in one for one in (view.before, view.moment, view.after)):
            return unseen(view, f"the {thing} in the air from the customer's side")
        found = Raised.gather(view, goal.subject, leans, highest_m, np.inf if leans else alike_lab)
        if found is None:
            return Judged(refused(f"the {thing} is not found before", 0.6), view.nowhere)
        verdict = found.leaning(thing) if leans else found.verdict(thing, seen_share)
        return Judged(verdict, view.around(found.old, found.new))

    return judge


def judge_held_up(view: CriticView, goal: Goal) -> Judged:
    """Judge if an object is in the air in the end; the arm that still holds it explains what it hides. On a table of
    its colour it changes that as a shadow does."""
    return _held(view, goal, in_the_air(leans=False))


def _held(view: CriticView, goal: Goal, judge: Judgement) -> Judged:
    verdict, explained = judge(view, goal)
    return Judged(verdict, explained | _arm_seen(view))


def _arm_seen(view: CriticView) -> np.ndarray:
    """(H, W) bool, the changes that reach an edge of the picture, where no object stands, and what is around them; not
    where the table has come to be seen, which no arm hides."""
    _, labels = cv2.connectedComponents(grown(view.change.all, SETTINGS.joined_px).astype(np.uint8))
    edge = np.concatenate([labels[-1], labels[0], labels[:, 0], labels[:, -1]])  # an arm may leave the picture, too
    arm = np.isin(labels, np.setdiff1d(edge, 0))
    return grown(arm, VIEW.around_px) & ~(view.stood_before & ~view.stands_after)


def judge_held_by_both(view: CriticView, goal: Goal) -> Judged:
    """Judge if an object is level in the air in the end, with both arms out to it."""
    both = in_the_air(False, SETTINGS.highest_with_both_m, SETTINGS.with_both_share, np.inf)
    judged = _held(view, goal, both)
    if not judged.verdict.accepted:
        return judged
    arms = arms_out(view.before["customer"], view.after["customer"])
    changed = " and ".join(f"{100 * share:.0f} %" for share in arms)
    if min(arms) < REACH.reaches_share:
        return judged._replace(verdict=refused(f"not both arms reach out: {changed} of their sides changed", 0.8))
    reason = f"{judged.verdict.reason}, and both arms reach out: {changed} of their sides changed"
    return judged._replace(verdict=judged.verdict.model_copy(update={"reason": reason}))
