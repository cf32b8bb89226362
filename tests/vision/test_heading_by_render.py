from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from vcage.base.geometry import Camera, Pose
from vcage.schema.asset import PhysicalModel
from vcage.sim.drawer import Drawing, Window
from vcage.vision.colour import LabImage
from vcage.vision.heading_by_render import SETTINGS, settle_heading

MOVED = np.array([-0.2, 0.1, 1.3, 0.0])


class PaintedDrawer:
    """Draws a painted thing as a renderer would."""

    def __init__(self, thing, paint):
        self._thing, self._paint = thing, paint

    def model(self, object_id: str) -> PhysicalModel:
        x, y, z = self._thing.size
        lower, upper = (-x / 2, -y / 2, 0.0), (x / 2, y / 2, z)
        return PhysicalModel(visual="none", hulls=["none"], lower=lower, upper=upper, mass=1.0, friction=1.0)

    def draw(self, object_id: str, pose: Pose, camera: Camera, window: Window) -> Drawing:
        picture, segmentation = self._paint([replace(self._thing, xy=tuple(pose.p[:2]), yaw=pose.yaw)])
        scale = np.array(
            [[1 / window.step, 0, -window.left / window.step], [0, 1 / window.step, -window.top / window.step]]
        )
        size = (window.side, window.side)
        covered = cv2.warpAffine(segmentation, scale, size, flags=cv2.INTER_NEAREST) > 0
        return Drawing(cv2.warpAffine(picture, scale, size), covered, np.ones(size, np.float32))


@pytest.fixture(scope="module")
def block(things):
    """A square block whose one end is dark."""
    return replace(things[0], size=(0.09, 0.09, 0.04), xy=(0.1, 0.05))


def target(block, paint, slope: float = 1.0) -> LabImage:
    picture, segmentation = paint([replace(block, xy=(MOVED[0], MOVED[1]), yaw=MOVED[2])])
    lit = np.clip(picture * np.linspace(1 / slope, slope, picture.shape[1])[None, :, None], 0, 255).astype(np.uint8)
    return LabImage.of(lit, (segmentation > 0).astype(np.float32))


def settled(block, paint, make_scene, camera, image: LabImage, start: np.ndarray, order: int = 1) -> np.ndarray:
    record = make_scene([block]).objects[0]
    return settle_heading(image, camera, record, start, PaintedDrawer(block, paint), order)


@pytest.mark.parametrize("away", [np.pi, -1.1, 0.0])
@pytest.mark.parametrize("slope", [1.0, 1.3])
def test_pose_and_heading_are_found_from_any_heading_in_any_light(block, paint, make_scene, camera, away, slope):
    start = MOVED + [0.006, -0.004, away, 0]
    pose = settled(block, paint, make_scene, camera, target(block, paint, slope), start)
    assert abs((pose[2] - MOVED[2] + np.pi) % (2 * np.pi) - np.pi) < np.deg2rad(2)
    assert np.hypot(*(pose[:2] - MOVED[:2])) < 0.001


def test_a_print_that_the_drawings_show_overrules_a_symmetry(block, paint, make_scene, camera):
    far = replace(block, yaw=-1.5)
    pose = settled(far, paint, make_scene, camera, target(block, paint), MOVED + [0, 0, 1.5, 0], order=2)
    assert abs((pose[2] - 1.5 - MOVED[2] + np.pi) % (2 * np.pi) - np.pi) < np.deg2rad(2)


def test_of_headings_that_look_the_same_the_smallest_turn_is_taken(block, paint, make_scene, camera):
    plain = replace(block, colour=(0, 0, 0))  # its end is no darker
    pose = settled(plain, paint, make_scene, camera, target(plain, paint), MOVED + [0, 0, np.pi, 0], order=4)
    assert abs(pose[2]) <= np.pi / 4 + 1e-9


def test_where_nothing_is_to_be_seen_the_object_stays_near(block, paint, make_scene, camera):
    empty = LabImage(np.full((480, 640, 3), 50, np.float32), np.zeros((480, 640), np.float32))
    pose = settled(block, paint, make_scene, camera, empty, MOVED)
    assert np.all(np.isfinite(pose))
    assert np.hypot(*(pose[:2] - MOVED[:2])) <= SETTINGS.farthest_m + 1e-9


def test_an_object_beyond_the_pictures_edge_is_settled_without_failing(block, paint, make_scene, camera):
    start = np.array([0.6, 0.4, 0.0, 0.0])
    pose = settled(block, paint, make_scene, camera, target(block, paint), start)
    assert np.all(np.isfinite(pose))
