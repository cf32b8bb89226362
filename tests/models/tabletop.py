"""Pictures of a table with coloured prisms on it, drawn by projection: stands in for renders in tests."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import cv2
import numpy as np

from vcage.base.geometry import Camera, Pose, box_corners, world_aabb
from vcage.models.protocols import CriticQuestion
from vcage.schema.base import CameraRecord, PoseRecord, Provenance
from vcage.schema.goals import Goal
from vcage.schema.scene import ObjectRecord, Scene, Table, Workspace
from vcage.sim.drawer import Drawing, Window
from vcage.vision.protocols import Reference, View

HEIGHT = 0.74
CAMERA = Camera(640, 480, 0.51, Pose((0, 0, 2.34), (0.5, -0.5, 0.5, 0.5)))
LIGHT = np.array([0.25, -0.35])
"""Where the shadows fall, metres on the table for each metre of height."""


@dataclass(frozen=True)
class Thing:
    """A prism: ``outline`` in metres around its middle, or a rectangle of ``size``; hollow ones have walls."""

    id: str
    colour: tuple[int, int, int]
    size: tuple[float, float, float]
    at: tuple[float, float] = (0.0, 0.0)
    yaw: float = 0.0
    base: float = 0.0
    round: bool = False
    hollow: bool = False
    stripe: tuple[int, int, int] | None = None
    role: str = "content"

    def outline(self, share: float = 1.0) -> np.ndarray:
        """(n, 2) world corners, shrunk to ``share``."""
        if self.round:
            angles = np.linspace(0, 2 * np.pi, 24, endpoint=False)
            local = np.stack([np.cos(angles), np.sin(angles)], 1)
        else:
            local = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]])
        return self._turn(local * np.array(self.size[:2]) / 2 * share)

    def band(self) -> np.ndarray:
        """(4, 2) world corners of the coloured end."""
        x, y = np.array(self.size[:2]) / 2
        return self._turn(np.array([[0.5 * x, -y], [x, -y], [x, y], [0.5 * x, y]]))

    def _turn(self, local: np.ndarray) -> np.ndarray:
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        return local @ np.array([[c, s], [-s, c]]) + np.array(self.at)

    def moved(self, **changes: object) -> Thing:
        return replace(self, **changes)


def _pixels(camera: Camera, corners: np.ndarray, z: float, origin: tuple[int, int] = (0, 0)) -> np.ndarray:
    pixels = camera.project(np.hstack([corners, np.full((len(corners), 1), z)]))
    return np.rint(pixels * 16 - 8).astype(np.int32) - 16 * np.array(origin, np.int32)


def _fill(picture: np.ndarray, polygon: np.ndarray, colour: np.ndarray | tuple[float, ...] | float) -> None:
    value = tuple(float(c) for c in np.atleast_1d(colour))
    cv2.fillPoly(picture, [polygon], value, lineType=cv2.LINE_AA if picture.ndim == 3 else cv2.LINE_8, shift=4)


@cache
def table_picture(camera: Camera = CAMERA, seed: int = 0) -> np.ndarray:
    """(H, W, 3) the empty table: wood with a grain."""
    noise = np.random.default_rng(seed).normal(size=(camera.height, camera.width)).astype(np.float32)
    grain = cv2.GaussianBlur(noise, (0, 0), sigmaX=24, sigmaY=1.2)
    grain = grain / np.abs(grain).max()
    shade = 1 + 0.12 * grain + 0.02 * noise
    return np.clip(np.array([176, 132, 84]) * shade[..., None], 0, 255).astype(np.uint8)


def draw(things: list[Thing], camera: Camera = CAMERA, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Picture (H, W, 3) uint8 and segmentation (H, W) uint8 with 1, 2, … in the order of ``things``."""
    picture = table_picture(camera, seed).astype(np.float32)
    ids = np.zeros((camera.height, camera.width), np.uint8)
    for index, thing in sorted(enumerate(things, start=1), key=lambda pair: pair[1].base):
        _cast(picture, thing, camera)
        _draw(picture, ids, index, thing, camera)
    noise = np.random.default_rng(seed + 1).normal(scale=1.5, size=picture.shape)
    return np.clip(picture + noise, 0, 255).astype(np.uint8), ids


def _cast(picture: np.ndarray, thing: Thing, camera: Camera) -> None:
    shadow = np.zeros(picture.shape[:2], np.float32)
    z = HEIGHT + thing.base
    for share in np.linspace(0, 1, 6):
        _fill(shadow, _pixels(camera, thing.outline() + LIGHT * thing.size[2] * share, z), 1.0)
    picture *= 1 - 0.3 * cv2.GaussianBlur(shadow, (7, 7), 0)[..., None]


def _draw(
    picture: np.ndarray, ids: np.ndarray, index: int, thing: Thing, camera: Camera, origin: tuple[int, int] = (0, 0)
) -> None:
    """Paint a thing into the part of a camera's picture whose first pixel is ``origin``, left and top."""
    colour = np.array(thing.colour, dtype=np.float64)
    bottom, top = HEIGHT + thing.base, HEIGHT + thing.base + thing.size[2]
    outline = thing.outline()
    low, high = (_pixels(camera, outline, z, origin) for z in (bottom, top))
    for a, b in zip(range(len(outline)), np.roll(range(len(outline)), -1), strict=True):
        for target, value in ((picture, colour * 0.7), (ids, index)):
            _fill(target, np.concatenate([low[[a, b]], high[[b, a]]]), value)
    for target, value in ((picture, colour), (ids, index)):
        _fill(target, high, value)
    if thing.stripe is not None:
        _fill(picture, _pixels(camera, thing.band(), top, origin), thing.stripe)
    if thing.hollow:
        for level, shade in ((top - 0.002, 0.6), (bottom + 0.004, 0.8)):
            _fill(picture, _pixels(camera, thing.outline(0.94), level, origin), colour * shade)


@cache
def reference(thing: Thing, phrase: str = "") -> Reference:
    """The thing alone, seen from straight above and far away, on nothing."""
    alone = thing.moved(at=(0.0, 0.0), yaw=0.0, base=0.0)
    camera = Camera(256, 256, 0.03, Pose((0, 0, HEIGHT + 15), (0.5, -0.5, 0.5, 0.5)))
    picture, ids = draw([alone], camera)
    alpha = np.where(ids > 0, 255, 0).astype(np.uint8)
    return Reference(phrase or thing.id, np.dstack([picture, alpha]), 15 / camera.focal, thing.size)


def view(things: list[Thing], camera: Camera = CAMERA) -> View:
    return _view(tuple(things), camera)


@cache
def _view(things: tuple[Thing, ...], camera: Camera) -> View:
    return View(draw(list(things), camera)[0], camera)


def critic_question(
    before: list[Thing], after: list[Thing], goal: Goal, text: str = "…", camera: Camera = CAMERA
) -> CriticQuestion:
    """The question to a critic about two views of a table. The pictures are shared: copy to change them."""
    by_id = {thing.id: thing for thing in before}

    def drawn(name: str, pose: Pose, camera: Camera, window: Window, _shares: object) -> Drawing:
        thing = by_id[name].moved(at=tuple(pose.p[:2]), yaw=pose.yaw, base=pose.p[2] - HEIGHT)
        picture, ids = np.zeros((window.side, window.side, 3), np.float32), np.zeros((window.side, window.side))
        _draw(picture, ids, 1, thing, camera, (window.left, window.top))
        rows, columns = (np.arange(window.side) + start for start in (window.top, window.left))
        shown = ((rows >= 0) & (rows < camera.height))[:, None] & (columns >= 0) & (columns < camera.width)
        if not shown.all():
            picture[~shown] = ids[~shown] = 0
        return Drawing(picture.astype(np.uint8), ids > 0, np.ones(ids.shape, np.float32))

    rooms = {goal: _room(by_id[goal.reference])[None]} if goal.reference in by_id else {}
    return CriticQuestion(
        text,
        [goal],
        {"top": view(before, camera)},
        {"top": view(after, camera)},
        {thing.id: reference(thing) for thing in before},
        draw=drawn,
        rooms=rooms,
        planned={t.id: Pose.from_yaw((*t.at, HEIGHT + t.base), t.yaw) for t in before},
        table_height=HEIGHT,
        background=table_picture(camera),
    )


def _room(thing: Thing) -> np.ndarray:
    """(8, 3) corners of where others may be in or on it, in its frame."""
    half = np.array(thing.size[:2]) / 2 * (0.94 if thing.hollow else np.sqrt(0.5))
    floor = 0.005 if thing.hollow else thing.size[2]
    return box_corners([*-half, floor], [*half, thing.size[2] + (0.0 if thing.hollow else 0.04)])


def scene_of(things: list[Thing], instruction: str = "Put the blocks on the plate") -> Scene:
    """A scene record of the things."""
    objects = []
    for thing in things:
        pose = Pose.from_yaw((*thing.at, HEIGHT + thing.base), thing.yaw)
        x, y, z = thing.size
        box = world_aabb([(-x / 2, -y / 2, 0), (x / 2, y / 2, z)], pose)
        objects.append(
            ObjectRecord(
                id=thing.id,
                asset=thing.id.split("-")[0],
                variant="plain",
                phrase=thing.id.replace("-", " "),
                role=thing.role,
                pose=PoseRecord.of(pose),
                aabb=tuple(tuple(map(float, row)) for row in box),
            )
        )
    return Scene(
        provenance=Provenance(producer="test", seed=0), instruction=instruction, template="table", robot="dual_panda",
        table=Table(), workspace=Workspace(lower=(-0.45, -0.25), upper=(0.45, 0.25)),
        top_camera=CameraRecord.of(CAMERA), objects=objects,
        segmentation_ids={thing.id: i for i, thing in enumerate(things, start=1)},
    )  # fmt: skip


BOX = Thing("box", (190, 150, 100), (0.25, 0.18, 0.08), (0.05, 0.10), 0.3, hollow=True, role="receptacle")
PLATE = Thing("plate", (235, 235, 230), (0.22, 0.22, 0.02), (0.0, 0.05), round=True, role="receptacle")
WHITE_BOX = BOX.moved(id="white-box", colour=(225, 225, 225))
MARKERS = [
    Thing("black-marker", (35, 35, 38), (0.14, 0.018, 0.018), (-0.30, -0.10), 0.4, stripe=(220, 220, 220)),
    Thing("red-marker", (200, 40, 40), (0.14, 0.018, 0.018), (-0.28, 0.05), 1.9, stripe=(220, 220, 220)),
    Thing("blue-marker", (40, 70, 190), (0.14, 0.018, 0.018), (0.32, -0.12), -0.6, stripe=(220, 220, 220)),
]
BLOCKS = [
    Thing("red-block", (200, 45, 40), (0.04, 0.04, 0.04), (-0.25, -0.12), 0.2),
    Thing("green-block", (60, 150, 70), (0.04, 0.04, 0.04), (0.28, -0.10), 0.7),
    Thing("blue-block", (45, 80, 190), (0.04, 0.04, 0.04), (-0.05, -0.18), 1.1),
]
BREADS = [
    Thing("croissant", (196, 140, 70), (0.12, 0.06, 0.04), (-0.30, -0.05), 0.5, round=True),
    Thing("bagel", (170, 105, 50), (0.09, 0.09, 0.035), (0.30, -0.05), 0.0, round=True),
    Thing("toast", (222, 184, 120), (0.09, 0.09, 0.014), (-0.05, -0.18), 0.8),
]
ERASER = Thing("eraser", (60, 70, 80), (0.11, 0.05, 0.03), (0.30, 0.12), 0.2, stripe=(230, 230, 230))
