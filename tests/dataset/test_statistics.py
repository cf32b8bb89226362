"""Statistics agree with numpy on the raw values."""

from __future__ import annotations

import numpy as np

from tests.recordings import clip
from vcage.dataset.statistics import picture_histogram, picture_statistics, vector_statistics


def test_vector_statistics_have_one_number_per_column():
    values = np.random.default_rng(0).normal(size=(50, 3))
    found = vector_statistics(values)
    np.testing.assert_allclose(found["mean"], values.mean(0))
    np.testing.assert_allclose(found["q90"], np.quantile(values, 0.9, axis=0))
    assert found["count"] == [50]


def test_picture_statistics_from_added_histograms_are_those_of_all_pixels():
    first, second = clip(5, seed=1), clip(7, seed=2)
    found = picture_statistics(picture_histogram(first) + picture_histogram(second), 12)
    pixels = np.concatenate([first, second]).reshape(-1, 3) / 255
    assert np.shape(found["mean"]) == (3, 1, 1)
    assert found["count"] == [12]
    for name, expected in {
        "min": pixels.min(0),
        "max": pixels.max(0),
        "mean": pixels.mean(0),
        "std": pixels.std(0),
        "q50": np.quantile(pixels, 0.5, axis=0, method="inverted_cdf"),
    }.items():
        np.testing.assert_allclose(np.ravel(found[name]), expected, atol=1e-9)
