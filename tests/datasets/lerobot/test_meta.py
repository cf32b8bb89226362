"""The list of a LeRobot data set's episodes."""

from __future__ import annotations

import json
import shutil

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.datasets.conftest import LENGTHS
from vcage.base.errors import DamagedFile
from vcage.datasets.lerobot.meta import data_set_info, episode_lengths, episode_rows, episode_tables
from vcage.datasets.lerobot.repack import place_videos

INFO = {"chunks_size": 3, "fps": 10}
PLACES = ("chunk_index", "file_index", "from_timestamp", "to_timestamp")


def info_of(root):
    return json.loads((root / "meta/info.json").read_text())


def places(rows: pa.Table, key: str) -> list[tuple]:
    return list(zip(*(rows[f"videos/{key}/{name}"].to_pylist() for name in PLACES), strict=True))


def test_both_versions_list_their_episodes(v21, v3):
    for root in (v21, v3):
        assert episode_lengths(root, info_of(root)) == dict(enumerate(LENGTHS))


def test_files_that_windows_saved_are_read(v21, tmp_path):
    root = shutil.copytree(v21, tmp_path / "set")
    before = episode_rows(root, data_set_info(root))
    for path in (root / "meta").iterdir():
        path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes().replace(b"\n", b"\r\n"))
    assert episode_rows(root, data_set_info(root)) == before


@pytest.mark.parametrize("content", ["", "[1]\n", '{"episode_index": 0}\n', '{"episode', "\xff"])
def test_lines_that_list_nothing_are_named(v21, tmp_path, content):
    source = shutil.copytree(v21, tmp_path / "source")
    (source / "meta/episodes.jsonl").write_text(content, encoding="latin-1")
    with pytest.raises(DamagedFile, match=r"episodes\.jsonl"):
        episode_lengths(source, info_of(source))


@pytest.mark.parametrize("change", [lambda rows: rows.slice(0, 0), lambda rows: rows.drop_columns(["length"])])
def test_tables_that_list_nothing_are_named(v3, tmp_path, change):
    source = shutil.copytree(v3, tmp_path / "source")
    file = source / episode_tables(v3)[0]
    pq.write_table(change(pq.read_table(file)), file)
    with pytest.raises(DamagedFile, match=r"meta/episodes (lists no|has an) episode"):
        episode_lengths(source, info_of(source))


def test_rows_hold_facts_of_an_episode_but_no_statistics(v3):
    first = episode_rows(v3, info_of(v3))[0]
    assert {"episode_index", "length", "tasks", "data/file_index"} <= set(first)
    assert not [name for name in first if name.startswith("stats/")]


def test_a_missing_list_is_named(v21, v3, tmp_path):
    for number, (root, file) in enumerate([(v21, "meta/episodes.jsonl"), (v3, "meta/episodes")]):
        source = shutil.copytree(root, tmp_path / str(number))
        (source / file).rename(tmp_path / f"gone-{number}")
        with pytest.raises(DamagedFile, match=file):
            episode_lengths(source, info_of(source))


def test_the_tables_of_a_list_are_named_as_in_the_data_set(v3):
    assert [file.as_posix() for file in episode_tables(v3)] == ["meta/episodes/chunk-000/file-000.parquet"]


def test_videos_are_numbered_like_their_episodes():
    rows = pa.table({"episode_index": [2, 3, 7], "length": [5, 10, 20]})
    placed = place_videos(rows, INFO, ["a.b", "c"])
    assert placed.column_names[:2] == ["episode_index", "length"]
    for key in ("a.b", "c"):
        assert places(placed, key) == [(0, 2, 0.0, 0.5), (1, 0, 0.0, 1.0), (2, 1, 0.0, 2.0)]


def test_places_that_were_there_keep_their_columns_and_types():
    old = {f"videos/a/{name}": pa.array([9], pa.int32() if "index" in name else pa.float32()) for name in PLACES}
    rows = pa.table({"episode_index": [4], **old, "length": [10], "videos/b/chunk_index": [8]})
    placed = place_videos(rows, INFO, ["a"])
    assert placed.schema == rows.schema
    assert places(placed, "a") == [(1, 1, 0.0, 1.0)]
    assert placed["videos/b/chunk_index"].to_pylist() == [8]
