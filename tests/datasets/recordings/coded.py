"""Data sets whose pictures tell their frame: frame k of a data set has a grey of its own."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from vcage.datasets.lerobot.episode import LeRobotEpisode
from vcage.datasets.lerobot.formats import open_writer
from vcage.datasets.lerobot.statistics import picture_histogram
from vcage.video.codec import EncoderSettings, encode

FPS, STEP = 10.0, 4
KEY = "observation.images.cam"


def coded(frames: range) -> np.ndarray:
    """(T, 48, 64, 3): the number of each frame as a grey."""
    levels = np.array([STEP * (frame + 1) for frame in frames], np.uint8)
    return np.broadcast_to(levels[:, None, None, None], (len(frames), 48, 64, 3)).copy()


def numbers(pictures: np.ndarray) -> list[int]:
    """The numbers that pictures carry."""
    return [round(float(picture.mean()) / STEP) - 1 for picture in pictures]


def film(path: Path, frames: range) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(encode(coded(frames), FPS, EncoderSettings("h264", "yuv420p", gop=2), 1))
    return path


def data_set(version: str, root: Path, lengths: Sequence[int]) -> Path:
    """Episodes of these lengths, whose frames are numbered through."""
    with open_writer(version, root) as writer:
        start = 0
        for index, length in enumerate(lengths):
            frames = range(start, start + length)
            values = np.array(frames, np.float64)[:, None]
            writer.add(
                LeRobotEpisode(
                    fps=FPS,
                    robot="arm",
                    task=f"task {index}",
                    videos={"cam": film(root.parent / f"{root.name}-{index}.mp4", frames)},
                    histograms={"cam": picture_histogram(coded(frames))},
                    sampled=length,
                    state=values,
                    state_names=["frame"],
                    action=-values,
                    action_names=["frame"],
                )
            )
            start += length
    return root


def in_one_video(root: Path, lengths: Sequence[int], begins: Sequence[float], *, spare: int = 0) -> Path:
    """Put the episodes of a v3.0 data set into one video, with ``spare`` frames behind them.

    Args:
        root: the data set.
        lengths: of its episodes.
        begins: its recorded begins of the episodes, in frames.
        spare: frames after the last episode.
    """
    film(root / f"videos/{KEY}/chunk-000/file-000.mp4", range(sum(lengths) + spare))
    for other in sorted((root / f"videos/{KEY}/chunk-000").glob("*.mp4"))[1:]:
        other.unlink()
    (path,) = (root / "meta/episodes").rglob("*.parquet")
    rows = pq.read_table(path)
    columns = {
        "file_index": pa.array([0] * len(lengths), pa.int64()),
        "from_timestamp": pa.array([begin / FPS for begin in begins], pa.float64()),
        "to_timestamp": pa.array([(a + b) / FPS for a, b in zip(begins, lengths, strict=True)], pa.float64()),
    }
    for name, values in columns.items():
        place = rows.schema.get_field_index(f"videos/{KEY}/{name}")
        rows = rows.set_column(place, f"videos/{KEY}/{name}", values)
    pq.write_table(rows, path)
    return root


def with_timestamps(root: Path, episode: int, seconds: np.ndarray) -> Path:
    """Write other times into a v2.x data set."""
    path = root / f"data/chunk-000/episode_{episode:06d}.parquet"
    rows = pq.read_table(path)
    place = rows.schema.get_field_index("timestamp")
    pq.write_table(rows.set_column(place, "timestamp", pa.array(seconds)), path)
    return root


def with_info(root: Path, **changes: object) -> Path:
    """Say something else in ``meta/info.json``."""
    path = root / "meta/info.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), **changes}))
    return root
