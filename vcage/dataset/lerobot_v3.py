"""Write a LeRobot v3.0 dataset (read by lerobot 0.4 and later).

https://huggingface.co/docs/lerobot/lerobot-dataset-v3. All frames lie in one Parquet file; each episode keeps a video
file of its own, which the format allows and which leaves the encoded streams as they were judged, byte for byte.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from vcage.dataset.lerobot import CHUNK, Contents, video_key
from vcage.files import atomic_folder, write_json

FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}"
DATA_PATH = f"data/{FILE}.parquet"
VIDEO_PATH = f"videos/{{video_key}}/{FILE}.mp4"
EPISODES_PATH = f"meta/episodes/{FILE}.parquet"


def export_v3(contents: Contents, out: Path) -> Path:
    """Write the dataset's folder, whole or not at all."""
    with atomic_folder(out) as folder:
        info = {
            **contents.info("v3.0"),
            "data_files_size_in_mb": 100,
            "video_files_size_in_mb": 200,
            "data_path": DATA_PATH,
            "video_path": VIDEO_PATH,
        }
        write_json(folder / "meta" / "info.json", info)
        write_json(folder / "meta" / "stats.json", contents.total)
        _write_names(folder / "meta" / "tasks.parquet", "task", contents.tasks)
        _write_names(folder / "meta" / "subtasks.parquet", "subtask", contents.subtasks)
        _write_table(pa.concat_tables(contents.tables), _at(folder, DATA_PATH, 0))
        _write_table(pa.Table.from_pylist(_episode_rows(contents)), _at(folder, EPISODES_PATH, 0))
        for index, episode in enumerate(contents.episodes):
            for camera, video in sorted(episode.videos.items()):
                target = _at(folder, VIDEO_PATH, index, video_key=video_key(camera))
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(video, target)
    return Path(out)


def _at(folder: Path, pattern: str, index: int, **names: str) -> Path:
    return folder / pattern.format(chunk_index=index // CHUNK, file_index=index % CHUNK, **names)


def _write_table(table: pa.Table, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(table, path, compression="snappy")


def _write_names(path: Path, name: str, texts: list[str]) -> None:
    """A table of texts and their numbers as pandas stores it with the texts as its index, which LeRobot expects."""
    number = f"{name}_index"
    described = [
        {"name": number, "field_name": number, "pandas_type": "int64", "numpy_type": "int64", "metadata": None},
        {"name": name, "field_name": name, "pandas_type": "unicode", "numpy_type": "object", "metadata": None},
    ]
    pandas = {"index_columns": [name], "column_indexes": [], "columns": described, "pandas_version": "2.2.0"}
    table = pa.table({number: pa.array(range(len(texts)), pa.int64()), name: pa.array(texts, pa.string())})
    _write_table(table.replace_schema_metadata({"pandas": json.dumps(pandas)}), path)


def _episode_rows(contents: Contents) -> list[dict[str, Any]]:
    rows = []
    start = 0
    for index, (episode, statistics) in enumerate(zip(contents.episodes, contents.statistics, strict=True)):
        frames = episode.data.frames
        row: dict[str, Any] = {
            "episode_index": index,
            "tasks": [episode.data.instruction],
            "length": frames,
            "data/chunk_index": 0,
            "data/file_index": 0,
            "dataset_from_index": start,
            "dataset_to_index": start + frames,
        }
        for camera in sorted(episode.videos):
            prefix = f"videos/{video_key(camera)}"
            row[f"{prefix}/chunk_index"] = index // CHUNK
            row[f"{prefix}/file_index"] = index % CHUNK
            row[f"{prefix}/from_timestamp"] = 0.0
            row[f"{prefix}/to_timestamp"] = frames / episode.data.fps
        for feature, entries in statistics.items():
            row |= {f"stats/{feature}/{name}": value for name, value in entries.items()}
        row["meta/episodes/chunk_index"] = 0
        row["meta/episodes/file_index"] = 0
        rows.append(row)
        start += frames
    return rows
