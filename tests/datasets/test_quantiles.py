"""Quantiles by counting are those that numpy finds with everything in memory."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from vcage.datasets.quantiles import exact_quantiles

SHARES = [0.01, 0.1, 0.5, 0.9, 0.99]

FLOATS = st.floats(width=32, allow_nan=False, allow_infinity=False)
SHAPES = st.tuples(st.integers(1, 60), st.integers(1, 3))


class Source:
    """Rows of a column ``x`` in batches of ``size``; counts how often they were read."""

    def __init__(self, values: np.ndarray, size: int = 25):
        self.values, self.size, self.readings = values, size, 0

    def __call__(self, columns):
        assert columns == ["x"]
        self.readings += 1
        for start in range(0, len(self.values), self.size):
            yield {"x": self.values[start : start + self.size]}


def found(source: Source) -> np.ndarray:
    values = source.values
    return exact_quantiles(source, {"x": (values.min(axis=0), values.max(axis=0))}, len(values), SHARES)["x"]


def expected(values: np.ndarray) -> np.ndarray:
    return np.quantile(values.astype(np.float64), SHARES, axis=0)


@settings(deadline=None, max_examples=40)
@given(hnp.arrays(np.float32, SHAPES, elements=FLOATS))
def test_quantiles_of_any_floats_are_exact(values):
    np.testing.assert_allclose(found(Source(values)), expected(values), rtol=1e-12)


@settings(deadline=None, max_examples=40)
@given(hnp.arrays(np.int64, SHAPES, elements=st.integers(-(2**40), 2**40)))
def test_quantiles_of_any_integers_are_exact(values):
    np.testing.assert_allclose(found(Source(values)), expected(values), rtol=1e-12)


def test_floats_are_read_three_times_at_most():
    source = Source(np.random.default_rng(0).normal(size=(5000, 2)).astype(np.float32), 1000)
    np.testing.assert_allclose(found(source), expected(source.values), rtol=1e-12)
    assert source.readings <= 3


def test_a_column_that_never_changes_is_not_read():
    source = Source(np.full((50, 2), 0.25, np.float32))
    assert np.all(found(source) == 0.25)
    assert source.readings == 0


@pytest.mark.parametrize("count", [1, 2, 3])
def test_few_rows_have_quantiles_too(count):
    values = np.arange(count, dtype=np.float32)[:, None] - 1
    np.testing.assert_allclose(found(Source(values)), expected(values))
