"""The list of episodes that a LeRobot data set keeps in ``meta``: their lengths, and in v3.0 where their videos are."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import pyarrow as pa

from vcage.base.errors import DamagedFile
from vcage.datasets.lerobot.json_lines import read_lines
from vcage.datasets.lerobot.v21 import EPISODES
from vcage.datasets.parquet_files import MEND, column_names, numbered, read_table

TABLES = Path("meta/episodes")
"""Folder of the list in v3.0."""


def episode_rows(root: Path, info: Mapping[str, Any]) -> list[dict[str, Any]]:
    """What a data set says of each of its episodes, of at least one, but for their statistics; each has an
    ``episode_index`` and a ``length``, integers.

    Args:
        root: folder of the data set, v2.1 or v3.0.
        info: its ``meta/info.json``.

    Raises:
        DamagedFile: the list cannot be read, is empty, or does not say so much.
    """
    old = info["codebase_version"] == "v2.1"
    where = root / (EPISODES if old else TABLES)
    rows = list(read_lines(where)) if old else [row for file in episode_tables(root) for row in _rows(root / file)]
    if not rows:
        raise DamagedFile(f"{where} lists no episode", hint=MEND)
    for row in rows:
        for name in ("episode_index", "length"):
            if not isinstance(row.get(name), int):
                raise DamagedFile(f"{where} has an episode whose {name} is {row.get(name)!r}", hint=MEND)
    return rows


def episode_lengths(root: Path, info: Mapping[str, Any]) -> dict[int, int]:
    """Number of an episode → its frames; see :func:`episode_rows`."""
    return {row["episode_index"]: row["length"] for row in episode_rows(root, info)}


def episode_tables(root: Path) -> list[Path]:
    """The files of a v3.0 list, relative to the data set."""
    return sorted(file.relative_to(root) for file in (root / TABLES).rglob("*.parquet"))


def place_videos(rows: pa.Table, info: Mapping[str, Any], keys: Collection[str]) -> pa.Table:
    """Rows of a v3.0 list in which each episode has a video of its own, numbered like the episode.

    Args:
        rows: with ``episode_index`` and ``length``; columns ``videos/<key>/…`` keep their types, or come.
        info: ``meta/info.json``.
        keys: features of the cameras whose videos are placed.
    """
    places = [numbered(episode, int(info["chunks_size"])) for episode in rows["episode_index"].to_pylist()]
    lengths = rows["length"].to_pylist()
    columns = {
        "chunk_index": pa.array([place["chunk_index"] for place in places], pa.int64()),
        "file_index": pa.array([place["file_index"] for place in places], pa.int64()),
        "from_timestamp": pa.array([0.0] * len(lengths), pa.float64()),
        "to_timestamp": pa.array([length / float(info["fps"]) for length in lengths], pa.float64()),
    }
    for key in keys:
        for name, values in columns.items():
            rows = _with_column(rows, f"videos/{key}/{name}", values)
    return rows


def _with_column(rows: pa.Table, name: str, values: pa.Array) -> pa.Table:
    index = rows.schema.get_field_index(name)
    if index < 0:
        return rows.append_column(name, values)
    field = rows.schema.field(index)
    return rows.set_column(index, field, values.cast(field.type))


def _rows(file: Path) -> list[dict[str, Any]]:
    """The rows of a table; statistics of all episodes would fill the memory."""
    return read_table(file, [name for name in column_names(file) if not name.startswith("stats/")]).to_pylist()
