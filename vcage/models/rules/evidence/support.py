"""Find a support in pictures after something was put on it, and its contents: either may hide the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.geometry import Pose
from vcage.models.rules.drawings import Draw, drawn_whole
from vcage.models.rules.pixels import PIXELS, Change, changed, grown
from vcage.models.rules.standing import SETTINGS as STANDING
from vcage.models.rules.standing import Sought, Standing
from vcage.vision.colour import distance, smoothed
from vcage.vision.protocols import View


@dataclass(frozen=True)
class SupportSettings:
    """Limits for seeing a support and its contents.

    Args:
        faint_lab: least colour distance of a change for an object with the colours of its support.
        border_px: width of the strip along a support's outline that shows whether it moved.
        border_changed: share of that strip from which on the support may have moved.
        bare_share: share of the support's outline that may come to show the empty table.
        fewest_px: visible pixels of an object needed to say anything about it.
        visible_share: share of a support's outline that must be visible beside its contents to judge by it alone.
        hidden_margin_px: margin around the contents of a support that hides it too.
        nudge_m, nudges: distance from its old place at which a nudged support is searched, and number of directions.
        still_m, still_deg: an apparent move and turn below these count as none.
        stays_share: share of a support's visible area before that must be visible at its new place.
        aloft_share: share of the side view's evidence for an object at the height of the top that must show it there.
        outline_share: share of an object's outline that must have changed, even faintly, for a clear place.
        shown_share, shown_share_changed: share of the distinguishing pixels that must look as drawn from above; the
            second if its outline changed.
    """

    faint_lab: float = 1.5
    border_px: int = 4
    border_changed: float = 0.5
    bare_share: float = 0.06
    fewest_px: int = 25
    visible_share: float = 0.15
    hidden_margin_px: int = 2
    nudge_m: float = 0.025
    nudges: int = 8
    still_m: float = 0.006
    still_deg: float = 6.0
    stays_share: float = 0.8
    aloft_share: float = 0.6
    outline_share: float = 0.8
    shown_share: float = 0.7
    shown_share_changed: float = 0.5


SETTINGS = SupportSettings()


@dataclass(frozen=True)
class Lying:
    """The place where an object would lie in or on its support, and what speaks for it.

    Args:
        standing: its likeliest pose there.
        shown: share of the pixels that distinguish it from the earlier picture and look as drawn from above.
        outline: share of its outline that changed, even faintly.
        aloft: the same share as ``shown`` in views from the side; None without evidence.
        hides: (H, W) bool by view, the area it hides there.
    """

    standing: Standing
    shown: float
    outline: float
    aloft: float | None
    hides: Mapping[str, np.ndarray]

    @property
    def seen(self) -> bool:
        """True when it is seen there: from the side if possible, else from above."""
        if self.aloft is not None:
            return self.aloft >= SETTINGS.aloft_share
        changed = self.outline >= SETTINGS.outline_share
        return self.shown >= (SETTINGS.shown_share_changed if changed else SETTINGS.shown_share)


def faintly_changed(before: View, after: View, here: np.ndarray, least: float) -> bool:
    """True when more than ``least`` pixels of a mask (H, W) changed, even faintly."""
    faint = changed(smoothed(before.picture), smoothed(after.picture), least=SETTINGS.faint_lab)
    return int((faint & here).sum()) > least


def find_lying(
    thing: Sought,
    rooms: np.ndarray,
    pose: Pose,
    before: Mapping[str, View],
    after: Mapping[str, View],
    room: np.ndarray,
    others: Sequence[tuple[Draw, Pose]] = (),
    within: Draw | None = None,
) -> Lying | None:
    """The likeliest place of an object in or on its support; None without room there.

    Args:
        thing: the object.
        rooms: (n, 8, 3) corners of where it may be, in the support's frame.
        pose: of the support.
        before, after: views of one moment each, by camera.
        room: (H, W) bool, the rooms in the view from above.
        others: the other planned objects there, which may hide the object from the side.
        within: the support's drawing where the object is in it: its wall hides the object from the side.
    """
    was, now = (smoothed(views["top"].picture) for views in (before, after))
    faint = changed(was, now, least=SETTINGS.faint_lab)
    floors: dict[float, Pose] = {}
    for corners in rooms:
        inside = pose.apply(corners)
        height = round(float(inside[:, 2].min()), 3)
        floors.setdefault(height, Pose.from_yaw([*inside.mean(axis=0)[:2], height], pose.yaw))
    found = [thing.lying(after, floor, faint & room) for floor in floors.values()]
    if not found:
        return None
    lies = min(found, key=lambda one: one.unlike)
    hides = {
        name: grown(drawn_whole(thing.draw, lies.pose, view.camera).covered, SETTINGS.hidden_margin_px)
        for name, view in after.items()
    }
    shown = thing.speaks(lies, after["top"], before["top"].picture)[0]
    outline = float(faint[lies.covered].mean()) if lies.covered.any() else 0.0
    walls = {} if within is None else {name: drawn_whole(within, pose, after[name].camera).covered for name in after}
    return Lying(lies, shown, outline, _aloft(thing, lies, before, after, others, walls), hides)


def _aloft(
    thing: Sought,
    lies: Standing,
    before: Mapping[str, View],
    after: Mapping[str, View],
    others: Sequence[tuple[Draw, Pose]],
    walls: Mapping[str, np.ndarray],
) -> float | None:
    """Share of the pixels that distinguish an object at a height and look as drawn in side views; None if too few.

    Pixels of the ``walls`` around it, (H, W) bool by view, do not count.
    """
    shares = []
    for name in sorted(before.keys() & after.keys() - {"top"}):
        hidden = _in_front(lies.pose, others, after[name]) | walls.get(name, False)
        shares.append(thing.speaks(lies, after[name], before[name].picture, hidden))
    pixels = sum(count for _, count in shares)
    return sum(share * count for share, count in shares) / pixels if pixels >= SETTINGS.fewest_px else None


def _in_front(pose: Pose, others: Sequence[tuple[Draw, Pose]], view: View) -> np.ndarray:
    """(H, W) bool: pixels of things nearer to a view's camera than a pose."""
    camera = view.camera
    away = np.linalg.norm(pose.p - camera.pose.p)
    nearer = [(draw, at) for draw, at in others if np.linalg.norm(at.p - camera.pose.p) < away]
    hidden = np.zeros(view.picture.shape[:2], bool)
    for draw, at in nearer:
        hidden |= drawn_whole(draw, at, camera).covered
    return hidden


@dataclass(frozen=True)
class Support:
    """A support afterwards.

    Args:
        now: its place; None where it is not found.
        seen: enough of it is seen from above, or its contents from the side at their height.
    """

    now: Standing | None
    seen: bool = True


def find_support(
    place: Sought,
    stands: Standing,
    lies: Lying | None,
    change: Change,
    before: Mapping[str, View],
    after: Mapping[str, View],
) -> Support:
    """Find a support afterwards: hidden parts cannot show that it moved.

    Args:
        place: the support.
        stands: where it stood.
        lies: what may hide it.
        change: between the views from above.
        before, after: views of one moment each, by camera.
    """
    if lies is not None and not lies.seen:
        lies = None
    hides = {} if lies is None else lies.hides
    hidden = hides.get("top", np.zeros_like(change.all))
    enough = _enough_visible(stands, hidden)
    if enough and stays(place, stands, change, before["top"], after["top"], hidden):
        return Support(stands)
    borne = lies is not None and lies.aloft is not None  # something bears the object there
    by_itself = enough or not borne
    best = place.near(_starts(stands, lies, around=by_itself), after, hides)
    least = SETTINGS.stays_share * _visible_part(place, stands, before["top"], hidden) if by_itself else 0.0
    there = best.unlike < STANDING.unlike_lab and _visible_part(place, best, after["top"], hidden) >= least
    now = _settled(best, stands) if there else _elsewhere(place, after["top"], change)
    return Support(now, enough or borne)


def _enough_visible(stands: Standing, hidden: np.ndarray) -> bool:
    """True when enough of a support is visible beside its contents to judge by that alone."""
    visible = int((stands.covered & ~hidden).sum())
    return visible >= SETTINGS.fewest_px and visible >= SETTINGS.visible_share * max(1, int(stands.covered.sum()))


def _elsewhere(place: Sought, top: View, change: Change) -> Standing | None:
    """Find a support among what changed in the view from above; None where it is not found."""
    now = place.standing({"top": top}, change.all)
    return now if now is not None and now.unlike < STANDING.unlike_lab and not place.gone(now, top) else None


def _starts(stands: Standing, lies: Lying | None, *, around: bool) -> list[Pose]:
    """Places to search for a support: its old one, under its contents, and nudged ``around``."""
    starts = [stands.pose]
    if lies is not None:
        under = lies.standing.pose.p
        starts.append(Pose([under[0], under[1], stands.pose.p[2]], stands.pose.q))
    if around:
        angles = np.linspace(0, 2 * np.pi, SETTINGS.nudges, endpoint=False)
        steps = SETTINGS.nudge_m * np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=-1)
        starts += [Pose(stands.pose.p + step, stands.pose.q) for step in steps]
    return starts


def _settled(found: Standing, stood: Standing) -> Standing:
    """The place where something stood, if it is found there as well as pictures tell; else where it is found."""
    turn = (found.pose.yaw - stood.pose.yaw + np.pi) % (2 * np.pi) - np.pi
    near = np.linalg.norm(found.pose.p - stood.pose.p) < SETTINGS.still_m
    return stood if near and abs(np.degrees(turn)) < SETTINGS.still_deg else found


def _visible_part(place: Sought, there: Standing, top: View, hidden: np.ndarray) -> float:
    """Visible share of a support in a view from above, of all that the view can show."""
    if place.background is None:
        return 1.0
    share, pixels = place.speaks(there, top, place.background, hidden)
    return share if pixels >= SETTINGS.fewest_px else 1.0


def stays(
    place: Sought, stands: Standing, change: Change, before: View, after: View, hidden: np.ndarray | None = None
) -> bool:
    """True when the view from above shows a support at its old place, except for hidden pixels (H, W)."""
    hidden = np.zeros_like(change.all) if hidden is None else hidden
    side = SETTINGS.border_px
    border = stands.covered & ~cv2.erode(stands.covered.astype(np.uint8), np.ones((side, side), np.uint8)).astype(bool)
    border &= ~hidden
    if border.any() and change.things[border].mean() > SETTINGS.border_changed:
        return False
    if not hidden.any() and place.gone(stands, after):
        return False
    return _bared(place, stands, before, after, hidden) <= SETTINGS.bare_share


def _bared(place: Sought, stands: Standing, before: View, after: View, hidden: np.ndarray) -> float:
    """Share of a support's earlier visible area that now shows the empty table."""
    if place.background is None or not stands.covered.any():
        return 0.0
    v, u = (slice(axis.min(), axis.max() + 1) for axis in np.nonzero(stands.covered))
    was, now, bare = (
        smoothed(np.ascontiguousarray(p[v, u])) for p in (before.picture, after.picture, place.background)
    )
    seen = (stands.covered & ~hidden)[v, u] & (distance(was, bare) > PIXELS.changed_lab)
    lost = seen & (distance(now, bare) < distance(now, was)) & (distance(was, now) > PIXELS.changed_lab)
    return float(lost.sum()) / max(1, int(seen.sum()))


def redrawn(before: View, background: np.ndarray | None, stands: Standing, now: Standing) -> View:
    """A view from above with a support at its present place, and all else unchanged.

    Args:
        before: the view.
        background: (H, W, 3) the empty table.
        stands, now: the support before and after.
    """
    if background is None:
        return before
    x, y, z = stands.size
    top = np.array([[sx * x / 2, sy * y / 2, z] for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    was, goes = (before.camera.project(one.pose.apply(top)).astype(np.float32) for one in (stands, now))
    camera = before.camera
    moved = cv2.warpPerspective(before.picture, cv2.getPerspectiveTransform(was, goes), (camera.width, camera.height))
    bare = grown(stands.covered, SETTINGS.hidden_margin_px)[..., None]
    picture = np.where(now.covered[..., None], moved, np.where(bare, background, before.picture))
    return View(picture.astype(np.uint8), camera)
