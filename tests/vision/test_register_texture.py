from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from vcage.vision.register_texture import grain, grain_fit

SCALES = [(s, s) for s in np.arange(0.86, 1.1, 0.015)]


def wood(seed: int, height: int = 240, width: int = 320) -> np.ndarray:
    noise = np.random.default_rng(seed).normal(0, 1, (height, width)).astype(np.float32)
    fine = cv2.GaussianBlur(noise, (0, 0), 2)
    return np.clip(128 + 12 * fine / fine.std(), 0, 255).astype(np.uint8)


@pytest.fixture(scope="module")
def table() -> np.ndarray:
    return wood(0)


@settings(max_examples=10, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(scale=st.floats(0.88, 1.08), u=st.floats(-12, 12), v=st.floats(-12, 12), gain=st.floats(0.6, 1.3))
def test_the_grain_says_how_a_picture_lies(table, scale, u, v, gain) -> None:
    shift = np.array([u, v]) + (1 - scale) * np.array([159.5, 119.5])
    warp = np.array([[scale, 0, shift[0]], [0, scale, shift[1]]])
    picture = cv2.warpAffine(table, warp, (320, 240), flags=cv2.WARP_INVERSE_MAP | cv2.INTER_LINEAR)
    picture = np.clip((picture.astype(float) - 128) * gain + 110, 0, 255).astype(np.uint8)
    cv2.circle(picture, (100, 90), 30, 20, -1)
    fit, turn = grain_fit(picture, table, SCALES)
    assert fit == pytest.approx([scale, scale, *shift], abs=0.6) and abs(turn) < 0.6


@pytest.mark.parametrize("seed", range(1, 5))
def test_another_grain_is_no_evidence(table, seed) -> None:
    assert grain_fit(wood(seed), table, SCALES) is None


@pytest.mark.parametrize("value", [0, 128, 255])
def test_an_even_picture_or_a_tiny_one_is_no_evidence(table, value) -> None:
    assert grain_fit(np.full_like(table, value), table, SCALES) is None
    tiny = np.full((1, 1), value, np.uint8)
    assert grain_fit(tiny, tiny, SCALES) is None


def test_the_grain_is_the_same_in_another_light(table) -> None:
    darker = (table * 0.5 + 20).astype(np.uint8)
    assert np.corrcoef(grain(table).ravel(), grain(darker).ravel())[0, 1] > 0.95
