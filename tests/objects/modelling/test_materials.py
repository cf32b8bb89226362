"""Materials are painted in the colour that was asked for."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials


def test_colours_survive() -> None:
    red = materials.plastic(np.random.default_rng(0), (200, 30, 40))
    np.testing.assert_allclose(red.reshape(-1, 3).mean(axis=0), (200, 30, 40), atol=8)
