"""Measurements of an object in the air: drawings of it above its old place, from the side and from above."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vcage.base.geometry import Camera, Pose, box_corners
from vcage.goals.thresholds import THRESHOLDS
from vcage.models.rules.critic_view import CriticView
from vcage.models.rules.drawings import as_bright, drawn_whole
from vcage.models.rules.evidence.fingers import fingers_touch
from vcage.models.rules.evidence.in_hand import in_hand
from vcage.models.rules.evidence.judgement import Judged, refused, unseen
from vcage.models.rules.evidence.moments import Moment, at_moment
from vcage.models.rules.evidence.moved import Moved
from vcage.models.rules.evidence.raised import Raised
from vcage.models.rules.evidence.vacated import SETTINGS as VACATED
from vcage.models.rules.evidence.vacated import vacated
from vcage.models.rules.pixels import changed_between, grown, share_of
from vcage.models.rules.standing import Sought, Standing
from vcage.schema.goals import Goal
from vcage.sim.drawer import Drawing
from vcage.vision.colour import distance, smoothed, to_lab
from vcage.vision.protocols import View


@dataclass(frozen=True)
class InTheAirSettings:
    """Places in the air that are drawn, and how they are compared with pictures.

    Args:
        highest_m, step_m: heights over the old place, from the least of the goal up.
        alike_lab: colour distance up to which a pixel looks like the object: an arm is before what was there, too.
        around_px, beside_px: margins around an object between which the colour behind it is taken.
        shown_share: share of the corners of an object's box that must be in the customer's picture, else that does not
            tell.
        apart_m: an object that is put down nearer to its old place is taken to stand there.
    """

    highest_m: float = 0.4
    step_m: float = 0.01
    alike_lab: float = 14.0
    around_px: float = 14.0
    beside_px: float = 4.0
    shown_share: float = 0.75
    apart_m: float = 0.03


SETTINGS = InTheAirSettings()


def in_the_air(
    view: CriticView,
    goal: Goal,
    moment: Moment | None,
    highest_m: float = SETTINGS.highest_m,
    alike_lab: float = SETTINGS.alike_lab,
) -> Raised | Judged:
    """Measure the subject of a goal in the air; a no where no picture shows that moment, or it is not found before.

    Args:
        view, goal: of the question.
        moment: when it is in the air.
        highest_m: up to which it is looked for above its old place, metres.
        alike_lab: colour distance up to which a pixel looks like it.
    """
    thing = view.phrase(goal.subject)
    if moment is None:
        return unseen(view, f"the {thing} in the air from the customer's side")
    found = _measure(view, goal.subject, moment, highest_m, alike_lab)
    return found or Judged(refused(f"the {thing} is not found before", 0.6), view.nowhere)


def judge_lifted(view: CriticView, goal: Goal) -> Judged:
    """Judge if an object was in the air at the moment."""
    found = in_the_air(view, goal, at_moment(view))
    if isinstance(found, Judged):
        return found
    return Judged(found.verdict(view.phrase(goal.subject)), view.around(found.old, found.new))


def _measure(view: CriticView, name: str, moment: Moment, highest_m: float, alike_lab: float) -> Raised | None:
    """Measure an object above its old place, see :func:`in_the_air`; None where that is not found."""
    moved = Moved.of(view, name)
    if moved.old is None:
        return None
    before, side, thing, stood = view.before["customer"], moment.views["customer"], view.sought(name), moved.old

    def raised(height: float) -> Standing:
        return replace(stood, pose=Pose(stood.pose.p + [0.0, 0.0, height], stood.pose.q))

    def seen(height: float) -> float:
        return _share(thing, raised(height), side, before.picture, alike_lab)

    heights = list(map(float, np.arange(THRESHOLDS.lifted_m, highest_m, SETTINGS.step_m)))
    share, height = max((seen(height), height) for height in heights)
    held = raised(height)
    drawn, raised_there = (drawn_whole(thing.draw, there.pose, before.camera) for there in (stood, held))
    where = drawn.covered & ~raised_there.covered
    background, top = view.question.background, moment.views["top"]
    return Raised(
        vacated=None if moment.is_end else vacated(before, side, view.after["customer"], where),
        changed=_changed(before, side, drawn, where),
        stays=None if background is None else _told(thing, stood, top, background),
        lies=_lies(view, thing, moved, moment, share),
        seen=share,
        height=height,
        is_shown=any(_is_shown(raised(height), side.camera) for height in heights),
        through=0.0 if background is None else _through(thing, held, top, background),
        hand=in_hand(view, name, moment.hand),
        fingers_touch=fingers_touch(view.question, moment.hand),
        old=stood,
        new=moved.new,
    )


def _changed(before: View, moment: View, drawn: Drawing, where: np.ndarray) -> float | None:
    """Share of what tells an object where it stood that has changed, see :class:`Raised`.

    Args:
        before, moment: views of one camera.
        drawn: the object where it stood.
        where: (H, W) bool, the part of that to compare.
    """
    around = grown(drawn.covered, SETTINGS.around_px) & ~grown(drawn.covered, SETTINGS.beside_px)
    if not around.any():
        return None
    seen, own = smoothed(before.picture), to_lab(as_bright(drawn, before.picture).astype(np.uint8))
    apart = distance(seen, np.broadcast_to(np.median(seen[around], axis=0), seen.shape)) > SETTINGS.alike_lab
    telling = where & apart & (distance(seen, own) < SETTINGS.alike_lab)
    if telling.sum() < max(VACATED.fewest_px, VACATED.telling_share * where.sum()):
        return None
    return share_of(changed_between(before, moment), telling)


def _is_shown(there: Standing, camera: Camera) -> bool:
    """True where a camera's picture shows most of an object's box."""
    return float(camera.sees(box_corners(*there.aabb)).mean()) >= SETTINGS.shown_share


def _share(
    thing: Sought, there: Standing, view: View, without: np.ndarray, alike_lab: float = SETTINGS.alike_lab
) -> float:
    """The same as :func:`_told`; 0 where too few tell, as out of the picture."""
    return _told(thing, there, view, without, alike_lab) or 0.0


def _told(
    thing: Sought, there: Standing, view: View, without: np.ndarray, alike_lab: float = SETTINGS.alike_lab
) -> float | None:
    """Share of the pixels that tell an object somewhere that look like it; None where too few tell."""
    share, pixels = thing.speaks(there, view, without, alike_lab=alike_lab)
    return share if pixels >= VACATED.fewest_px else None


def _through(thing: Sought, there: Standing, view: View, without: np.ndarray) -> float:
    """Share of the pixels that tell an object somewhere that look as without it; 0 where too few tell."""
    share, pixels = thing.seen_through(there, view, without, SETTINGS.alike_lab)
    return share if pixels >= VACATED.fewest_px else 0.0


def _lies(view: CriticView, thing: Sought, moved: Moved, moment: Moment, seen: float) -> float:
    """Share of what tells an object where it lies afterwards that looks like it at the moment, see :class:`Raised`.

    What is still in the air afterwards is seen before many a place, from above even before the one below it. There,
    the customer alone tells, and only what looks more like it than what is ``seen`` in the air.
    """
    new, old = moved.new, moved.old
    if new is None or old is None or np.linalg.norm(new.pose.p - old.pose.p) < SETTINGS.apart_m:
        return 0.0
    shares = {name: _share(thing, new, moment.views[name], view.before[name].picture) for name in ("customer", "top")}
    if moment.is_end:
        return shares["customer"] if shares["customer"] > seen else 0.0
    return max(shares.values())
