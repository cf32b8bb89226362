"""Portraits: four views at one scale, with the points on them."""

from __future__ import annotations

import numpy as np
import pytest

from vcage.apps.gallery.renders import VIEWS, portrait
from vcage.objects.library import Library


@pytest.fixture(scope="module")
def block():
    return Library.load().asset("block", "red")


@pytest.fixture(scope="module")
def plain(block):
    return portrait(block, points=False)


def red_columns(picture: np.ndarray) -> int:
    """Width in pixels of what is clearly red."""
    red = (picture[..., 0] > 100) & (picture[..., 1] < 80) & (picture[..., 2] < 80)
    return int(red.any(axis=0).sum())


def test_there_are_three_sides_and_one_from_above(plain) -> None:
    assert list(plain) == ["front", "right", "back", "above"]


def test_all_views_have_one_scale(plain, block) -> None:
    expected = block.size[0] / VIEWS.metres_per_px
    for name, picture in plain.items():
        assert red_columns(picture) == pytest.approx(expected, abs=4), name


def test_points_are_drawn_on_the_picture(block, plain) -> None:
    assert all((picture != plain[name]).any() for name, picture in portrait(block).items())
