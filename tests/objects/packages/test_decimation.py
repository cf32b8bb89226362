"""Fewer triangles, with colours and pictures where they were."""

from __future__ import annotations

import numpy as np
import trimesh

from vcage.objects.packages.decimation import DecimationSettings, decimated, transferred
from vcage.objects.packages.surfaces import MaterialSurface, plain


def sheet(cells: int, shift: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Triangles (m, 3, 3) of a square sheet 10 cm wide, and uv (m, 3, 2) that are its x and y."""
    line = np.linspace(0, 0.1, cells + 1)
    x, y = (a.ravel() for a in np.meshgrid(line, line))
    points = np.column_stack([x + shift, y, np.zeros_like(x)])
    rows = [
        [i * (cells + 1) + j for i, j in ((r, c), (r, c + 1), (r + 1, c + 1))]
        for r in range(cells)
        for c in range(cells)
    ]
    rows += [
        [i * (cells + 1) + j for i, j in ((r, c), (r + 1, c + 1), (r + 1, c))]
        for r in range(cells)
        for c in range(cells)
    ]
    corners = points[np.array(rows)]
    return corners, (corners[:, :, :2] - [shift, 0]) / 0.1


def test_few_triangles_are_left_alone() -> None:
    surface = MaterialSurface(sheet(3)[0], None, plain((1, 2, 3)))
    assert decimated([surface], DecimationSettings(max_triangles=100))[0] is surface


def test_all_surfaces_together_keep_to_the_limit() -> None:
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.05)
    surfaces = [MaterialSurface(np.asarray(ball.triangles), None, plain((9, 9, 9))) for _ in range(2)]
    fewer = decimated(surfaces, DecimationSettings(max_triangles=1000))
    assert 600 < sum(len(surface.corners) for surface in fewer) <= 1000


def test_a_decimated_ball_is_still_a_ball() -> None:
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.05)
    (fewer,) = decimated(
        [MaterialSurface(np.asarray(ball.triangles), None, plain((9, 9, 9)))], DecimationSettings(max_triangles=500)
    )
    radii = np.linalg.norm(fewer.corners.reshape(-1, 3), axis=1)
    np.testing.assert_allclose(radii, 0.05, atol=0.002)


def test_the_picture_stays_where_it_was() -> None:
    corners, uv = sheet(30)
    (fewer,) = decimated([MaterialSurface(corners, uv, plain((9, 9, 9)))], DecimationSettings(max_triangles=200))
    assert len(fewer.corners) <= 200
    np.testing.assert_allclose(fewer.uv, fewer.corners[:, :, :2] / 0.1, atol=0.01)


def test_no_triangle_spans_two_charts_of_the_picture() -> None:
    left, uv_left = sheet(8)
    right, uv_right = sheet(8, shift=0.1)
    new = np.array([[[0.02, 0.02, 0], [0.11, 0.02, 0], [0.02, 0.08, 0]]])
    uv = transferred(np.concatenate([left, right]), np.concatenate([uv_left, uv_right + 5]), new)
    assert uv.max() <= 1.0 + 1e-9
