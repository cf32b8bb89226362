"""Where an object stands in the pictures: found from above, and told apart from its other sides by drawing it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.models.rules.evidence import middles, places, salience
from vcage.sim.drawer import Drawing, Window
from vcage.vision.colour import LabImage, distance, to_lab
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


def find_standing(
    views: Mapping[str, View],
    background: np.ndarray | None,
    table_height: float,
    look: Reference,
    draw: Draw,
    among: np.ndarray | None = None,
    tops: Sequence[float] = (),
) -> Standing | None:
    """Where an object stands; None where nothing stands that it could be.

    Args:
        views: of the same moment; the ``top`` one finds it, all tell its sides apart.
        background: the top view of the empty table.
        table_height: metres.
        look: how the object looks from above.
        draw: draws it.
        among: (H, W) bool, where it may be in the top view; anywhere when not given.
        tops: z of what it may stand on besides the table, metres.
    """
    top = views["top"]
    image = LabImage.of(top.picture, salience(top.picture, background))
    there = image.salience > 0.5
    patches = components(there if among is None else there & among, MIN_AREA * there.size)
    if not patches:
        return None
    stands = [_on(height, views, image, patches, look, draw) for height in (table_height, *tops)]
    return min(stands, key=lambda found: found.unlike)


def _on(
    height: float,
    views: Mapping[str, View],
    image: LabImage,
    patches: Sequence[np.ndarray],
    look: Reference,
    draw: Draw,
) -> Standing:
    """Where an object is likeliest to stand on something of a height; see :func:`find_standing`."""
    camera = views["top"].camera
    template, standing = template_from_reference(look, camera, height), middles(patches)
    tries: list[tuple[float, tuple[float, ...], list[_Sight]]] = []
    for rough in [*_apart(places(image, template, standing).poses), *_upon(patches, camera, height)]:
        if not _shown(rough, patches, camera, height):
            continue
        middle = np.array([rough[0], rough[1], height + look.size[2] / 2])
        sights = [_Sight.of(view, middle, look.size) for view in views.values()]
        tries += [(_unlike(p, height, sights, draw), tuple(p), sights) for p in rough + FLIPS[:, None] * [0, 0, 1]]
    best: tuple[float, np.ndarray] = (np.inf, np.zeros(3))
    for least, start, sights in sorted(tries, key=lambda tried: tried[0])[:REFINED]:
        nearby = refined(np.array(start), least, lambda p, s=sights: _unlike(p, height, s, draw))
        best = min(best, nearby, key=lambda found: found[0])
    unlike, (x, y, yaw) = best
    pose = Pose.from_yaw([x, y, height], yaw)
    return Standing(pose, look.size, unlike, covered_by(draw, pose, camera))


def covered_by(draw: Draw, pose: Pose, camera: Camera) -> np.ndarray:
    """(H, W) bool: where a drawing of an object covers a camera's picture."""
    window = Window(0, 0, max(camera.width, camera.height), 1)
    return draw(pose, camera, window).covered[: camera.height, : camera.width]


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


def as_bright(drawing: Drawing, picture: np.ndarray) -> np.ndarray:
    """(side, side, 3) float32, a drawing as bright as a picture is where it is covered."""
    drawn, covered = drawing.picture.astype(np.float32), drawing.covered
    if covered.any():
        gain = np.median(picture[covered], axis=0) / np.maximum(np.median(drawn[covered], axis=0), 1)
        drawn = drawn * np.clip(gain, 0.5, 2.0)
    return np.clip(drawn, 0, 255)


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
    """

    camera: Camera
    window: Window
    picture: np.ndarray
    lab: np.ndarray

    @classmethod
    def of(cls, view: View, middle: np.ndarray, size: Sequence[float]) -> _Sight:
        window = window_around(middle, size, view.camera)
        picture = cut(view.picture, window)
        return cls(view.camera, window, picture, to_lab(cv2.GaussianBlur(picture, (3, 3), 0)))


def _unlike(pose: np.ndarray, height: float, sights: Sequence[_Sight], draw: Draw) -> float:
    """Mean colour distance between sights and drawings of the object at (3,) x, y and heading."""
    costs = []
    for sight in sights:
        drawing = draw(Pose.from_yaw([pose[0], pose[1], height], float(pose[2])), sight.camera, sight.window)
        if not drawing.covered.any():
            return CAP
        drawn = to_lab(as_bright(drawing, sight.picture).astype(np.uint8))
        costs.append(np.minimum(distance(sight.lab, drawn)[drawing.covered], CAP).mean())
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
