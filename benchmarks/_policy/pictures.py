"""Pictures of a run's episodes, as each format gives them back."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from benchmarks._compression_formats import LeRobot
from benchmarks._policy.localiser import View
from vcage.base.files import RunFolder, atomic_path
from vcage.base.videos import pictures
from vcage.datasets.reader import EpisodeReader
from vcage.runs.accepted import accepted_episodes
from vcage.schema.compression import Compression

Format = Literal["raw", "compressed", "lerobot"]
"""As recorded; as ``vcage compress`` stores them; as LeRobot's defaults do (AV1, CRF 30)."""


def shrunk_pictures(
    run: RunFolder, stored: Format, views: Sequence[View], episodes: int, kept: Path
) -> dict[str, NDArray[np.uint8]]:
    """Camera → (F, h, w, 3) all frames of the first accepted episodes, one episode after the other.

    Args:
        run: with raw pictures, and compressed if ``stored`` says so.
        stored: the format in which they come.
        views: the cameras, and the sizes wanted.
        episodes: number of episodes.
        kept: folder for LeRobot's videos.
    """
    entries = accepted_episodes(run)[:episodes]
    videos = _videos(run) if stored == "compressed" else {}
    count = sum(entry.frames for entry in entries)
    found = {view.camera: np.empty((count, view.height, view.width, 3), np.uint8) for view in views}
    begin = 0
    for entry in entries:
        file, end = str(entry.file), begin + entry.frames
        with EpisodeReader(run.file(file)) as reader:
            for view in views:
                shown: Iterator[NDArray[np.uint8]] = iter(reader.images(view.camera))
                if stored == "compressed":
                    shown = pictures(videos[file, view.camera])
                elif stored == "lerobot":
                    video = kept / f"{Path(file).stem}_{view.camera}.mp4"
                    shown = pictures(_written(video, reader, run.file(file), view.camera))
                for frame, picture in zip(range(begin, end), shown, strict=True):
                    found[view.camera][frame] = view.shrunk(picture)
        begin = end
    return found


def _written(video: Path, reader: EpisodeReader, episode: Path, camera: str) -> Path:
    """The video of a camera; it is written anew where the episode is newer."""
    if not video.exists() or video.stat().st_mtime < episode.stat().st_mtime:
        video.parent.mkdir(parents=True, exist_ok=True)
        with atomic_path(video) as part:
            LeRobot().write(reader.images(camera)[:], reader.episode.fps, part)
    return video


def _videos(run: RunFolder) -> Mapping[tuple[str, str], Path]:
    """(file of the episode, camera) → its video."""
    record = Compression.read(run.compression)
    return {(str(stream.episode), stream.camera): run.file(str(stream.file)) for stream in record.streams}
