"""Evidence of a scan: an object that is held before a scanner, or a scanner before an object."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.drawings import Draw, as_bright, cut, drawn_whole, inside, refined, window_around
from vcage.models.rules.evidence.judgement import LEFT_SHARE, Judged, decided, refused, unseen
from vcage.models.rules.pixels import changed_between, grown, share_of
from vcage.models.rules.standing import Standing
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.vision.colour import distance, smoothed, to_lab
from vcage.vision.protocols import View


@dataclass(frozen=True)
class ScanSettings:
    """The search for an object that is held, and limits for a yes.

    Args:
        alike_lab: colour distance below which a pixel is like the drawing of an object.
        away_m, directions, headings: distances, directions and headings of alternatives at which no code is read
            and the object may be seen instead.
        hidden_weight: weight against a drawing of a pixel that shows something else, such as the hand.
        in_front_m: an object nearer to the camera by less than this hides nothing.
        held_share: share of its drawing that must be found at the moment; the hand hides some.
        put_back_px: a held object this near to its old place was put back.
    """

    alike_lab: float = 14.0
    away_m: tuple[float, ...] = (0.1, 0.16)
    directions: int = 8
    headings: int = 4
    hidden_weight: float = 0.4
    in_front_m: float = 0.005
    held_share: float = 0.55
    put_back_px: float = 12.0


SETTINGS = ScanSettings()


@dataclass(frozen=True)
class Shown:
    """Measurements of a scan.

    Args:
        left: changed share of the moved object's old outline at the moment, in the view with the least change: a hand
            before it hides it from one side.
        seen: share of the evidence for a drawing of it in reading position at the moment.
        elsewhere: the same at the likeliest alternative, too far away or turned so that nothing is read.
    """

    left: float
    seen: float
    elsewhere: float

    @classmethod
    def gather(cls, view: CriticView, moved: str, still: str, held: Standing, stands: Standing) -> Shown:
        """Measure if one object is held before another so that a code is read.

        Args:
            view: of the question.
            moved, still: ids of the two.
            held, stands: where they stood before.
        """
        before, moment = view.before, view.moment
        draw, draw_still = (view.sought(name, upon=True).draw for name in (moved, still))
        cameras = sorted(before.keys() & moment.keys())
        sights = [_Held.of(before[name], moment[name], stands, draw_still) for name in cameras]
        left = min(share_of(sight.change, drawn_whole(draw, held.pose, sight.camera).covered) for sight in sights)
        if left < LEFT_SHARE or view.question.readings is None:
            return cls(left, 0.0, 0.0)

        def hidden(pose: Pose) -> float:
            return 1 - _visible_share(pose, held, sights, draw)

        found = [(hidden(pose), pose) for pose in view.question.readings(moved, held.pose, still, stands.pose)]
        least, pose = min(found, key=lambda one: one[0], default=(1.0, held.pose))
        nearby, _ = refined(np.zeros(3), least, lambda shift: hidden(_shifted(pose, shift)))
        turned = [_shifted(pose, np.array([0.0, 0.0, turn])) for turn in _TURNS[1:]]
        others = [*turned, *(_shifted(pose, np.array([*away, turn])) for away in _AWAY for turn in _TURNS)]
        return cls(left, 1 - nearby, 1 - min(map(hidden, others)))

    def verdict(self, moved: str, still: str) -> Verdict:
        """Judge if one object was held before the other so that a code was read."""
        if self.left < LEFT_SHARE:
            return refused(f"the {moved} lies where it was at the moment of the scan", 1 - self.left, "lost")
        seen = f"{100 * self.seen:.0f} % of the {moved} is seen before the {still} at the moment of the scan"
        accepted, sure = self.seen >= max(SETTINGS.held_share, self.elsewhere), abs(self.seen - SETTINGS.held_share)
        return decided(accepted, f"{seen}, {100 * self.elsewhere:.0f} % farther away", 0.5 + sure)


def judge_scanned(view: CriticView, goal: Goal) -> Judged:
    """Judge whether a scanner was held before the object, or the object before a scanner."""
    question = view.question
    if question.readings is None or "top" not in view.moment:
        return unseen(view, f"the moment at which the {view.phrase(goal.subject)} is read")
    moved = question.grasped or goal.subject
    others = [goal.subject] if moved in question.readers else question.readers
    judged = [_judged(view, moved, still) for still in others]
    none = Judged(refused("there is no scanner", 1.0), view.nowhere)
    return max(judged, key=lambda one: (one.verdict.accepted, one.verdict.confidence), default=none)


def _judged(view: CriticView, moved: str, still: str) -> Judged:
    one, other = (view.sought(name, upon=True) for name in (moved, still))
    held, stands = one.found(view.before), other.found(view.before)
    if held is None or stands is None:
        missing = (one if held is None else other).look.phrase
        return Judged(refused(f"the {missing} is not found", 0.5), view.nowhere)
    verdict = Shown.gather(view, moved, still, held, stands).verdict(one.look.phrase, other.look.phrase)
    return Judged(verdict, grown(held.covered, SETTINGS.put_back_px))


_TURNS = np.linspace(0, 2 * np.pi, SETTINGS.headings, endpoint=False)
_AWAY = [
    (far * np.cos(angle), far * np.sin(angle))
    for far in SETTINGS.away_m
    for angle in np.linspace(0, 2 * np.pi, SETTINGS.directions, endpoint=False)
]


@dataclass(frozen=True)
class _Held:
    """A view of the moment, and what hides things in it.

    Args:
        camera: took it.
        picture: (H, W, 3) uint8.
        lab: (H, W, 3) the same, smoothed.
        change: (H, W) bool, since before.
        nearest: (H, W) float32, depth of the object that stays, where it is.
    """

    camera: Camera
    picture: np.ndarray
    lab: np.ndarray
    change: np.ndarray
    nearest: np.ndarray

    @classmethod
    def of(cls, before: View, moment: View, still: Standing, draw: Draw) -> _Held:
        lab = smoothed(moment.picture)
        return cls(
            moment.camera, moment.picture, lab, changed_between(before, moment), _depth(draw, still.pose, moment.camera)
        )


def _depth(draw: Draw, pose: Pose, camera: Camera) -> np.ndarray:
    """(H, W) distance of an object's pixels along a camera's axis, metres; inf elsewhere."""
    drawing = drawn_whole(draw, pose, camera)
    return np.where(drawing.covered, drawing.depth, np.inf).astype(np.float32)


def _shifted(pose: Pose, shift: np.ndarray) -> Pose:
    """A pose moved along x and y and turned upright by (3,)."""
    return Pose(pose.p + [shift[0], shift[1], 0.0], (Pose.from_yaw([0, 0, 0], float(shift[2])) * Pose(q=pose.q)).q)


def _visible_share(pose: Pose, moved: Standing, sights: Sequence[_Held], draw: Draw) -> float:
    """Share of the evidence for the drawing of an object at a pose: pixels that have come to look like
    it, beside those still as before; hidden pixels tell little."""
    found, against, drawn = 0, 0, 0
    for sight in sights:
        middle = pose.p + np.array([0.0, 0.0, moved.size[2] / 2])
        window = window_around(middle, moved.size, sight.camera)
        drawing = draw(pose, sight.camera, window)
        shown = (
            drawing.covered
            & inside(sight.picture, window)
            & (cut(sight.nearest, window) > drawing.depth - SETTINGS.in_front_m)
        )
        if not shown.any():
            continue
        like = to_lab(as_bright(drawing, cut(sight.picture, window)).astype(np.uint8))
        alike = distance(cut(sight.lab, window), like) < SETTINGS.alike_lab
        change = cut(sight.change, window)
        found += int((shown & alike & change).sum())
        against += int((shown & ~change).sum())
        drawn += int(shown.sum())
    return found / (found + against + SETTINGS.hidden_weight * (drawn - found - against)) if found else 0.0
