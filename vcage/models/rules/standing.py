"""Find an object in pictures from above, and tell its sides apart by drawing it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.models.rules.drawings import (
    Draw,
    Sight,
    as_bright,
    cut,
    drawn_whole,
    inside,
    refined,
    unlikeness,
    window_around,
)
from vcage.models.rules.pixels import PIXELS, middles, places, salience
from vcage.vision.colour import LabImage, distance, smoothed, to_lab
from vcage.vision.detector import MIN_AREA, components
from vcage.vision.object_templates import template_from_reference
from vcage.vision.protocols import Reference, View


@dataclass(frozen=True)
class StandingSettings:
    """Places to search for an object, and limits for finding it there.

    Args:
        flips_deg: alternative headings: a plain box looks the same from several sides.
        rounds, rounds_near: refinements of a pose; and of a nearly right one.
        candidates, refined: number of drawn places, and of refined poses.
        headings_deg: further headings tried at an occupied place where nothing fits at first.
        near_px: search radius around occupied or changed places.
        taken_share: share of a place taken by another object, above which this one is not there.
        clearly_lab: margin by which another place must match better than the planned one.
        surely_lab: an object this similar at its place is not searched elsewhere.
        gone_share: share of what tells an object from the bare table below which it is not there; more of it may lie in
            shadow.
        apart_m: poses closer than this are at one place.
        unlike_lab: mean colour distance to drawings of an object from which on the thing there is another.
    """

    flips_deg: tuple[float, ...] = (0.0, 90.0, 180.0, 270.0)
    rounds: int = 5
    rounds_near: int = 3
    candidates: int = 3
    refined: int = 2
    headings_deg: tuple[float, ...] = (0.0, 30.0, 60.0)
    near_px: int = 12
    taken_share: float = 0.5
    clearly_lab: float = 3.0
    surely_lab: float = 9.0
    gone_share: float = 0.2
    apart_m: float = 0.02
    unlike_lab: float = 14.0


SETTINGS = StandingSettings()

_NOTHING: Mapping[str, np.ndarray] = {}


@dataclass(frozen=True)
class Standing:
    """The place where an object is seen to stand.

    Args:
        pose: of the object in the world.
        size: (3,) its bounding box, metres.
        unlike: mean colour distance between the pictures and drawings of it there, capped for each pixel.
        covered: (H, W) bool, where it is in the view from above.
    """

    pose: Pose
    size: tuple[float, float, float]
    unlike: float
    covered: np.ndarray

    @cached_property
    def aabb(self) -> np.ndarray:
        """(2, 3) axis-aligned box in the world, metres."""
        c, s = abs(np.cos(self.pose.yaw)), abs(np.sin(self.pose.yaw))
        half = np.array([c * self.size[0] + s * self.size[1], s * self.size[0] + c * self.size[1]]) / 2
        x, y, z = self.pose.p
        return np.array([[x - half[0], y - half[1], z], [x + half[0], y + half[1], z + self.size[2]]])


@dataclass(frozen=True)
class Sought:
    """An object that is looked for in pictures of a table.

    Args:
        look: how it looks from above.
        draw: draws it.
        background: the top view of the empty table.
        table_height: metres.
        tops: z of its possible supports besides the table, metres.
        planned: its place in the layout, which is searched too.
        rivals: others that it may be taken for.
        taken: (H, W) bool in the top view, where another is known to stand.
    """

    look: Reference
    draw: Draw
    background: np.ndarray | None
    table_height: float
    tops: Sequence[float] = ()
    planned: Pose | None = None
    rivals: Sequence[Sought] = ()
    taken: np.ndarray | None = None

    def standing(self, views: Mapping[str, View], among: np.ndarray | None = None) -> Standing | None:
        """Find the object; None where nothing stands that it could be.

        Args:
            views: of the same moment; the ``top`` one finds it, all tell its sides apart.
            among: (H, W) bool, where it may be in the top view; anywhere when not given.
        """
        top = views["top"]
        image = LabImage.of(top.picture, salience(top.picture, self.background))
        taken = self._taken(views)
        there = (image.salience > 0.5) & ~taken
        patches = components(there if among is None else there & among, MIN_AREA * there.size)
        if not patches:
            return None
        outline = None if among is None else np.any(patches, axis=0)
        stands = [self._on(height, views, image, patches, outline) for height in (self.table_height, *self.tops)]
        seen = (one for one in stands if one is not None)
        free = (one for one in seen if taken[one.covered].sum() <= SETTINGS.taken_share * one.covered.sum())
        return min(free, key=lambda found: found.unlike, default=None)

    def _taken(self, views: Mapping[str, View]) -> np.ndarray:
        """(H, W) bool: where others stand in the top view: rivals as planned, and more like themselves than like it."""
        taken = np.zeros(views["top"].picture.shape[:2], bool) if self.taken is None else self.taken.copy()
        for rival in self.rivals:
            stands = rival.where_planned(views)
            if stands is not None and stands.unlike < min(SETTINGS.surely_lab, self.near([stands.pose], views).unlike):
                taken |= stands.covered
        return taken

    def _on(
        self,
        height: float,
        views: Mapping[str, View],
        image: LabImage,
        patches: Sequence[np.ndarray],
        outline: np.ndarray | None,
    ) -> Standing | None:
        """Find it on something of a height; None where no patch shows a place for it.

        Args:
            outline: (H, W) bool, the area for it to fill from above.
        """
        camera = views["top"].camera
        template, standing = template_from_reference(self.look, camera, height), middles(patches)
        roughs = [*_apart(places(image, template, standing).poses), *_upon(patches, camera, height)]
        if self.planned is not None:
            roughs.append(np.array([*self.planned.p[:2], self.planned.yaw]))
        shown = [rough for rough in roughs if _is_shown(rough, patches, camera, height)]
        return self._likeliest(shown, height, views, outline)

    def lying(self, views: Mapping[str, View], floor: Pose, among: np.ndarray) -> Standing:
        """Find the likeliest place of the object on a floor.

        Args:
            views: of one moment; the ``top`` one tells.
            floor: pose of the middle of the floor.
            among: (H, W) bool, where something changed there; its largest patches are tried, and the middle.
        """
        top, height = views["top"], float(floor.p[2])
        patches = components(among, MIN_AREA * among.size)
        roughs = [np.array([*floor.p[:2], floor.yaw]), *(_upon(patches, top.camera, height) if patches else [])]
        outline = np.any(patches, axis=0) if patches else None
        found = self._likeliest(roughs, height, {"top": top}, outline)
        assert found is not None  # there is at least the middle
        return found

    def _likeliest(
        self, roughs: Sequence[np.ndarray], height: float, views: Mapping[str, View], outline: np.ndarray | None
    ) -> Standing | None:
        """The likeliest of rough poses (3,) on something of a height, at one of their flips; None without any."""
        size, draw = self.look.size, self.draw
        tries: list[tuple[float, tuple[float, ...], list[Sight]]] = []
        for rough in roughs:
            middle = np.array([rough[0], rough[1], height + size[2] / 2])
            sights = [Sight.of(view, middle, size, outline if name == "top" else None) for name, view in views.items()]
            flipped = rough + np.radians(SETTINGS.flips_deg)[:, None] * [0, 0, 1]
            tries += [(unlikeness(p, height, sights, draw), tuple(p), sights) for p in flipped]
        if not tries:
            return None
        best: tuple[float, np.ndarray, list[Sight]] = (np.inf, np.zeros(3), [])
        for least, start, sights in sorted(tries, key=lambda tried: tried[0])[: SETTINGS.refined]:
            here = partial(unlikeness, height=height, sights=sights, draw=draw)
            nearby = refined(np.array(start), least, here, SETTINGS.rounds)
            best = min(best, (*nearby, sights), key=lambda found: found[0])
        return self._standing_at(best[1], height, best[2], views["top"].camera)

    def where_planned(self, views: Mapping[str, View]) -> Standing | None:
        """Find the object about where the layout put it; None where that is not known.

        Args:
            views: of the same moment.
        """
        return None if self.planned is None else self.near([self.planned], views)

    def near(
        self, starts: Sequence[Pose], views: Mapping[str, View], hidden: Mapping[str, np.ndarray] = _NOTHING
    ) -> Standing:
        """Find the object near one of some poses of one height.

        Args:
            starts: those poses.
            views: of the same moment.
            hidden: (H, W) bool by view, the area hidden by something else.
        """
        height, tries = float(starts[0].p[2]), []
        for start in starts:
            at, middle = np.array([*start.p[:2], start.yaw]), start.p + [0.0, 0.0, self.look.size[2] / 2]
            sights = [Sight.of(view, middle, self.look.size, None, hidden.get(name)) for name, view in views.items()]
            tries.append((unlikeness(at, height, sights, self.draw), tuple(at), sights))
        least, at, sights = min(tries, key=lambda tried: tried[0])
        rounds = SETTINGS.rounds_near if len(starts) == 1 else SETTINGS.rounds
        _, pose = refined(np.array(at), least, lambda p: unlikeness(p, height, sights, self.draw), rounds)
        return self._standing_at(pose, height, sights, views["top"].camera)

    def found(self, views: Mapping[str, View], among: np.ndarray | None = None) -> Standing | None:
        """Find the object at its planned place, or elsewhere if that is empty or another place fits better.

        Args:
            views, among: see :meth:`standing`.
        """
        there = self.where_planned(views)
        if there is None or not there.covered.any():
            return self.standing(views, among)
        empty = self.gone(there, views["top"])
        if not empty and there.unlike < SETTINGS.surely_lab:
            return there
        elsewhere = self.standing(views, among)
        # A full box looks less like its drawing than does the bare table of its colour around a smaller thing.
        if elsewhere is not None and self.gone(elsewhere, views["top"]):
            elsewhere = None
        if elsewhere is not None and (empty or elsewhere.unlike + SETTINGS.clearly_lab < there.unlike):
            return elsewhere
        return None if empty else there

    def gone(self, there: Standing, top: View) -> bool:
        """True where a view from above shows the empty table in the place of the object."""
        if self.background is None:
            return float(salience(top.picture, None)[there.covered].mean()) < PIXELS.filled_share
        return self.speaks(there, top, self.background)[0] < SETTINGS.gone_share

    def speaks(
        self,
        there: Standing,
        view: View,
        without: np.ndarray,
        hidden: np.ndarray | None = None,
        alike_lab: float = np.inf,
    ) -> tuple[float, int]:
        """Of the pixels that distinguish the object from a picture without it, the share that look as drawn in a view,
        and their number; the share is 1 where there are none.

        Args:
            there: where the object would stand.
            view: that may show it.
            without: (H, W, 3) a picture of the same camera without it there.
            hidden: (H, W) bool, the area hidden by something else.
            alike_lab: colour distance to the drawing from which a pixel does not look like it, however little it looks
                like the picture without it.
        """
        own, seen, bare = self._telling(there, view, without, hidden)
        like = distance(seen, own) < np.minimum(distance(seen, bare), alike_lab)
        return (float(like.mean()) if like.size else 1.0), like.size

    def seen_through(self, there: Standing, view: View, without: np.ndarray, alike_lab: float) -> tuple[float, int]:
        """Of the same pixels, the share that look as the picture without the object, and their number; the share is 0
        where there are none.

        Args:
            there, view, without: as of :meth:`speaks`.
            alike_lab: colour distance to that picture from which a pixel does not look like it: something else is
                there.
        """
        own, seen, bare = self._telling(there, view, without, None)
        like = distance(seen, bare) < np.minimum(distance(seen, own), alike_lab)
        return (float(like.mean()) if like.size else 0.0), like.size

    def _telling(
        self, there: Standing, view: View, without: np.ndarray, hidden: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """CIELAB (n, 3) of the pixels that tell an object from a picture without it: drawn, seen, and without it."""
        window = window_around(there.pose.p + [0, 0, self.look.size[2] / 2], self.look.size, view.camera)
        drawing, picture = self.draw(there.pose, view.camera, window), cut(view.picture, window)
        unseen = np.zeros_like(drawing.covered) if hidden is None else cut(hidden, window)
        own = to_lab(as_bright(drawing, picture, unseen).astype(np.uint8))
        seen, bare = smoothed(picture), smoothed(cut(without, window))
        telling = drawing.covered & inside(view.picture, window) & ~unseen & (distance(own, bare) > PIXELS.changed_lab)
        return own[telling], seen[telling], bare[telling]

    def left(self, there: Standing, change: np.ndarray, top: View) -> float:
        """Share of where the object stood that has changed (H, W); all of it where a view from above shows the bare
        table."""
        if not there.covered.any():
            return 0.0
        return 1.0 if self.gone(there, top) else float(change[there.covered].mean())

    def _standing_at(self, pose: np.ndarray, height: float, sights: Sequence[Sight], camera: Camera) -> Standing:
        unlike = unlikeness(pose, height, [replace(s, outline=np.zeros_like(s.outline)) for s in sights], self.draw)
        at = Pose.from_yaw([pose[0], pose[1], height], float(pose[2]))
        return Standing(at, self.look.size, unlike, drawn_whole(self.draw, at, camera).covered)


def _apart(poses: np.ndarray) -> list[np.ndarray]:
    """The first few poses (3,) of the best-first (n, 4), one for each place."""
    found: list[np.ndarray] = []
    for pose in poses[:, :3]:
        if all(np.linalg.norm(pose[:2] - other[:2]) > SETTINGS.apart_m for other in found):
            found.append(pose)
        if len(found) == SETTINGS.candidates:
            break
    return found


def _upon(patches: Sequence[np.ndarray], camera: Camera, height: float) -> list[np.ndarray]:
    """Poses (3,) upon the largest patches of a picture, at headings that its flips go on from."""
    largest = sorted(patches, key=lambda patch: -int(patch.sum()))[: SETTINGS.candidates]
    at = camera.unproject(middles(largest), height)
    return [np.array([x, y, heading]) for x, y, _ in at for heading in np.radians(SETTINGS.headings_deg)]


def _is_shown(pose: np.ndarray, patches: Sequence[np.ndarray], camera: Camera, height: float) -> bool:
    """True where one of the patches, or its surroundings, shows the place of a pose (3,)."""
    u, v = np.round(camera.project(np.array([[pose[0], pose[1], height]]))[0]).astype(int)
    around = np.s_[
        max(0, v - SETTINGS.near_px) : max(0, v + SETTINGS.near_px),
        max(0, u - SETTINGS.near_px) : max(0, u + SETTINGS.near_px),
    ]
    return any(bool(patch[around].any()) for patch in patches)
