"""How target pictures are changed and objects brought together, on painted pictures and boxes alone."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
import shapely

from benchmarks._match import changes
from benchmarks._match.scenes import Thing, _outline, scatter
from benchmarks._match.views import symmetry_of
from tests.example_scenes import library, template


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(3)


def painted(seed: int = 0) -> np.ndarray:
    noise = np.random.default_rng(seed).integers(60, 200, (480, 640, 3), dtype=np.uint8)
    return cv2.GaussianBlur(noise, (0, 0), 4)


@pytest.mark.parametrize("change", [changes.drift_colours, changes.soften])
def test_a_change_is_the_same_for_the_same_seed(change):
    first, done = change(painted(), np.random.default_rng(5))
    second, again = change(painted(), np.random.default_rng(5))
    np.testing.assert_array_equal(first, second)
    assert done == again


def test_a_warp_moves_nothing_farther_than_it_says(rng: np.random.Generator):
    grid = np.zeros((480, 640, 3), np.uint8)
    cv2.circle(grid, (320, 240), 9, (255, 255, 255), cv2.FILLED)
    bent, done = changes.bend(grid, {}, {}, rng)
    v, u = np.nonzero(bent[..., 0] > 127)
    assert np.hypot(u.mean() - 320, v.mean() - 240) <= done["warp_px"] + 0.2
    assert 2 <= done["warp_px"] <= 4


def test_an_object_is_scaled_about_its_centre():
    mask = np.zeros((480, 640), bool)
    mask[200:280, 280:360] = True
    picture = np.where(mask[..., None], 255, 0).astype(np.uint8).repeat(3, axis=2)
    field = changes._scale_field((480, 640), {"a": mask}, {"a": np.array([320.0, 240.0])}, {"a": 1.06})
    v, u = np.mgrid[:480, :640].astype(np.float32)
    scaled = cv2.remap(picture, u + field[..., 0], v + field[..., 1], cv2.INTER_LINEAR)
    rows, columns = np.nonzero(scaled[..., 0] > 127)
    assert np.ptp(columns) + 1 == pytest.approx(80 * 1.06, abs=1.5)
    assert (columns.mean(), rows.mean()) == pytest.approx((319.5, 239.5), abs=0.3)


def test_a_shadow_falls_beside_the_object_and_darkens_the_table(rng: np.random.Generator):
    mask = np.zeros((480, 640), bool)
    mask[200:280, 280:360] = True
    picture = np.full((480, 640, 3), 200, np.uint8)
    shaded, _ = changes.shade(picture, [(mask, 60.0)], mask, np.array([1.0, 0.0]), rng)
    assert shaded[240, 370, 0] < 195
    assert shaded[240, 240, 0] >= 198


def test_touching_things_touch_and_do_not_overlap(rng: np.random.Generator):
    things = [Thing(name, library().asset(name)) for name in ("mug", "banana", "stapler", "block")]
    place = template()
    poses = scatter(things, place.workspace, place.table, rng, groups=[["mug", "banana"]])
    shapes = {thing.id: _outline(thing.asset, poses[thing.id]) for thing in things}
    assert shapely.distance(shapes["mug"], shapes["banana"]) < 0.001
    assert shapes["mug"].intersection(shapes["banana"]).area < 2e-5
    assert shapely.distance(shapes["stapler"], shapes["block"]) > 0.005


def view(paint) -> np.ndarray:
    picture = np.zeros((201, 201, 4), np.uint8)
    paint(picture)
    return picture


@pytest.mark.parametrize(
    ("paint", "order"),
    [
        (lambda p: cv2.circle(p, (100, 100), 80, (200, 60, 60, 255), cv2.FILLED), 0),
        (lambda p: cv2.rectangle(p, (40, 40), (160, 160), (200, 60, 60, 255), cv2.FILLED), 4),
        (lambda p: cv2.rectangle(p, (40, 70), (160, 130), (200, 60, 60, 255), cv2.FILLED), 2),
        (lambda p: cv2.ellipse(p, (100, 100), (80, 80), 0, 0, 200, (200, 60, 60, 255), cv2.FILLED), 1),
    ],
    ids=["disc", "square", "rectangle", "part of a disc"],
)
def test_symmetry_of_painted_shapes(paint, order: int):
    assert symmetry_of(view(paint)) == order


def test_a_mark_on_a_disc_breaks_its_symmetry():
    def paint(picture: np.ndarray) -> None:
        cv2.circle(picture, (100, 100), 80, (200, 60, 60, 255), cv2.FILLED)
        cv2.circle(picture, (140, 100), 25, (20, 20, 200, 255), cv2.FILLED)

    assert symmetry_of(view(paint)) == 1


@pytest.mark.parametrize(("mark", "order"), [((204, 64, 64), 0), ((230, 110, 110), 1)], ids=["pale", "plain to see"])
def test_only_a_mark_that_the_top_camera_sees_breaks_the_symmetry_of_a_disc(mark: tuple[int, int, int], order: int):
    def paint(picture: np.ndarray) -> None:
        cv2.circle(picture, (100, 100), 80, (200, 60, 60, 255), cv2.FILLED)
        cv2.circle(picture, (140, 100), 25, (*mark, 255), cv2.FILLED)

    assert symmetry_of(view(paint)) == order


def test_nothing_has_no_symmetry():
    assert symmetry_of(np.zeros((20, 20, 4), np.uint8)) == 1
