"""Noise that textures are painted with: it repeats without a seam."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling.noise import clouds, noise


def test_noise_repeats_without_a_seam() -> None:
    picture = clouds(np.random.default_rng(0), (64, 96), (4, 6))
    for axis in (0, 1):
        steps = np.abs(np.diff(picture, axis=axis)).max()
        seam = np.abs(np.take(picture, 0, axis) - np.take(picture, -1, axis)).max()
        assert seam <= 1.5 * steps


def test_noise_stays_between_0_and_1() -> None:
    picture = noise(np.random.default_rng(1), (40, 50), (5, 7))
    assert picture.shape == (40, 50) and picture.min() >= 0 and picture.max() <= 1
