"""Grown and turned shapes: profiles, lobes, flat undersides, and mappings for domes and rings."""

from __future__ import annotations

import numpy as np
import pytest

from assets.shapes import lumps
from vcage.objects.modelling import solids


def test_a_smooth_profile_meets_its_ends_and_stays_between_its_knots() -> None:
    knots = np.array([(0.0, 0.0), (0.03, 0.01), (0.03, 0.05), (0.01, 0.08)])
    curve = lumps.smooth(knots, 50)
    np.testing.assert_allclose(curve[[0, -1]], knots[[0, -1]], atol=1e-12)
    assert curve[:, 0].max() <= 0.03 + 1e-9


def test_grooves_lie_between_the_lobes() -> None:
    body = lumps.lobed([(0.02, 0.0), (0.02, 0.05)], lobes=4, depth=0.1, count=40)
    radius = np.linalg.norm(body.vertices[:40, :2], axis=1)
    assert radius.max() == pytest.approx(0.02, rel=1e-3)
    assert radius.min() == pytest.approx(0.018, rel=1e-3)
    assert body.is_watertight


def test_a_lying_body_has_a_flat_underside_and_its_top_to_the_right() -> None:
    cone = solids.revolved([(0, 0), (0.02, 0), (0.001, 0.1), (0, 0.1)])
    body = lumps.lying(cone, 0.001)
    flat = body.vertices[np.abs(body.vertices[:, 2]) < 1e-9]
    assert len(flat) >= 3 and np.ptp(flat[:, 0]) > 0
    thick = body.vertices[np.abs(body.vertices[:, 1]) > 0.015]
    assert (thick[:, 0] < body.bounds[:, 0].mean()).all()


def test_a_standing_hull_has_a_foot() -> None:
    foot = lumps.standing(solids.ellipsoid((0.03, 0.03, 0.03), (0, 0, 0.03)), 0.01)
    flat = foot.vertices[np.abs(foot.vertices[:, 2]) < 1e-9]
    assert np.linalg.norm(flat[:, :2], axis=1).max() >= 0.01


def test_the_top_of_a_dome_is_the_middle_of_the_picture() -> None:
    corners = np.array([[(0, 0, 0.05), (0.05, 0, 0), (0, 0.05, 0)]])
    uv = lumps.over_dome((0, 0, 0), reach=90)(corners, np.zeros((1, 3)))[0]
    np.testing.assert_allclose(uv, [(0.5, 0.5), (1.0, 0.5), (0.5, 1.0)], atol=1e-9)


def test_the_top_of_a_ring_is_half_way_from_the_middle_of_the_picture() -> None:
    corners = np.array([[(0.03, 0, 0.02), (0.04, 0, 0.01), (0.02, 0, 0.01)]])
    uv = lumps.over_ring(0.03, 0.01)(corners, np.zeros((1, 3)))[0]
    np.testing.assert_allclose(uv[:, 0], [0.75, 0.875, 0.625], atol=1e-9)
