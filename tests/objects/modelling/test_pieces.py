"""Convex pieces for physics."""

from __future__ import annotations

import numpy as np
import pytest

from vcage.objects.modelling import pieces


def test_a_prism_across_x_takes_its_corners_in_any_order() -> None:
    prism = pieces.across([(0.0, 0.0), (0.03, 0.02), (0.03, 0.0), (0.0, 0.02)], 0.1)
    np.testing.assert_allclose(prism.bounds, [(-0.05, 0.0, 0.0), (0.05, 0.03, 0.02)], atol=1e-12)
    assert prism.volume == pytest.approx(0.1 * 0.03 * 0.02)


def test_a_ring_leaves_the_room_inside_free() -> None:
    wedges = pieces.ring([(0.02, 0.0), (0.025, 0.0), (0.025, 0.03), (0.02, 0.03)])
    inside = min(np.hypot(*wedge.vertices[:, :2].T).min() for wedge in wedges)
    assert inside >= 0.02 - 1e-12
    assert max(wedge.bounds[1, 0] for wedge in wedges) == pytest.approx(0.025)
