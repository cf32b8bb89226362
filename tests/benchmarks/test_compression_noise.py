"""The model of a real camera: noise that follows the light, corners, exposure; the same for the same seed."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks._compression_noise import RealCamera

STILL = {"vignette": 0.0, "flicker": 0.0, "wander": 0.0}


def grey(level: int, count: int = 2) -> np.ndarray:
    return np.full((count, 48, 64, 3), level, np.uint8)


def film(frames: np.ndarray, full_well: float = 6000.0, **options: float) -> np.ndarray:
    return RealCamera(full_well, **{**STILL, **options}).film(frames)


def test_the_same_seed_gives_the_same_film() -> None:
    np.testing.assert_array_equal(film(grey(100), seed=3), film(grey(100), seed=3))


def test_no_two_frames_have_the_same_noise() -> None:
    first, second = film(grey(100))
    assert (first != second).mean() > 0.3


@pytest.mark.parametrize("colour", [(200, 120, 60), (40, 40, 40), (90, 150, 210)])
def test_colours_are_preserved(colour: tuple[int, int, int]) -> None:
    frames = np.tile(np.array(colour, np.uint8), (2, 48, 64, 1))
    np.testing.assert_allclose(film(frames).mean(axis=(0, 1, 2)), colour, atol=1.5)


def test_a_dim_room_is_noisier_than_a_well_lit_one() -> None:
    lit, dim = (film(grey(118), full_well).astype(float).std() for full_well in (6000.0, 1500.0))
    assert 1.5 < lit < 3 < dim < 6


def test_in_linear_light_bright_surfaces_are_noisier() -> None:
    def spread(level: int) -> float:
        return float(((film(grey(level), 1500.0) / 255.0) ** 2.2).std())

    assert spread(60) < spread(120) < spread(220)


def test_neighbouring_pixels_share_noise_as_behind_a_mosaic() -> None:
    noise = film(grey(118))[0, :, :, 0].astype(float)
    noise -= noise.mean()
    assert (noise[:, 1:] * noise[:, :-1]).mean() > 0.2 * noise.var()


def test_corners_are_darker_than_the_middle() -> None:
    picture = film(grey(150), vignette=0.3)[0].astype(float)
    assert picture[:6, :6].mean() < picture[20:28, 28:36].mean() - 10


def test_the_exposure_changes_from_frame_to_frame() -> None:
    levels = film(grey(150, 8), flicker=0.01, wander=0.02).mean(axis=(1, 2, 3))
    assert 0.2 < np.ptp(levels) < 20


def test_white_and_black_do_not_overflow() -> None:
    assert film(grey(255)).min() > 230
    assert film(grey(0)).max() < 40
