"""Quantiles by counts: close to exact ones, the same for any order of parts, and kept in a file."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from tests.datasets.conftest import add, write
from vcage.base.errors import DamagedFile
from vcage.datasets.lerobot import statistics, value_counts
from vcage.datasets.lerobot.statistics import StatisticsSettings
from vcage.datasets.lerobot.value_counts import VALUE_COUNTS, CountingSettings, ValueCounts

SHARES = [0.0, 0.01, 0.1, 0.5, 0.9, 0.99, 1.0]
RELATIVE = 2.0**-10
VALUES = hnp.arrays(
    np.float64, st.tuples(st.integers(1, 60), st.integers(1, 3)), elements=st.floats(-1e6, 1e6, width=32)
)


def counted(*parts: np.ndarray) -> ValueCounts:
    counts = ValueCounts()
    for part in parts:
        counts.add({"x": part})
    return counts


@settings(deadline=None, max_examples=60)
@given(VALUES)
def test_a_quantile_lies_as_near_as_the_values_around_it_are_told_apart(values):
    found, below = counted(values).quantiles("x", SHARES), np.quantile(values, SHARES, axis=0, method="lower")
    above = np.quantile(values, SHARES, axis=0, method="higher")
    room = RELATIVE * np.maximum(np.abs(below), np.abs(above)) + 1e-12
    assert np.all(found >= below - room) and np.all(found <= above + room)


@settings(deadline=None, max_examples=40)
@given(VALUES, st.integers(0, 60))
def test_parts_in_any_order_count_like_the_whole(values, cut):
    whole, parts = counted(values), counted(values[cut:][::-1], values[:cut])
    np.testing.assert_array_equal(whole.quantiles("x", SHARES), parts.quantiles("x", SHARES))


def test_few_different_values_have_exact_quantiles():
    values = np.array([0.0, 1.0, 0.0, -0.0, 1.0, 0.5, 1.0])[:, None]
    np.testing.assert_array_equal(counted(values).quantiles("x", SHARES), np.quantile(values, SHARES, axis=0))


def test_batches_change_nothing(monkeypatch):
    values = np.random.default_rng(0).normal(size=(500, 3))
    whole = counted(values).quantiles("x", SHARES)
    monkeypatch.setattr(value_counts, "SETTINGS", CountingSettings(batch_frames=7))
    np.testing.assert_array_equal(counted(*np.array_split(values, 90)).quantiles("x", SHARES), whole)


def test_counts_come_back_from_their_file(tmp_path):
    counts = counted(np.random.default_rng(0).normal(size=(300, 2)))
    counts.add({"y": np.arange(50)[:, None]})
    counts.write(tmp_path / "counts.parquet")
    back = ValueCounts.read(tmp_path / "counts.parquet", ["x", "y"])
    for name in ("x", "y"):
        np.testing.assert_array_equal(back.quantiles(name, SHARES), counts.quantiles(name, SHARES))
    with pytest.raises(DamagedFile, match="no counts of z"):
        ValueCounts.read(tmp_path / "counts.parquet", ["z"])


# --- in a data set -------------------------------------------------------------------------------------


def quantiles(root: Path) -> dict[str, list[float]]:
    return json.loads((root / "meta/stats.json").read_text())["action"]


@pytest.fixture
def counting(monkeypatch) -> None:
    """A data set is large from 15 frames on."""
    monkeypatch.setattr(statistics, "SETTINGS", StatisticsSettings(exact_frames=15))


def test_a_large_data_set_has_counts_and_close_quantiles(counting, episodes, tmp_path):
    root = write("lerobot-v3.0", tmp_path / "set", episodes)
    assert (root / VALUE_COUNTS).is_file()
    values = np.array(pq.read_table(root / "data")["action"].to_pylist())
    for name, share in statistics.QUANTILES.items():
        np.testing.assert_allclose(quantiles(root)[name], np.quantile(values, share, axis=0), rtol=2e-3, atol=1e-9)


def test_a_large_data_set_grows_without_its_frames_being_read(counting, episodes, tmp_path, monkeypatch):
    root = write("lerobot-v3.0", tmp_path / "set", episodes)
    monkeypatch.setattr(statistics, "read_batches", lambda files, _: [pytest.fail(f"{file} is read") for file in files])
    add("lerobot-v3.0", root, episodes)
    once = write("lerobot-v3.0", tmp_path / "once", [*episodes, *episodes])
    for name in statistics.QUANTILES:
        assert quantiles(root)[name] == quantiles(once)[name]


@pytest.mark.usefixtures("counting")
def test_a_data_set_that_becomes_large_counts_its_first_frames_too(episodes, tmp_path):
    root = write("lerobot-v3.0", tmp_path / "set", episodes[:1])
    assert not (root / VALUE_COUNTS).exists()
    add("lerobot-v3.0", root, episodes[1:])
    once = write("lerobot-v3.0", tmp_path / "once", episodes)
    assert quantiles(root)["q50"] == quantiles(once)["q50"]


def test_a_large_data_set_of_others_is_counted_once(counting, episodes, tmp_path):
    root = write("lerobot-v3.0", tmp_path / "set", episodes)
    (root / VALUE_COUNTS).unlink()
    add("lerobot-v3.0", root, episodes)
    once = write("lerobot-v3.0", tmp_path / "once", [*episodes, *episodes])
    assert quantiles(root)["q99"] == quantiles(once)["q99"]
