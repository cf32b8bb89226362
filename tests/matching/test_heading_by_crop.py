from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vcage.matching.heading_by_crop import correlation, pattern_of, settle, softened
from vcage.vision.object_templates import View, crop_of

MOVED = np.array([-0.2, 0.1, 1.3, 0.0])


@pytest.fixture(scope="module")
def block(things):
    """A square block whose one end is dark."""
    return replace(things[0], size=(0.09, 0.09, 0.04), xy=(0.1, 0.05))


@pytest.fixture(scope="module")
def seen(block, paint, make_scene, camera):
    """The source and the crop of the block in it."""
    picture, segmentation = paint([block])
    source = View.of(picture, (segmentation > 0).astype(np.float32))
    return source, crop_of(source, segmentation == 1, camera, make_scene([block]).objects[0])


def lit(picture: np.ndarray, slope: float) -> np.ndarray:
    """A picture whose light changes from left to right by a factor."""
    return np.clip(picture * np.linspace(1 / slope, slope, picture.shape[1])[None, :, None], 0, 255).astype(np.uint8)


def target(block, paint, slope: float = 1.0) -> View:
    picture, segmentation = paint([replace(block, xy=(MOVED[0], MOVED[1]), yaw=MOVED[2])])
    return View.of(lit(picture, slope), (segmentation > 0).astype(np.float32))


@pytest.mark.parametrize("away", [np.pi, np.pi / 2, -2.0, 0.0])
@pytest.mark.parametrize("slope", [1.0, 1.3])
def test_the_dark_end_is_found_from_any_heading_in_any_light(block, seen, paint, away, slope):
    source, crop = seen
    pose, terms = settle(target(block, paint, slope), softened(source), crop, MOVED + [0.003, 0, away, 0])
    assert abs((pose[2] - MOVED[2] + np.pi) % (2 * np.pi) - np.pi) < np.deg2rad(4)
    assert np.hypot(*(pose[:2] - MOVED[:2])) < 0.005
    assert terms.shape == (4,)


def test_a_pattern_correlates_with_itself_much_better_than_with_itself_reversed(block, seen, paint):
    source, crop = seen
    soft = softened(source)
    both = MOVED + np.array([[0, 0, 0, 0], [0, 0, np.pi, 0]])
    right, reversed_ = correlation(target(block, paint), crop, pattern_of(soft, crop), both)
    assert right > 0.85
    assert reversed_ < right - 0.3


def test_a_slope_of_the_light_does_not_change_the_correlation(block, seen, paint):
    source, crop = seen
    pattern = pattern_of(softened(source), crop)
    plain, sloped = (correlation(target(block, paint, s), crop, pattern, MOVED[None])[0] for s in (1.0, 1.2))
    assert sloped == pytest.approx(plain, abs=0.03)


def test_an_object_without_any_pattern_stays_where_it_is(seen):
    source, crop = seen
    empty = View(np.full_like(source.lab, 50.0), np.zeros_like(source.salience))
    pose, _ = settle(empty, softened(source), crop, MOVED)
    assert np.all(np.isfinite(pose))
    assert np.hypot(*(pose[:2] - MOVED[:2])) < 0.02
