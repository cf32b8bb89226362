"""Painting: normals and texture coordinates."""

from __future__ import annotations

import numpy as np
import pytest

from vcage.objects.modelling import mappings, solids
from vcage.objects.modelling.parts import paint

GREY = np.full((4, 4, 3), 128, dtype=np.uint8)


def test_a_box_keeps_flat_faces() -> None:
    part = paint(solids.box((1, 1, 1)), GREY, mappings.tiled(1.0))
    assert set(np.abs(part.normals).max(axis=1).round(6)) == {1.0}


def test_a_sphere_has_smooth_normals() -> None:
    part = paint(solids.ellipsoid((1, 1, 1), count=32), GREY, mappings.tiled(1.0))
    np.testing.assert_allclose(
        part.normals, part.vertices / np.linalg.norm(part.vertices, axis=1, keepdims=True), atol=0.06
    )


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_wrapping_around_never_crosses_the_picture_backwards(axis: int) -> None:
    solid = solids.revolved([(0, 0), (1, 0), (1, 1), (0, 1)], 24)
    turn = {0: (90, (0, 1, 0)), 1: (90, (1, 0, 0)), 2: (0, (0, 0, 1))}[axis]
    solid = solids.moved(solid, turn=turn[0], axis=turn[1])
    part = paint(solid, GREY, mappings.around(axis))
    u = part.uv[part.faces, 0]
    assert np.ptp(u, axis=1).max() < 0.1


def _handedness(mapping: mappings.Mapping, normal: tuple[float, float, float]) -> float:
    """Sign of a triangle's area in the picture, its corners counter-clockwise as seen from outside."""
    z = np.array(normal, dtype=np.float64)
    x = np.cross((0, 0, 1) if abs(z[2]) < 0.5 else (0, 1, 0), z)
    y = np.cross(z, x)
    frame = np.array([z * 2, z * 2 + 0.1 * x, z * 2 + 0.1 * y])
    spread = np.array([[(-3, -3, -3), (3, 3, 3), (3, -3, 3)]], dtype=np.float64)  # gives the bounds a size
    a, b, c = mapping(np.concatenate([frame[None], spread]), np.array([normal, (0, 0, 1)], dtype=np.float64))[0]
    return float(np.sign(np.cross(b - a, c - a)))


@pytest.mark.parametrize(
    ("mapping", "normal"),
    [
        (mappings.from_above(), (0, 0, 1)),
        (mappings.from_front(), (0, -1, 0)),
        (mappings.around(0), (0, 0, 1)),
        (mappings.around(1), (0, 0, 1)),
        (mappings.around(2), (0, -1, 0)),
        *[(mappings.six_sides(), tuple(n)) for n in np.concatenate([np.eye(3), -np.eye(3)])],
    ],
)
def test_letters_are_not_mirrored(mapping: mappings.Mapping, normal: tuple[float, float, float]) -> None:
    assert _handedness(mapping, normal) > 0
