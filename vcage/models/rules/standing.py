"""Where an object stands in the pictures: found from above, and told apart from its other sides by drawing it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.models.rules.evidence import CHANGED, FILLED, middles, places, salience
from vcage.sim.drawer import Drawing, Window
from vcage.vision.colour import LabImage, distance, smoothed, to_lab
from vcage.vision.detector import MIN_AREA, components
from vcage.vision.object_templates import template_from_reference
from vcage.vision.protocols import Reference, View

CAP = 30.0
"""Largest colour distance that a pixel can cost."""

FLIPS = np.radians([0.0, 90.0, 180.0, 270.0])
"""Headings besides that at which an object seems to stand: a plain box looks the same from several sides."""

STEPS, ROUNDS = np.array([0.004, 0.004, np.radians(5.0)]), 5
"""First steps along x, y and in heading with which a pose is refined by drawing the object, and how often."""

CANDIDATES, REFINED = 3, 2
"""Places that are drawn, and poses of those that are refined."""

HEADINGS = np.radians([0.0, 30.0, 60.0])
"""Headings that are tried besides, where something stands that nothing fits at first sight."""

NEAR = 12
"""So far from what has been seen to stand or change an object is looked for, pixels."""

FEW = 3
"""Rounds in which a pose is refined that is known to be nearly right."""

ENOUGH = 1000
"""Pixels by which it is told how bright a drawing should be."""

BRIGHTER, TINTED = (0.5, 2.0), (0.85, 1.18)
"""How much brighter than a drawing a picture may be, and how much more so in one colour than in the others."""

UNFILLED = 20.0
"""Colour distance that a pixel of an outline costs which a drawing leaves open."""

CLEARLY, SURELY = 3.0, 9.0
"""So much more like an object another place must be than that where the layout put it; and so unlike at most is what is
not looked for elsewhere."""

GONE = 0.2
"""Share of what tells an object from the bare table below which it is not there; more of it may lie in shadow."""

APART = 0.02
"""Poses that are nearer to each other than this are at one place, metres."""

Draw = Callable[[Pose, Camera, Window], Drawing]
"""An object alone at a pose, as a camera sees it through a window."""


@dataclass(frozen=True)
class Standing:
    """Where an object is seen to stand.

    Args:
        pose: of the object in the world.
        size: (3,) its bounding box, metres.
        unlike: mean colour distance between the pictures and drawings of it there, at most :data:`CAP`.
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
        tops: z of what it may stand on besides the table, metres.
        planned: where the layout put it: it is looked for there too.
    """

    look: Reference
    draw: Draw
    background: np.ndarray | None
    table_height: float
    tops: Sequence[float] = ()
    planned: Pose | None = None

    def standing(self, views: Mapping[str, View], among: np.ndarray | None = None) -> Standing | None:
        """Where the object stands; None where nothing stands that it could be.

        Args:
            views: of the same moment; the ``top`` one finds it, all tell its sides apart.
            among: (H, W) bool, where it may be in the top view; anywhere when not given.
        """
        top = views["top"]
        image = LabImage.of(top.picture, salience(top.picture, self.background))
        there = image.salience > 0.5
        patches = components(there if among is None else there & among, MIN_AREA * there.size)
        if not patches:
            return None
        outline = None if among is None else np.any(patches, axis=0)
        stands = [self._on(height, views, image, patches, outline) for height in (self.table_height, *self.tops)]
        return min((one for one in stands if one is not None), key=lambda found: found.unlike, default=None)

    def _on(
        self,
        height: float,
        views: Mapping[str, View],
        image: LabImage,
        patches: Sequence[np.ndarray],
        outline: np.ndarray | None,
    ) -> Standing | None:
        """Where it is likeliest to stand on something of a height; None where no patch shows a place for it.

        Args:
            outline: (H, W) bool, what it should fill from above.
        """
        camera, size, draw = views["top"].camera, self.look.size, self.draw
        template, standing = template_from_reference(self.look, camera, height), middles(patches)
        tries: list[tuple[float, tuple[float, ...], list[_Sight]]] = []
        roughs = [*_apart(places(image, template, standing).poses), *_upon(patches, camera, height)]
        if self.planned is not None:
            roughs.append(np.array([*self.planned.p[:2], self.planned.yaw]))
        for rough in roughs:
            if not _shown(rough, patches, camera, height):
                continue
            middle = np.array([rough[0], rough[1], height + size[2] / 2])
            sights = [_Sight.of(view, middle, size, outline if name == "top" else None) for name, view in views.items()]
            tries += [(_unlike(p, height, sights, draw), tuple(p), sights) for p in rough + FLIPS[:, None] * [0, 0, 1]]
        if not tries:
            return None
        best: tuple[float, np.ndarray, list[_Sight]] = (np.inf, np.zeros(3), [])
        for least, start, sights in sorted(tries, key=lambda tried: tried[0])[:REFINED]:
            nearby = refined(np.array(start), least, lambda p, s=sights: _unlike(p, height, s, draw))
            best = min(best, (*nearby, sights), key=lambda found: found[0])
        return self._seen_at(best[1], height, best[2], camera)

    def where_planned(self, views: Mapping[str, View]) -> Standing | None:
        """Where the object stands if it does so about where the layout put it; None where that is not known.

        Args:
            views: of the same moment.
        """
        if self.planned is None:
            return None
        x, y, height = self.planned.p
        start, middle = np.array([x, y, self.planned.yaw]), np.array([x, y, height + self.look.size[2] / 2])
        sights = [_Sight.of(view, middle, self.look.size, None) for view in views.values()]
        least = _unlike(start, height, sights, self.draw)
        _, pose = refined(start, least, lambda p: _unlike(p, height, sights, self.draw), rounds=FEW)
        return self._seen_at(pose, height, sights, views["top"].camera)

    def found(self, views: Mapping[str, View], among: np.ndarray | None = None) -> Standing | None:
        """Where the object stands: where the layout put it, unless nothing stands there or another place fits better.

        Args:
            views, among: see :meth:`standing`.
        """
        there = self.where_planned(views)
        if there is None or not there.covered.any():
            return self.standing(views, among)
        empty = self.gone(there, views["top"])
        if not empty and there.unlike < SURELY:
            return there
        elsewhere = self.standing(views, among)
        # A full box looks less like its drawing than does the bare table of its colour around a smaller thing.
        if elsewhere is not None and self.gone(elsewhere, views["top"]):
            elsewhere = None
        if elsewhere is not None and (empty or elsewhere.unlike + CLEARLY < there.unlike):
            return elsewhere
        return None if empty else there

    def gone(self, there: Standing, top: View) -> bool:
        """Whether a view from above shows the empty table where the object would stand."""
        if self.background is None:
            return float(salience(top.picture, None)[there.covered].mean()) < FILLED
        return self.speaks(there, top, self.background) < GONE

    def speaks(self, there: Standing, top: View, without: np.ndarray) -> float:
        """Share of what tells a drawing of the object from a picture without it (H, W, 3) that a view from above shows
        as drawn; 1 where nothing tells them apart."""
        window = window_around(there.pose.p + [0, 0, self.look.size[2] / 2], self.look.size, top.camera)
        drawing, picture = self.draw(there.pose, top.camera, window), cut(top.picture, window)
        own = to_lab(as_bright(drawing, picture).astype(np.uint8))
        seen, bare = smoothed(picture), smoothed(cut(without, window))
        telling = drawing.covered & inside(top.picture, window) & (distance(own, bare) > CHANGED)
        return float((distance(seen, own) < distance(seen, bare))[telling].mean()) if telling.any() else 1.0

    def left(self, there: Standing, change: np.ndarray, top: View) -> float:
        """Share of where the object stood that has changed (H, W); all of it where a view from above shows the bare
        table."""
        if not there.covered.any():
            return 0.0
        return 1.0 if self.gone(there, top) else float(change[there.covered].mean())

    def _seen_at(self, pose: np.ndarray, height: float, sights: Sequence[_Sight], camera: Camera) -> Standing:
        unlike = _unlike(pose, height, [replace(s, outline=np.zeros_like(s.outline)) for s in sights], self.draw)
        at = Pose.from_yaw([pose[0], pose[1], height], float(pose[2]))
        return Standing(at, self.look.size, unlike, drawn_whole(self.draw, at, camera).covered)


def drawn_whole(draw: Draw, pose: Pose, camera: Camera) -> Drawing:
    """A drawing of an object in all of a camera's picture, as large as that."""
    drawing = draw(pose, camera, Window(0, 0, max(camera.width, camera.height), 1))
    layers = (drawing.picture, drawing.covered, drawing.depth)
    return Drawing(*(layer[: camera.height, : camera.width] for layer in layers))


def window_around(middle: np.ndarray, size: Sequence[float], camera: Camera) -> Window:
    """The part of a camera's picture that an object of a size may cover, its middle (3,) in the world."""
    away = float(np.linalg.norm(camera.pose.p - middle))
    side = int(np.ceil(1.3 * float(np.linalg.norm(size)) * camera.focal / away)) + 16
    left, top = np.round(camera.project(middle[None])[0] - side / 2).astype(int)
    return Window(int(left), int(top), side, 1)


def cut(picture: np.ndarray, window: Window) -> np.ndarray:
    """What a window shows of a picture; black outside it."""
    shown = np.zeros((window.side, window.side, *picture.shape[2:]), picture.dtype)
    (v0, v1), (u0, u1) = (
        np.clip([start, start + window.side], 0, end)
        for start, end in zip((window.top, window.left), picture.shape, strict=False)
    )
    shown[v0 - window.top : v1 - window.top, u0 - window.left : u1 - window.left] = picture[v0:v1, u0:u1]
    return shown


def inside(picture: np.ndarray, window: Window) -> np.ndarray:
    """(side, side) bool: what a window shows of a picture and not of what is beside it."""
    return cut(np.ones(picture.shape[:2], bool), window)


def brightness(drawing: Drawing, picture: np.ndarray) -> np.ndarray:
    """(3,) by which a drawing is multiplied to be as bright as a picture is where it is covered."""
    covered = drawing.covered
    if not covered.any():
        return np.ones(3, np.float32)
    some = slice(None, None, 1 + int(covered.sum()) // ENOUGH)
    gain = np.median((picture[covered][some] + 4.0) / (drawing.picture[covered][some] + np.float32(4.0)), axis=0)
    level = float(np.median(gain))
    return np.clip(level, *BRIGHTER) * np.clip(gain / max(level, 1e-3), *TINTED)


def as_bright(drawing: Drawing, picture: np.ndarray) -> np.ndarray:
    """(side, side, 3) float32, a drawing as bright as a picture is where it is covered."""
    return np.clip(drawing.picture.astype(np.float32) * brightness(drawing, picture), 0, 255)


def refined(
    pose: np.ndarray,
    least: float,
    unlike: Callable[[np.ndarray], float],
    steps: np.ndarray = STEPS,
    rounds: int = ROUNDS,
) -> tuple[float, np.ndarray]:
    """The least cost near (3,) x, y and heading, and where it is."""
    for _ in range(rounds):
        around = [pose + sign * steps * axis for axis in np.eye(3) for sign in (1, -1)]
        value, nearby = min(((unlike(p), tuple(p)) for p in around), key=lambda found: found[0])
        pose, least, steps = (np.array(nearby), value, steps) if value < least else (pose, least, steps / 2)
    return least, pose


@dataclass(frozen=True)
class _Sight:
    """A view around a place.

    Args:
        camera, window: that see it.
        picture: (side, side, 3) uint8.
        lab: the same, smoothed.
        outline: (side, side) bool, what a drawing should fill.
    """

    camera: Camera
    window: Window
    picture: np.ndarray
    lab: np.ndarray
    outline: np.ndarray

    @classmethod
    def of(cls, view: View, middle: np.ndarray, size: Sequence[float], outline: np.ndarray | None) -> _Sight:
        window = window_around(middle, size, view.camera)
        picture = cut(view.picture, window)
        lab = smoothed(picture)
        filled = np.zeros(picture.shape[:2], bool) if outline is None else cut(outline, window)
        return cls(view.camera, window, picture, lab, filled)


def _unlike(pose: np.ndarray, height: float, sights: Sequence[_Sight], draw: Draw) -> float:
    """Mean colour distance between sights and drawings of the object at (3,) x, y and heading."""
    costs = []
    for sight in sights:
        drawing = draw(Pose.from_yaw([pose[0], pose[1], height], float(pose[2])), sight.camera, sight.window)
        if not drawing.covered.any():
            return CAP
        drawn = to_lab(as_bright(drawing, sight.picture).astype(np.uint8))
        apart = np.minimum(distance(sight.lab, drawn)[drawing.covered], CAP).mean()
        costs.append(apart + UNFILLED * (sight.outline & ~drawing.covered).sum() / drawing.covered.sum())
    return float(np.mean(costs))


def _apart(poses: np.ndarray) -> list[np.ndarray]:
    """The first few poses (3,) of the best-first (n, 4), one for each place."""
    found: list[np.ndarray] = []
    for pose in poses[:, :3]:
        if all(np.linalg.norm(pose[:2] - other[:2]) > APART for other in found):
            found.append(pose)
        if len(found) == CANDIDATES:
            break
    return found


def _upon(patches: Sequence[np.ndarray], camera: Camera, height: float) -> list[np.ndarray]:
    """Poses (3,) upon the largest patches of a picture, at headings that its flips go on from."""
    largest = sorted(patches, key=lambda patch: -int(patch.sum()))[:CANDIDATES]
    at = camera.unproject(middles(largest), height)
    return [np.array([x, y, heading]) for x, y, _ in at for heading in HEADINGS]


def _shown(pose: np.ndarray, patches: Sequence[np.ndarray], camera: Camera, height: float) -> bool:
    """Whether one of the patches, or what is around it, shows the place of a pose (3,)."""
    u, v = np.round(camera.project(np.array([[pose[0], pose[1], height]]))[0]).astype(int)
    around = np.s_[max(0, v - NEAR) : max(0, v + NEAR), max(0, u - NEAR) : max(0, u + NEAR)]
    return any(bool(patch[around].any()) for patch in patches)
