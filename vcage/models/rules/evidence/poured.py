"""Evidence of pouring: the vessel away from its place at the moment, and back and empty afterwards; all of the balls
that lay in it seen in the container."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.evidence.in_use import Found
from vcage.models.rules.evidence.judgement import LEFT_SHARE, Judged, decided, refused, unseen
from vcage.models.rules.pixels import changed_between, looks_like
from vcage.models.rules.standing import SETTINGS as STANDING
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.vision.colour import smoothed
from vcage.vision.protocols import Reference, View


@dataclass(frozen=True)
class PouredSettings:
    """When a disc of pixels is a ball.

    Args:
        disc_share: share of its disc that must have the colours of a ball.
    """

    disc_share: float = 0.72


SETTINGS = PouredSettings()


@dataclass(frozen=True)
class Poured:
    """Measurements of pouring.

    Args:
        left: changed share of the vessel's old outline at the moment; all of it where the bare table is seen there.
        stands: the vessel is seen upright afterwards.
        there, still: balls seen in the container, and in the vessel, afterwards.
        of: balls that lay in the vessel.
    """

    left: float
    stands: bool
    there: int
    still: int
    of: int

    def verdict(self, vessel: str, target: str) -> Verdict:
        """Judge if all was poured out of the vessel into the target."""
        if self.left < LEFT_SHARE:
            return refused(f"the {vessel} stands where it was when it should be tipped", 1 - self.left, "lost")
        if self.still:
            return refused(f"{self.still} of {self.of} balls are still seen in the {vessel}", 0.8, "lost")
        if not self.stands:
            return refused(f"the {vessel} is not seen to stand upright afterwards", 0.7, "lost")
        seen = f"{min(self.there, self.of)} of the {self.of} balls that lay in the {vessel} are seen in the {target}"
        return decided(self.there >= self.of, seen, 0.8, "astray")


def judge_poured(view: CriticView, goal: Goal) -> Judged:
    """Judge whether all that lay in a vessel is seen in another object, and not in the vessel any more."""
    vessel, target = goal.subject, str(goal.reference)
    balls = view.question.contents.get(vessel, ())
    if "top" not in view.moment or not balls:
        return unseen(view, f"what lies in the {view.phrase(vessel)}")
    found = Found.of(view, vessel, target)
    if isinstance(found, Judged):
        return found
    now = found.moved.found({"top": view.after["top"]})
    explained = view.around(found.held, found.stands, now)
    after, change = view.after["top"], view.change.all
    tipped = changed_between(view.before["top"], view.moment["top"])
    left = found.moved.left(found.held, tipped, view.moment["top"])
    looks = [view.look(name) for name in balls]
    measured = Poured(
        left=left,
        stands=now is not None and now.unlike <= STANDING.unlike_lab,
        there=seen_balls(looks, after, view.question.table_height, found.stands.covered & change),
        still=seen_balls(looks, after, view.question.table_height, found.held.covered if now is None else now.covered),
        of=len(balls),
    )
    return Judged(measured.verdict(found.moved.look.phrase, found.still.look.phrase), explained)


def seen_balls(looks: Sequence[Reference], view: View, height: float, among: np.ndarray) -> int:
    """Number of balls that a view shows among some pixels, at most as many of each look as there are.

    Args:
        looks: of each of the balls.
        view: from above, that may show them.
        height: z of what they lie on, metres.
        among: (H, W) bool.
    """
    lab, count = smoothed(view.picture), 0
    for phrase, number in Counter(look.phrase for look in looks).items():
        look = next(one for one in looks if one.phrase == phrase)
        mask = np.zeros(among.shape, np.float32)
        mask[among] = looks_like(look, lab[among])
        away = view.camera.pose.p[2] - height - look.size[2] / 2
        count += min(number, discs(mask, view.camera.focal * max(look.size) / 2 / away))
    return count


def discs(mask: np.ndarray, radius: float) -> int:
    """Number of discs of a radius, pixels, that fit in a mask (H, W) of 0 and 1, one beside the other."""
    side, count = int(np.ceil(radius)), 0
    x, y = np.mgrid[-side : side + 1, -side : side + 1]
    disc = (np.hypot(x, y) <= radius).astype(np.float32)
    left = mask.copy()
    while True:
        share = cv2.filter2D(left, -1, disc / disc.sum(), borderType=cv2.BORDER_CONSTANT)
        row, column = np.unravel_index(share.argmax(), share.shape)
        if share[row, column] < SETTINGS.disc_share:
            return count
        cv2.circle(left, (int(column), int(row)), round(radius), (0.0,), thickness=-1)
        count += 1
