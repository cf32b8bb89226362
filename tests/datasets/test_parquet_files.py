"""Numbered Parquet files: where a table goes, and rows back in batches."""

from __future__ import annotations

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from vcage.base.errors import DamagedFile
from vcage.datasets import parquet_files
from vcage.datasets.parquet_files import ParquetSeries, read_batches, read_table

PATTERN = "chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"


def table(start: int, rows: int = 10) -> pa.Table:
    pairs = np.arange(start, start + 2 * rows, dtype=np.float32)
    return pa.table({"n": np.arange(start, start + rows), "x": pa.FixedSizeListArray.from_arrays(pa.array(pairs), 2)})


def test_tables_share_a_file_and_keep_a_row_group_each(tmp_path):
    series = ParquetSeries(str(tmp_path / PATTERN), 1000, full=10**6)
    for start in (0, 10):
        series.write(table(start))
    series.close()
    file = pq.ParquetFile(tmp_path / "chunk-000/file-000.parquet")
    assert file.num_row_groups == 2
    assert file.read()["n"].to_pylist() == list(range(20))


def test_a_full_file_is_followed_by_the_next_and_a_full_folder_too(tmp_path):
    series = ParquetSeries(str(tmp_path / PATTERN), 2, full=1, first=1)
    places = []
    for start in (0, 10, 20):
        places.append(series.place())
        series.write(table(start))
    series.close()
    assert places == [
        {"chunk_index": 0, "file_index": 1},
        {"chunk_index": 1, "file_index": 0},
        {"chunk_index": 1, "file_index": 1},
    ]
    for start, place in zip((0, 10, 20), places, strict=True):
        assert pq.read_table(tmp_path / PATTERN.format(**place))["n"][0].as_py() == start


def test_a_series_that_nothing_was_written_to_leaves_no_file(tmp_path):
    ParquetSeries(str(tmp_path / PATTERN), 1000, full=1).close()
    assert list(tmp_path.iterdir()) == []


def test_rows_come_back_in_batches_over_files_and_row_groups(tmp_path, monkeypatch):
    monkeypatch.setattr(parquet_files, "ROWS_AT_ONCE", 8)
    paths = [tmp_path / "a.parquet", tmp_path / "b.parquet"]
    for start, path in zip((0, 20), paths, strict=True):
        pq.write_table(table(start), path, row_group_size=3)
    batches = list(read_batches(paths, ["n", "x"]))
    assert all(len(batch["n"]) <= 8 for batch in batches)
    np.testing.assert_array_equal(np.concatenate([b["n"] for b in batches])[:, 0], [*range(10), *range(20, 30)])
    np.testing.assert_array_equal(batches[0]["x"][:2], [[0, 1], [2, 3]])


def test_lists_without_a_fixed_length_are_rows_too(tmp_path):
    path = tmp_path / "a.parquet"
    pq.write_table(pa.table({"x": pa.array([[1.0, 2.0], [3.0, 4.0]], pa.list_(pa.float32()))}), path)
    assert next(read_batches([path], ["x"]))["x"].tolist() == [[1, 2], [3, 4]]


def test_a_damaged_file_and_a_missing_column_are_named(tmp_path):
    path = tmp_path / "a.parquet"
    pq.write_table(table(0), path)
    with pytest.raises(DamagedFile, match=r"a\.parquet.*y"):
        read_table(path, ["n", "y"])
    path.write_bytes(path.read_bytes()[:100])
    with pytest.raises(DamagedFile, match=r"a\.parquet"):
        read_table(path)
    with pytest.raises(DamagedFile, match=r"a\.parquet"):
        list(read_batches([path], ["n"]))
