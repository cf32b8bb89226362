from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from vcage.vision.register import Registered, register, unpadded
from vcage.vision.register_edges import Axis, warp_of

WIDTH, HEIGHT = 640, 480
POINTS = np.array([[u, v, 1.0] for u in (100, 320, 540) for v in (90, 240, 390)])


@pytest.fixture(scope="module")
def table() -> np.ndarray:
    """An empty table of plain colour on the ground, with the table's shadow in front of it."""
    picture = np.full((HEIGHT, WIDTH, 3), (142, 138, 134), np.uint8)
    picture[440:, 150:628] = (103, 101, 102)
    picture[40:440] = (226, 222, 218)
    noise = np.random.default_rng(3).normal(0, 1, picture.shape)
    return np.clip(cv2.GaussianBlur(picture, (0, 0), 0.7) + noise, 0, 255).astype(np.uint8)


def with_objects(table: np.ndarray, seed: int) -> np.ndarray:
    picture, rng = table.copy(), np.random.default_rng(seed)
    for _ in range(7):
        centre = tuple(int(x) for x in rng.uniform((80, 100), (560, 380)))
        size = tuple(float(x) for x in rng.uniform(25, 80, 2))
        corners = cv2.boxPoints((centre, size, float(rng.uniform(0, 180)))).astype(np.int32)
        cv2.fillConvexPoly(picture, corners, [int(x) for x in rng.integers(0, 255, 3)], cv2.LINE_AA)
    return picture


def repainted(picture: np.ndarray, table: np.ndarray) -> np.ndarray:
    """The picture with the table, where it shows, of another colour and without the grain of its own."""
    noise = np.random.default_rng(9).normal(0, 1, table.shape)
    painted = np.clip(np.array([88, 96, 120]) + noise, 0, 255).astype(np.uint8)
    shown = (np.abs(picture.astype(int) - table).max(axis=2) < 8) & (table.mean(axis=2) > 190)
    return np.where(shown[..., None], painted, picture)


@pytest.fixture(scope="module")
def source(table: np.ndarray) -> np.ndarray:
    return with_objects(table, 1)


@pytest.fixture(scope="module")
def target(table: np.ndarray) -> np.ndarray:
    return with_objects(table, 2)


def seen_through(
    picture: np.ndarray, window: tuple[float, ...], size: tuple[int, int]
) -> tuple[np.ndarray, np.ndarray]:
    """The part of a picture in a window (u0, v0, u1, v1), at (width, height); and the matrix that took it there."""
    warp = warp_of(tuple(Axis.between((window[k], window[k + 2]), (0, size[k])) for k in (0, 1)))
    return cv2.warpAffine(picture, warp, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE), warp


def error(found: Registered, warp: np.ndarray) -> float:
    """Pixels of the source by which known points are off, at most."""
    there = np.c_[POINTS @ warp.T, np.ones(len(POINTS))]
    return float(np.linalg.norm(there @ found.warp.T - POINTS[:, :2], axis=1).max())


def test_a_picture_of_the_same_size_is_unchanged(source, target, table) -> None:
    found = register(target, source, table)
    assert np.array_equal(found.picture, target) and found.valid.all() and found.notes == []
    assert np.array_equal(found.warp, np.eye(3)[:2])


@settings(max_examples=6, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(light=st.floats(-30, 20), contrast=st.floats(0.75, 1.1), tint=st.floats(0.88, 1.1), seed=st.integers(0, 9))
def test_light_colour_and_noise_move_nothing(source, target, table, light, contrast, tint, seed) -> None:
    noise = np.random.default_rng(seed).normal(0, 3, target.shape)
    drifted = ((target.astype(float) - 128) * contrast + 128 + light) * [1, tint, 1 / tint] + noise
    found = register(np.clip(drifted, 0, 255).astype(np.uint8), source, table)
    assert error(found, np.eye(3)[:2]) <= 1


@pytest.mark.parametrize("size", [(1024, 1024), (1344, 768), (320, 240), (1280, 960)])
def test_a_stretched_picture_comes_back_in_the_size_of_the_source(source, target, table, size) -> None:
    stretched, warp = seen_through(target, (0, 0, WIDTH, HEIGHT), size)
    found = register(stretched, source, table)
    assert found.picture.shape == source.shape and error(found, warp) <= 1
    assert np.abs(found.picture.astype(int) - target).mean() < 6


@settings(max_examples=6, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    zoom=st.floats(0.94, 1.08),
    across=st.floats(0.3, 0.7),
    size=st.sampled_from([(640, 480), (1024, 768), (512, 384)]),
)
def test_a_zoomed_picture_is_laid_over_the_table_by_its_edges(source, target, table, zoom, across, size) -> None:
    width, height = WIDTH * zoom, HEIGHT * zoom
    u0, v0 = (WIDTH - width) * across, (HEIGHT - height) / 2
    zoomed, warp = seen_through(target, (u0, v0, u0 + width, v0 + height), size)
    assert error(register(zoomed, source, table), warp) <= 2


@pytest.mark.parametrize(("window", "size"), [((0, 24, 640, 456), (1280, 864)), ((40, 0, 600, 480), (1120, 960))])
def test_a_crop_to_another_aspect_is_undone(source, target, table, window, size) -> None:
    cropped, warp = seen_through(target, window, size)
    assert error(register(cropped, source, table), warp) <= 2


def test_a_crop_of_a_repainted_table_is_found_by_the_edges_and_centred(source, target, table) -> None:
    painted = repainted(target, table)
    cropped, warp = seen_through(painted, (16, 12, 624, 468), (640, 480))
    found = register(cropped, source, table)
    assert error(found, warp) <= 2 and "taken to be centred" in found.notes[0]


def test_planks_are_not_taken_for_the_edges_of_the_table(source, table) -> None:
    planks = table.copy()
    for k, v in enumerate(range(60, 480, 70)):
        planks[v : v + 70] = (150 + 12 * (k % 2), 105, 60)
    # The back edge lies beyond the picture, and a plank begins about where it should be.
    cropped, _ = seen_through(planks, (30, 50, 610, 485), (640, 480))
    found = register(cropped, source, table)
    assert "not seen well enough" in found.notes[0] and np.array_equal(found.warp, np.eye(3)[:2])


def test_where_the_table_shows_all_four_edges_they_say_everything(source, table) -> None:
    island = np.full_like(table, (142, 138, 134))
    island[28:452, 34:606] = (226, 222, 218)
    painted = np.full_like(table, (120, 128, 131))
    painted[28:452, 34:606] = (90, 60, 40)
    cropped, warp = seen_through(painted, (12, 9, 628, 471), (1024, 768))
    found = register(cropped, source, island)
    assert error(found, warp) <= 1 and "not" not in found.notes[0]


def test_a_letterboxed_picture_loses_its_padding(source, target, table) -> None:
    content, warp = seen_through(target, (0, 0, WIDTH, HEIGHT), (1024, 768))
    padded = np.full((1024, 1024, 3), 12, np.uint8)
    padded[100:868] = content
    found = register(padded, source, table)
    assert error(found, warp + [[0, 0, 0], [0, 0, 100]]) <= 1.5


def test_where_a_smaller_view_shows_nothing_the_empty_table_is(source, target, table) -> None:
    cut, warp = seen_through(target, (20, 15, 620, 465), (640, 480))
    found = register(cut, source, table)
    assert error(found, warp) <= 2 and not found.valid.all()
    assert np.array_equal(found.picture[~found.valid], table[~found.valid])
    assert "laid over the table" in found.notes[0]


def test_a_picture_without_a_table_is_resized_with_a_note(source, table) -> None:
    noise = np.random.default_rng(0).integers(0, 255, (300, 300, 3), dtype=np.uint8)
    found = register(noise, source, table)
    assert found.picture.shape == source.shape and "not seen well enough" in found.notes[0]


@pytest.mark.parametrize("value", [0, 128, 255])
def test_a_picture_of_one_colour_or_one_pixel_is_resized_with_a_note(source, table, value) -> None:
    for shape in ((480, 640, 3), (1, 1, 3), (1, 900, 3)):
        found = register(np.full(shape, value, np.uint8), source, table)
        assert found.picture.shape == source.shape and np.isfinite(found.warp).all() and found.notes


@pytest.mark.parametrize(
    "made",
    [np.zeros((0, 0, 3), np.uint8), np.zeros((4, 4), np.uint8), np.zeros((4, 4, 4), np.uint8), np.zeros((4, 4, 3))],
)
def test_anything_but_a_colour_picture_is_refused(made, source, table) -> None:
    with pytest.raises(ValueError, match=r"expected an \(h, w, 3\) uint8 picture"):
        register(made, source, table)


def test_source_and_background_have_one_size(source, table) -> None:
    with pytest.raises(ValueError, match="differ in size"):
        register(source, source, table[:-1])


def test_padding_has_one_colour_along_a_whole_border() -> None:
    picture = np.random.default_rng(0).integers(0, 255, (60, 80, 3), dtype=np.uint8)
    picture[:7], picture[55:] = 9, 200
    assert unpadded(picture) == (0, 7, 80, 55)
    assert unpadded(picture.transpose(1, 0, 2)) == (7, 0, 55, 80)
