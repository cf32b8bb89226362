"""Boxes without a lid."""

from __future__ import annotations

import numpy as np
import pytest

from assets.shapes.open_box import open_box


def test_an_open_box_holds_as_much_air_as_its_pieces_leave() -> None:
    shell, hulls = open_box((0.1, 0.06), 0.005, 0.004, 0.03, 0.006)
    np.testing.assert_allclose(shell.extents, (0.11, 0.07, 0.03), atol=1e-9)
    np.testing.assert_allclose(np.concatenate([h.vertices for h in hulls]).max(axis=0), (0.055, 0.035, 0.03), atol=1e-9)
    assert shell.volume == pytest.approx(0.11 * 0.07 * 0.03 - 0.1 * 0.06 * 0.026, rel=0.03)
