"""Write a LeRobot v2.1 dataset, the format that openpi reads: one Parquet and one video file per episode.

https://github.com/huggingface/lerobot/pull/711 describes what v2.1 changed: statistics per episode.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq

from vcage.dataset.lerobot import CHUNK, Contents, video_key
from vcage.dataset.statistics import QUANTILES
from vcage.files import atomic_folder, write_json, write_text

DATA_PATH = "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet"
VIDEO_PATH = "videos/chunk-{episode_chunk:03d}/{video_key}/episode_{episode_index:06d}.mp4"


def export_v21(contents: Contents, out: Path) -> Path:
    """Write the dataset's folder, whole or not at all."""
    count = len(contents.episodes)
    with atomic_folder(out) as folder:
        info = {
            **contents.info("v2.1"),
            "total_videos": count * len(contents.episodes[0].videos),
            "total_chunks": -(-count // CHUNK),
            "data_path": DATA_PATH,
            "video_path": VIDEO_PATH,
        }
        write_json(folder / "meta" / "info.json", info)
        _write_lines(folder / "meta" / "tasks.jsonl", _numbered("task", contents.tasks))
        _write_lines(folder / "meta" / "subtasks.jsonl", _numbered("subtask", contents.subtasks))
        _write_lines(folder / "meta" / "episodes.jsonl", _episode_lines(contents))
        _write_lines(folder / "meta" / "episodes_stats.jsonl", _statistics_lines(contents))
        for index, (episode, table) in enumerate(zip(contents.episodes, contents.tables, strict=True)):
            pq.write_table(table, _at(folder, DATA_PATH, index), compression="snappy")
            for camera, video in sorted(episode.videos.items()):
                shutil.copyfile(video, _at(folder, VIDEO_PATH, index, video_key=video_key(camera)))
    return Path(out)


def _at(folder: Path, pattern: str, index: int, **names: str) -> Path:
    path = folder / pattern.format(episode_chunk=index // CHUNK, episode_index=index, **names)
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def _write_lines(path: Path, rows: Iterable[dict[str, Any]]) -> None:
    write_text(path, "".join(json.dumps(row, ensure_ascii=False, allow_nan=False) + "\n" for row in rows))


def _numbered(name: str, texts: list[str]) -> list[dict[str, Any]]:
    return [{f"{name}_index": index, name: text} for index, text in enumerate(texts)]


def _episode_lines(contents: Contents) -> list[dict[str, Any]]:
    return [
        {"episode_index": index, "tasks": [episode.data.instruction], "length": episode.data.frames}
        for index, episode in enumerate(contents.episodes)
    ]


def _statistics_lines(contents: Contents) -> list[dict[str, Any]]:
    """v2.1 knows no quantiles."""
    lines = []
    for index, statistics in enumerate(contents.statistics):
        stats = {
            feature: {name: value for name, value in entries.items() if name not in QUANTILES}
            for feature, entries in statistics.items()
        }
        lines.append({"episode_index": index, "stats": stats})
    return lines
