"""A small painted world: boxes seen by a camera from above, without a renderer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
import pytest

from vcage.base.geometry import Camera, Pose, box_corners, look_at, world_aabb
from vcage.schema.base import CameraRecord, PoseRecord, Provenance
from vcage.schema.scene import ObjectRecord, Scene, Table, Workspace
from vcage.vision.protocols import Detection

TABLE_HEIGHT = 0.74
FACES = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (1, 3, 7, 5))  # -x, +x, -y, +y, top


@dataclass(frozen=True)
class Thing:
    """A box with a dark right end, so that its heading can be seen."""

    id: str
    phrase: str
    size: tuple[float, float, float]
    colour: tuple[int, int, int]
    xy: tuple[float, float]
    yaw: float = 0.0

    @property
    def pose(self) -> Pose:
        return Pose.from_yaw((*self.xy, TABLE_HEIGHT), self.yaw)

    def parts(self) -> list[tuple[np.ndarray, tuple[int, int, int]]]:
        """(bounds, colour): the body, and the dark end."""
        x, y, z = np.array(self.size) / 2
        end = tuple(c // 4 for c in self.colour)
        return [
            (np.array([[-x, -y, 0], [0.4 * x, y, 2 * z]]), self.colour),
            (np.array([[0.4 * x, -y, 0], [x, y, 2 * z]]), end),
        ]


@pytest.fixture(scope="session")
def camera() -> Camera:
    return Camera(640, 480, np.deg2rad(38), look_at((0, 0, TABLE_HEIGHT + 1.2), (0, 0, TABLE_HEIGHT), up=(0, 1, 0)))


@pytest.fixture(scope="session")
def background() -> np.ndarray:
    rng = np.random.default_rng(7)
    return np.clip(rng.normal((196, 170, 134), 3, (480, 640, 3)), 0, 255).astype(np.uint8)


@pytest.fixture(scope="session")
def things() -> list[Thing]:
    return [
        Thing("box", "packaging box", (0.24, 0.16, 0.09), (172, 128, 80), (0.12, 0.10), 0.0),
        Thing("marker_black", "black marker pen", (0.14, 0.02, 0.02), (70, 70, 74), (-0.30, 0.05), 0.4),
        Thing("marker_red", "red marker pen", (0.14, 0.02, 0.02), (220, 40, 40), (-0.10, -0.18), 1.1),
        Thing("eraser", "whiteboard eraser", (0.10, 0.05, 0.03), (40, 90, 200), (0.32, -0.14), -0.5),
    ]


@pytest.fixture(scope="session")
def moved(things: list[Thing]) -> list[Thing]:
    """The same things, rearranged as a picture editor might."""
    places = [((0.05, 0.08), 0.35), ((-0.22, 0.16), -0.3), ((-0.28, -0.10), 2.0), ((0.30, 0.15), 0.9)]
    return [replace(thing, xy=xy, yaw=yaw) for thing, (xy, yaw) in zip(things, places, strict=True)]


Paint = Callable[[Sequence[Thing]], tuple[np.ndarray, np.ndarray]]


@pytest.fixture(scope="session")
def paint(camera: Camera, background: np.ndarray) -> Paint:
    """Paints things over the table: (picture, segmentation with 1, 2, … in their order)."""

    def draw(things: Sequence[Thing]) -> tuple[np.ndarray, np.ndarray]:
        picture, segmentation = background.copy(), np.zeros(background.shape[:2], dtype=np.uint8)
        for number, thing in enumerate(things, start=1):
            for bounds, colour in thing.parts():
                corners = camera.project(thing.pose.apply(box_corners(*bounds)))
                for face in FACES:
                    shade = 1.0 if face == FACES[-1] else 0.8
                    polygon = np.round(corners[list(face)] * 16 - 8).astype(np.int32)
                    tint = tuple(round(shade * c) for c in colour)
                    cv2.fillConvexPoly(picture, polygon, tint, cv2.LINE_AA, shift=4)
                    cv2.fillConvexPoly(segmentation, polygon, number, shift=4)
        return picture, segmentation

    return draw


@pytest.fixture(scope="session")
def make_scene(camera: Camera) -> Callable[[Sequence[Thing]], Scene]:
    def make(things: Sequence[Thing]) -> Scene:
        objects = []
        for thing in things:
            half = np.array(thing.size) / 2
            bounds = np.array([[-half[0], -half[1], 0], [half[0], half[1], 2 * half[2]]])
            aabb = world_aabb(bounds, thing.pose)
            objects.append(
                ObjectRecord(
                    id=thing.id,
                    asset=thing.id,
                    variant="plain",
                    phrase=thing.phrase,
                    role="content",
                    pose=PoseRecord.of(thing.pose),
                    aabb=tuple(tuple(map(float, corner)) for corner in aabb),
                )
            )
        return Scene(
            provenance=Provenance(producer="test", seed=0),
            instruction="Pack the markers",
            template="test",
            robot="dual_panda",
            table=Table(),
            workspace=Workspace(lower=(-0.5, -0.3), upper=(0.5, 0.3)),
            top_camera=CameraRecord.of(camera),
            objects=objects,
            segmentation_ids={thing.id: number for number, thing in enumerate(things, start=1)},
        )

    return make


@pytest.fixture(scope="session")
def detect() -> Callable[[np.ndarray], list[Detection]]:
    """Detections from a segmentation, in reverse order so that order cannot match by luck."""

    def regions(segmentation: np.ndarray) -> list[Detection]:
        found = []
        for number in sorted(set(np.unique(segmentation)) - {0}, reverse=True):
            mask = segmentation == number
            v, u = np.nonzero(mask)
            found.append(Detection((u.min(), v.min(), u.max() + 1.0, v.max() + 1.0), mask, 0.9))
        return found

    return regions
