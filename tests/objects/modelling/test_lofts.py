"""Solids drawn through sections."""

from __future__ import annotations

import numpy as np
import pytest

from vcage.objects.modelling import lofts, solids

SQUARE = np.array([(-0.01, -0.01), (0.01, -0.01), (0.01, 0.01), (-0.01, 0.01)])


def test_a_levelled_solid_has_the_scaled_outline_at_each_level() -> None:
    solid = lofts.levelled(SQUARE, [(0.0, 1.0), (0.05, 0.5, 0.25)])
    top = solid.vertices[np.isclose(solid.vertices[:, 2], 0.05)]
    np.testing.assert_allclose(np.abs(top[:, :2]).max(axis=0), (0.005, 0.0025))
    assert solid.is_watertight and solid.volume > 0


def test_the_hull_of_levels_lies_on_the_solid() -> None:
    outline, levels = solids.circle(0.02, 40), [(0.0, 0.9), (0.01, 1.0), (0.06, 1.0)]
    solid, hull = lofts.levelled(outline, levels), lofts.levelled_hull(outline, levels)
    np.testing.assert_allclose(hull.bounds, solid.bounds, atol=1e-9)
    assert hull.volume == pytest.approx(solid.volume, rel=0.02)


@pytest.mark.parametrize(("raise_", "order"), [(lofts.across, (2, 0, 1)), (lofts.along_y, (1, 2, 0))])
def test_a_lying_prism_keeps_its_outline_and_faces_outwards(raise_, order) -> None:
    solid = raise_([(0.0, 0.0), (0.03, 0.0), (0.03, 0.02), (0.0, 0.02)], 0.1)
    np.testing.assert_allclose(solid.extents, np.array([0.03, 0.02, 0.1])[list(order)], atol=1e-7)
    assert solid.volume == pytest.approx(0.03 * 0.02 * 0.1)


def test_a_rod_lies_along_x_at_its_height() -> None:
    rod = lofts.rod(0.005, -0.02, 0.03, 0.01)
    np.testing.assert_allclose(rod.bounds[:, 0], (-0.02, 0.03))
    assert rod.bounds[:, 2].mean() == pytest.approx(0.01)
