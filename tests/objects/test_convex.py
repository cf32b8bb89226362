"""Convex polyhedra as half-spaces."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vcage.base.errors import DamagedFile
from vcage.base.geometry import box_corners
from vcage.objects.convex import Convex, load_convex

CUBE = Convex.of(box_corners((0, 0, 0), (1, 1, 1)))


def test_volume_of_a_cube_is_one() -> None:
    assert CUBE.volume == pytest.approx(1)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_a_lines_interval_begins_and_ends_on_the_surface(seed: int) -> None:
    rng = np.random.default_rng(seed)
    solid = Convex.of(rng.normal(size=(12, 3)))
    origin, direction = solid.vertices.mean(axis=0), rng.normal(size=3)
    start, end = solid.interval(origin, direction)
    assert start < 0 < end
    for t in (start, end):
        assert solid.outside(origin + t * direction) == pytest.approx(0, abs=1e-9)


def test_a_line_that_misses_has_no_interval() -> None:
    assert CUBE.interval((2, 2, 2), (0, 0, 1)) is None


def test_the_shadow_of_a_slice_is_the_slices_outline() -> None:
    pyramid = Convex.of([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (0, 0, 1)])
    shadow = pyramid.shadow(0.5)
    np.testing.assert_allclose([shadow.min(axis=0), shadow.max(axis=0)], [[-0.5, -0.5], [0.5, 0.5]], atol=1e-9)
    assert len(pyramid.shadow(1.5)) == 0


@pytest.mark.parametrize("text", ["", "v 0 0 0\nv 1 0 0\n", "v a b c\n"])
def test_a_damaged_file_is_named(tmp_path: Path, text: str) -> None:
    path = tmp_path / "hull-00.obj"
    path.write_text(text)
    with pytest.raises(DamagedFile, match=r"hull-00\.obj"):
        load_convex(path)
