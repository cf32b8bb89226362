"""Surfaces of a fetched model: turned, scaled, painted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from vcage.base.errors import DamagedFile
from vcage.objects.packages.surfaces import (
    SETTINGS,
    MaterialSurface,
    euler_rotation,
    opaque,
    part_of,
    plain,
    read_surfaces,
    stretched,
)

TRIANGLE = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])


def test_turns_are_made_about_x_then_y_then_z() -> None:
    np.testing.assert_allclose(euler_rotation((90, 0, 90)) @ [0, 1, 0], [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(euler_rotation((0, 0, 90)) @ [1, 0, 0], [0, 1, 0], atol=1e-12)


def test_surfaces_are_stretched_together() -> None:
    first, second = (
        MaterialSurface(TRIANGLE, None, plain((0, 0, 0))),
        MaterialSurface(TRIANGLE + 1, None, plain((0, 0, 0))),
    )
    points = np.concatenate([surface.corners.reshape(-1, 3) for surface in stretched([first, second], (0.1, 0.2, 0.3))])
    np.testing.assert_allclose(points.max(axis=0), (0.1, 0.2, 0.3))
    np.testing.assert_allclose(points.min(axis=0), 0)


def test_pictures_are_laid_over_white_and_made_small() -> None:
    clear = Image.new("RGBA", (2 * SETTINGS.max_edge_px, 10), (255, 0, 0, 0))
    assert opaque(clear).shape == (5, SETTINGS.max_edge_px, 3)
    assert opaque(clear)[0, 0].tolist() == [255, 255, 255]


def test_a_plain_colour_becomes_a_small_picture() -> None:
    part = part_of(MaterialSurface(TRIANGLE, None, plain((10, 20, 30))))
    assert part.texture.shape == (4, 4, 3) and part.texture[0, 0].tolist() == [10, 20, 30]
    np.testing.assert_allclose(part.normals, [[0, 0, 1]] * 3, atol=1e-9)


def test_a_file_without_triangles_is_damaged(tmp_path: Path) -> None:
    path = tmp_path / "empty.obj"
    path.write_text("v 0 0 0\n")
    with pytest.raises(DamagedFile, match=r"empty\.obj"):
        read_surfaces(path)
