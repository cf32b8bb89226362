"""Statistics agree with numpy on the raw values."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from tests.recordings import clip
from vcage.datasets.lerobot.statistics import (
    QUANTILES,
    Moments,
    column_quantiles,
    picture_histogram,
    picture_statistics,
    vector_statistics,
)


def test_vector_statistics_have_one_number_per_column():
    values = np.random.default_rng(0).normal(size=(50, 3))
    found = vector_statistics(values)
    np.testing.assert_allclose(found["mean"], values.mean(0))
    np.testing.assert_allclose(found["q90"], np.quantile(values, 0.9, axis=0))
    assert found["count"] == [50]


def test_picture_statistics_from_added_histograms_match_all_pixels():
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


@given(
    hnp.arrays(np.float64, st.tuples(st.integers(2, 40), st.just(2)), elements=st.floats(-1e6, 1e6)),
    st.data(),
)
def test_moments_of_parts_add_up_to_the_whole(values, data):
    cut = data.draw(st.integers(1, len(values) - 1))
    moments = Moments()
    for part in (values[:cut], values[cut:]):
        moments.add(vector_statistics(part))
    found = moments.statistics()
    assert found["count"] == [len(values)]
    np.testing.assert_array_equal(found["min"], values.min(axis=0))
    np.testing.assert_array_equal(found["max"], values.max(axis=0))
    np.testing.assert_allclose(found["mean"], values.mean(axis=0), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(found["std"], values.std(axis=0), rtol=1e-6, atol=1e-6)


def test_moments_of_pictures_keep_their_shape():
    first, second = clip(5, seed=1), clip(7, seed=2)
    moments = Moments()
    for pictures in (first, second):
        moments.add(picture_statistics(picture_histogram(pictures), len(pictures)))
    whole = picture_statistics(picture_histogram(first) + picture_histogram(second), 12)
    for name in ("min", "max", "mean", "std", "count"):
        np.testing.assert_allclose(moments.statistics()[name], whole[name], atol=1e-12)


FLOATS = st.floats(width=32, allow_nan=False, allow_infinity=False)
SHAPES = st.tuples(st.integers(1, 60), st.integers(1, 3))


def quantiles(folder: Path, values: np.ndarray, dtype: str) -> np.ndarray:
    """Return those of a column in files of 25 rows."""
    files = []
    for start in range(0, len(values), 25):
        rows = pa.array(list(values[start : start + 25]), pa.list_(pa.from_numpy_dtype(values.dtype)))
        files.append(folder / f"{start}.parquet")
        pq.write_table(pa.table({"x": rows}), files[-1])
    return column_quantiles(files, {"x": {"dtype": dtype, "shape": [values.shape[1]]}})["x"]


def expected(values: np.ndarray) -> np.ndarray:
    return np.quantile(values.astype(np.float64), list(QUANTILES.values()), axis=0)


@settings(deadline=None, max_examples=40)
@given(hnp.arrays(np.float32, SHAPES, elements=FLOATS))
def test_quantiles_of_any_floats_are_exact(tmp_path_factory, values):
    found = quantiles(tmp_path_factory.mktemp("q"), values, "float32")
    np.testing.assert_allclose(found, expected(values), rtol=1e-12)


@settings(deadline=None, max_examples=40)
@given(hnp.arrays(np.int64, SHAPES, elements=st.integers(-(2**40), 2**40)))
def test_quantiles_of_any_integers_are_exact(tmp_path_factory, values):
    found = quantiles(tmp_path_factory.mktemp("q"), values, "int64")
    np.testing.assert_allclose(found, expected(values), rtol=1e-12)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_few_rows_have_quantiles_too(tmp_path, count):
    values = np.arange(count, dtype=np.float32)[:, None] - 1
    np.testing.assert_allclose(quantiles(tmp_path, values, "float32"), expected(values))
