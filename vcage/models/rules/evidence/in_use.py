"""An object in a hand at the moment, before or over another one that stays: how much of a drawing of it is seen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.goals.thresholds import THRESHOLDS
from vcage.models.rules.critic_view import VIEW, CriticView
from vcage.models.rules.drawings import Draw, as_bright, brightness, cut, drawn_whole, inside, refined, window_around
from vcage.models.rules.evidence.judgement import Judged, refused
from vcage.models.rules.pixels import changed_between, grown, share_of
from vcage.models.rules.standing import SETTINGS as STANDING
from vcage.models.rules.standing import Sought, Standing
from vcage.schema.episodes import Verdict
from vcage.vision.colour import distance, smoothed, to_lab
from vcage.vision.protocols import View


@dataclass(frozen=True)
class InUseSettings:
    """When a pixel shows a held object.

    Args:
        alike_lab: colour distance below which a pixel is like the drawing of an object.
        hidden_weight: weight against a drawing of a pixel that shows something else, such as the hand.
        in_front_m: an object nearer to the camera by less than this hides nothing.
        put_back_px: a held object this near to its old place was put back.
        seen_m: a place is seen with this error.
        changed_share: share of the outline of an object that changes where that is moved.
    """

    alike_lab: float = 14.0
    hidden_weight: float = 0.4
    in_front_m: float = 0.005
    put_back_px: float = 12.0
    seen_m: float = 0.01
    changed_share: float = 0.15


SETTINGS = InUseSettings()


@dataclass(frozen=True)
class Found:
    """The object in a hand at the moment, and the one that stays, as both were found before.

    Args:
        moved, still: the two.
        held, stands: where they stood.
    """

    moved: Sought
    still: Sought
    held: Standing
    stands: Standing

    @classmethod
    def of(cls, view: CriticView, moved: str, still: str) -> Found | Judged:
        """Find two objects by their ids; the verdict where one is not found."""
        one, other = (view.sought(name, upon=True) for name in (moved, still))
        held, stands = one.found(view.before), other.found(view.before)
        if held is None or stands is None:
            missing = (one if held is None else other).look.phrase
            return Judged(refused(f"the {missing} is not found", 0.5), view.nowhere)
        return cls(one, other, held, stands)

    @property
    def explained(self) -> np.ndarray:
        """(H, W) bool, pixels of the picture from above whose change the use explains: those of the old place."""
        return grown(self.held.covered, SETTINGS.put_back_px)

    def judged(self, view: CriticView, verdict: Verdict, pose: Pose) -> Judged:
        """A verdict on the moved object, seen at a pose; a refusal where a yes meets a disturbed object that stays."""
        if verdict.accepted and (disturbed := self.disturbed(view, THRESHOLDS.disturbed_m)) is not None:
            return disturbed
        there = grown(drawn_whole(self.moved.draw, pose, view.camera).covered, VIEW.around_px)
        return Judged(verdict, self.explained | there | view.around(self.stands))  # its shadow falls there

    def disturbed(self, view: CriticView, most_m: float) -> Judged | None:
        """The verdict where what stays is seen farther than some metres from where it stood; None elsewhere."""
        away = seen_away(view, self.still, self.stands, most_m)
        if away is None:
            return None
        why = f"the {self.still.look.phrase} is {away} where it stood before"
        return Judged(refused(why, 0.8, "disturbed"), self.explained)


class InUse:
    """The views of the moment, of an object that may have left its place.

    Args:
        view: of the question.
        moved, still: ids of the object in a hand, and of the one that stays.
        held, stands: where they stood before.
        at: views of the time that is looked at; of the moment when not given.
        as_before: True for a held object as bright as it was where it stood. A small one, drawn where the hand hides
            it, would else be taken to be as bright as the hand.
    """

    def __init__(
        self,
        view: CriticView,
        moved: str,
        still: str,
        held: Standing,
        stands: Standing,
        *,
        at: Mapping[str, View] | None = None,
        as_before: bool = False,
    ):
        before, moment = view.before, view.moment if at is None else at
        self._held, self._draw = held, view.sought(moved, upon=True).draw
        draw_still = view.sought(still, upon=True).draw
        cameras = sorted(before.keys() & moment.keys())
        self._sights = [_Sight.of(before[name], moment[name], stands, draw_still) for name in cameras]
        self._bright = [self._brightness(before[name]) for name in cameras] if as_before else None

    @property
    def left(self) -> float:
        """Changed share of its old outline, in the view with the least change: a hand before it hides it from one
        side."""
        outlines = (drawn_whole(self._draw, self._held.pose, sight.camera).covered for sight in self._sights)
        return min(share_of(sight.change, outline) for sight, outline in zip(self._sights, outlines, strict=True))

    def _brightness(self, before: View) -> np.ndarray:
        """(3,) of the object where it stood, as a share of that of its drawing."""
        window = window_around(self._held.pose.p, self._held.size, before.camera)
        return brightness(self._draw(self._held.pose, before.camera, window), cut(before.picture, window))

    def unseen(self, pose: Pose) -> float:
        """Share of the evidence that is against the object at a pose: pixels still as before, beside those that have
        come to look like it; hidden pixels tell little."""
        found, against, drawn = 0, 0, 0
        for number, sight in enumerate(self._sights):
            middle = pose.p + np.array([0.0, 0.0, self._held.size[2] / 2])
            window = window_around(middle, self._held.size, sight.camera)
            drawing = self._draw(pose, sight.camera, window)
            shown = (
                drawing.covered
                & inside(sight.picture, window)
                & (cut(sight.nearest, window) > drawing.depth - SETTINGS.in_front_m)
            )
            if not shown.any():
                continue
            if self._bright is None:
                lit = as_bright(drawing, cut(sight.picture, window))
            else:
                lit = np.clip(drawing.picture * self._bright[number], 0, 255)
            like = to_lab(lit.astype(np.uint8))
            alike = distance(cut(sight.lab, window), like) < SETTINGS.alike_lab
            change = cut(sight.change, window)
            found += int((shown & alike & change).sum())
            against += int((shown & ~change).sum())
            drawn += int(shown.sum())
        rest = SETTINGS.hidden_weight * (drawn - found - against)
        return 1 - found / (found + against + rest) if found else 1.0


@dataclass(frozen=True)
class _Sight:
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
    def of(cls, before: View, moment: View, still: Standing, draw: Draw) -> _Sight:
        lab = smoothed(moment.picture)
        return cls(
            moment.camera, moment.picture, lab, changed_between(before, moment), _depth(draw, still.pose, moment.camera)
        )


def least_unseen(use: InUse, poses: Sequence[Pose]) -> tuple[float, Pose]:
    """The least evidence against an object near the likeliest of some poses, and that pose."""
    least, pose = min(((use.unseen(pose), pose) for pose in poses), key=lambda one: one[0])
    return refined(np.zeros(3), least, lambda shift: use.unseen(shifted(pose, shift)))[0], pose


def seen_away(view: CriticView, thing: Sought, stands: Standing, most_m: float) -> str | None:
    """How an object is seen not to stand where it stood, to within some metres; None where nothing changed there, or it
    is found there."""
    if share_of(view.change.all, stands.covered) < SETTINGS.changed_share:
        return None
    now = thing.found(view.after)
    if now is None or now.unlike > STANDING.unlike_lab:
        return "not found"
    moved = float(np.linalg.norm(now.pose.p - stands.pose.p))
    return f"seen {100 * moved:.0f} cm from" if moved > most_m + SETTINGS.seen_m else None


def _depth(draw: Draw, pose: Pose, camera: Camera) -> np.ndarray:
    """(H, W) distance of an object's pixels along a camera's axis, metres; inf elsewhere."""
    drawing = drawn_whole(draw, pose, camera)
    return np.where(drawing.covered, drawing.depth, np.inf).astype(np.float32)


def shifted(pose: Pose, shift: Sequence[float] | np.ndarray) -> Pose:
    """A pose moved along x and y and turned upright by (3,)."""
    return Pose(pose.p + [shift[0], shift[1], 0.0], (Pose.from_yaw([0, 0, 0], float(shift[2])) * Pose(q=pose.q)).q)
