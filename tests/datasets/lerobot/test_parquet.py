"""Numbered Parquet files, rows back in batches, and files written again with other columns."""

from __future__ import annotations

import json

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from vcage.base.errors import DamagedFile, OversizedFile
from vcage.datasets.lerobot import parquet
from vcage.datasets.lerobot.parquet import ParquetLimits, ParquetSeries, read_batches, read_table, rewrite, texts_of

PATTERN = "chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"


def table(start: int, rows: int = 10) -> pa.Table:
    pairs = np.arange(start, start + 2 * rows, dtype=np.float32)
    return pa.table({"n": np.arange(start, start + rows), "x": pa.FixedSizeListArray.from_arrays(pa.array(pairs), 2)})


def test_tables_share_a_file_and_keep_a_row_group_each(tmp_path):
    series = ParquetSeries(str(tmp_path / PATTERN), 1000, full_bytes=10**6)
    for start in (0, 10):
        series.write(table(start))
    series.close()
    file = pq.ParquetFile(tmp_path / "chunk-000/file-000.parquet")
    assert file.num_row_groups == 2
    assert file.read()["n"].to_pylist() == list(range(20))


def test_a_full_file_is_followed_by_the_next_and_a_full_folder_too(tmp_path):
    series = ParquetSeries(str(tmp_path / PATTERN), 2, full_bytes=1, first=1)
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
    ParquetSeries(str(tmp_path / PATTERN), 1000, full_bytes=1).close()
    assert list(tmp_path.iterdir()) == []


def test_rows_come_back_in_batches_over_files_and_row_groups(tmp_path, monkeypatch):
    monkeypatch.setattr(parquet, "LIMITS", ParquetLimits(batch_rows=8))
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


NAMES = ["observation", "observation.picture", "observation.state", "reward"]


@pytest.fixture
def source(tmp_path):
    """Two row groups; as ``datasets`` and pandas write it, both say what the columns are."""
    rows = 5
    bits = np.array([0, -0.0, np.nan, np.inf, 1e-45], np.float32)
    table = pa.table(
        {
            "observation": pa.array(range(rows), pa.int8()),
            "observation.picture": [{"bytes": b"png", "path": f"{row % 2}.png"} for row in range(rows)],
            "observation.state": pa.FixedSizeListArray.from_arrays(pa.array(np.repeat(bits, 2)), 2),
            "reward": pa.array([1.0, None, 2.0, None, 3.0], pa.float64()),
        }
    )
    told = {
        b"huggingface": json.dumps({"info": {"features": {name: {"_type": "Value"} for name in NAMES}}}),
        b"pandas": json.dumps({"columns": [{"name": name, "field_name": name} for name in NAMES]}),
        b"mine": b"stays",
    }
    pq.write_table(table.replace_schema_metadata(told), tmp_path / "source.parquet", row_group_size=3)
    return tmp_path / "source.parquet"


def test_a_column_is_left_out_and_the_others_stay_to_the_bit(source, tmp_path):
    rewrite(source, tmp_path / "target.parquet", without=["observation.picture"])
    before, after = pq.read_table(source), pq.read_table(tmp_path / "target.parquet")
    assert after.column_names == ["observation", "observation.state", "reward"]
    for name in after.column_names:
        assert after.schema.field(name) == before.schema.field(name)
    assert after.drop_columns("observation.state") == before.drop_columns(["observation.state", "observation.picture"])
    states = [table["observation.state"].combine_chunks().flatten().to_numpy() for table in (before, after)]
    assert states[0].tobytes() == states[1].tobytes()


def test_row_groups_stay_as_they_are(source, tmp_path):
    rewrite(source, tmp_path / "target.parquet", without=["reward"])
    file = pq.ParquetFile(tmp_path / "target.parquet")
    assert [file.metadata.row_group(number).num_rows for number in range(file.num_row_groups)] == [3, 2]


def test_notes_on_a_column_go_with_it(source, tmp_path):
    rewrite(source, tmp_path / "target.parquet", without=["observation.picture"])
    told = pq.read_schema(tmp_path / "target.parquet").metadata
    kept = ["observation", "observation.state", "reward"]
    assert list(json.loads(told[b"huggingface"])["info"]["features"]) == kept
    assert [column["name"] for column in json.loads(told[b"pandas"])["columns"]] == kept
    assert told[b"mine"] == b"stays"


def test_rows_can_change_and_columns_can_come(source, tmp_path):
    def double(table: pa.Table) -> pa.Table:
        return table.append_column("row", pa.array(np.arange(table.num_rows), pa.int64()))

    rewrite(source, tmp_path / "target.parquet", change=double)
    assert pq.read_table(tmp_path / "target.parquet")["row"].to_pylist() == [0, 1, 2, 0, 1]


def test_a_table_without_rows_keeps_its_columns(source, tmp_path):
    pq.write_table(pq.read_table(source).slice(0, 0), tmp_path / "empty.parquet")
    rewrite(tmp_path / "empty.parquet", tmp_path / "target.parquet", without=["observation.picture"])
    assert pq.read_table(tmp_path / "target.parquet").column_names == ["observation", "observation.state", "reward"]


def test_texts_in_a_field_are_found_without_their_neighbours(source):
    assert texts_of(source, "observation.picture", "path") == {"0.png", "1.png"}


@pytest.mark.parametrize(("column", "field"), [("reward", "path"), ("observation.picture", "name"), ("none", "path")])
def test_a_field_that_is_not_there_has_no_texts(source, column, field):
    assert texts_of(source, column, field) == set()


@pytest.mark.parametrize("size", [0, 40, -40])
def test_a_file_that_is_cut_off_is_named(source, tmp_path, size):
    source.write_bytes(source.read_bytes()[:size])
    with pytest.raises(DamagedFile, match=r"source\.parquet cannot be read"):
        rewrite(source, tmp_path / "target.parquet")


def test_rows_that_are_damaged_are_named(source, tmp_path):
    data = bytearray(source.read_bytes())
    data[4:200] = b"\xff" * 196
    source.write_bytes(data)
    with pytest.raises(DamagedFile, match=r"source\.parquet cannot be read"):
        rewrite(source, tmp_path / "target.parquet")


@pytest.mark.parametrize("limits", [ParquetLimits(max_rows=3), ParquetLimits(max_values=3), ParquetLimits(max_bytes=3)])
def test_a_table_that_declares_too_much_is_refused_before_it_is_read(tmp_path, monkeypatch, limits):
    pq.write_table(pa.table({"action": range(4), "other": range(4)}), tmp_path / "a.parquet")
    monkeypatch.setattr(parquet, "LIMITS", limits)
    monkeypatch.setattr(pq, "read_table", lambda *_, **__: pytest.fail("read"))
    with pytest.raises(OversizedFile, match=r"a\.parquet is too large: it declares"):
        read_table(tmp_path / "a.parquet", ["action"])
