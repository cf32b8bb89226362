"""What LeRobot's two formats have in common: features, rows, tasks and statistics of a set of episodes.

Besides LeRobot's own columns every frame has a ``subtask_index`` into ``meta/subtasks``, so that a policy can be
trained on the sub-task in hand as well as on the instruction.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import av
import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from vcage.dataset.episode import EpisodeData
from vcage.dataset.statistics import Statistics, picture_statistics, vector_statistics
from vcage.errors import DamagedFile, UsageError

CHUNK = 1000
"""Files in a folder at most, LeRobot's default."""

SCALARS = ("timestamp", "frame_index", "episode_index", "index", "task_index", "subtask_index")


@dataclass(frozen=True)
class LeRobotEpisode:
    """One episode to export.

    Args:
        data: the episode.
        videos: camera → its encoded video, of as many frames as the episode.
        histograms: camera → (3, 256) counts of levels in some of its pictures.
        sampled: number of pictures in each histogram.
    """

    data: EpisodeData
    videos: dict[str, Path]
    histograms: dict[str, NDArray[np.int64]]
    sampled: int


@dataclass(frozen=True)
class Contents:
    """A dataset, ready to be written in either format.

    Args:
        episodes: the sources, in order.
        features: as in ``info.json``.
        tables: one table of frames per episode.
        tasks: instructions; ``task_index`` counts them.
        subtasks: texts of sub-tasks; ``subtask_index`` counts them.
        statistics: per episode, feature → statistics.
        total: feature → statistics of the whole dataset.
    """

    episodes: Sequence[LeRobotEpisode]
    features: dict[str, dict[str, Any]]
    tables: list[pa.Table]
    tasks: list[str]
    subtasks: list[str]
    statistics: list[dict[str, Statistics]]
    total: dict[str, Statistics]

    @property
    def fps(self) -> int | float:
        fps = self.episodes[0].data.fps
        return int(fps) if float(fps).is_integer() else fps

    @property
    def frames(self) -> int:
        return sum(episode.data.frames for episode in self.episodes)

    def info(self, version: str) -> dict[str, Any]:
        """The part of ``info.json`` that both formats share."""
        return {
            "codebase_version": version,
            "robot_type": str(self.episodes[0].data.meta["robot"]),
            "total_episodes": len(self.episodes),
            "total_frames": self.frames,
            "total_tasks": len(self.tasks),
            "chunks_size": CHUNK,
            "fps": self.fps,
            "splits": {"train": f"0:{len(self.episodes)}"},
            "features": self.features,
        }


def video_key(camera: str) -> str:
    """LeRobot's name of a camera's feature."""
    return f"observation.images.{camera}"


def gather(episodes: Sequence[LeRobotEpisode], encodings: dict[str, dict[str, Any]]) -> Contents:
    """Lay out episodes as a LeRobot dataset.

    Args:
        episodes: at least one; all of the same robot, cameras and frame rate.
        encodings: camera → facts about its encoding for ``info.json``, such as ``{"video.crf": 18}``.

    Raises:
        UsageError: there is no episode, or they do not fit together.
        DamagedFile: a video is unreadable or has another number of frames than its episode.
    """
    if not episodes:
        raise UsageError("there is no accepted episode to export", hint="collect more: run collect with --episodes N")
    _check_alike([episode.data for episode in episodes])
    tasks = _unique(episode.data.instruction for episode in episodes)
    subtasks = _unique(text for episode in episodes for text in _subtask_texts(episode.data))
    columns = []
    start = 0
    for index, episode in enumerate(episodes):
        columns.append(_columns(episode.data, index, start, tasks, subtasks))
        start += episode.data.frames
    merged = {name: np.concatenate([c[name] for c in columns]) for name in columns[0]}
    return Contents(
        episodes=episodes,
        features=_features(episodes, encodings),
        tables=[_table(c) for c in columns],
        tasks=tasks,
        subtasks=subtasks,
        statistics=[_statistics(c, [episode]) for c, episode in zip(columns, episodes, strict=True)],
        total=_statistics(merged, episodes),
    )


def _unique(texts: Any) -> list[str]:
    return list(dict.fromkeys(texts))


def _check_alike(episodes: list[EpisodeData]) -> None:
    first = episodes[0]
    for index, episode in enumerate(episodes):
        for what, mine, theirs in (
            ("frame rate", episode.fps, first.fps),
            ("state names", episode.state_names, first.state_names),
            ("cameras", sorted(episode.cameras), sorted(first.cameras)),
            ("robot", episode.meta["robot"], first.meta["robot"]),
        ):
            if mine != theirs:
                raise UsageError(
                    f"episode {index} has other {what} ({mine}) than episode 0 ({theirs})",
                    hint="export episodes of one robot and one set of cameras together",
                )


def _subtask_texts(episode: EpisodeData) -> list[str]:
    return [segment.text for segment in episode.segments] or [episode.instruction]


def _subtask_of_frames(episode: EpisodeData) -> NDArray[np.int64]:
    """(T,) index into :func:`_subtask_texts`; a frame between two sub-tasks belongs to the one that follows."""
    ends = [segment.end for segment in episode.segments] or [episode.frames]
    return np.minimum(np.searchsorted(ends, np.arange(episode.frames), side="right"), len(ends) - 1)


def _columns(
    episode: EpisodeData, index: int, start: int, tasks: list[str], subtasks: list[str]
) -> dict[str, NDArray[Any]]:
    """Column name → (T, D) or (T,) values."""
    frame = np.arange(episode.frames, dtype=np.int64)
    numbers = np.array([subtasks.index(text) for text in _subtask_texts(episode)], np.int64)
    return {
        "observation.state": episode.qpos.astype(np.float32),
        "action": episode.action.astype(np.float32),
        "timestamp": (frame / episode.fps).astype(np.float32),
        "frame_index": frame,
        "episode_index": np.full(episode.frames, index, np.int64),
        "index": frame + start,
        "task_index": np.full(episode.frames, tasks.index(episode.instruction), np.int64),
        "subtask_index": numbers[_subtask_of_frames(episode)],
    }


def _table(columns: dict[str, NDArray[Any]]) -> pa.Table:
    def column(values: NDArray[Any]) -> pa.Array:
        if values.ndim == 1:
            return pa.array(values)
        return pa.FixedSizeListArray.from_arrays(pa.array(values.ravel()), values.shape[1])

    return pa.table({name: column(values) for name, values in columns.items()})


def _statistics(columns: dict[str, NDArray[Any]], episodes: Sequence[LeRobotEpisode]) -> dict[str, Statistics]:
    statistics = {name: vector_statistics(values.reshape(len(values), -1)) for name, values in columns.items()}
    for camera in sorted(episodes[0].data.cameras):
        histogram = np.sum([episode.histograms[camera] for episode in episodes], axis=0)
        statistics[video_key(camera)] = picture_statistics(histogram, sum(e.sampled for e in episodes))
    return statistics


def _features(episodes: Sequence[LeRobotEpisode], encodings: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
    names = episodes[0].data.state_names
    vector = {"dtype": "float32", "shape": [len(names)], "names": names}
    features: dict[str, dict[str, Any]] = {"observation.state": vector, "action": vector}
    for camera in sorted(episodes[0].data.cameras):
        track = episodes[0].data.cameras[camera]
        infos = [_video_info(episode.videos[camera], episode.data) for episode in episodes]
        features[video_key(camera)] = {
            "dtype": "video",
            "shape": [track.height, track.width, 3],
            "names": ["height", "width", "channels"],
            "info": {**infos[0], **encodings.get(camera, {})},
        }
    for name in SCALARS:
        features[name] = {"dtype": "float32" if name == "timestamp" else "int64", "shape": [1], "names": None}
    return features


def _video_info(path: Path, episode: EpisodeData) -> dict[str, Any]:
    """What ``info.json`` says of a stream, read from the file itself."""
    try:
        with av.open(str(path)) as container:
            stream = container.streams.video[0]
            frames, context, rate = stream.frames, stream.codec_context, float(stream.average_rate)
    except (av.error.FFmpegError, IndexError, TypeError) as error:
        raise DamagedFile(f"{path} is not a video: {error}", hint="run compress again with --force") from error
    if frames != episode.frames or not np.isclose(rate, episode.fps):
        raise DamagedFile(
            f"{path} has {frames} frames at {rate} fps, its episode {episode.frames} at {episode.fps}",
            hint="run compress again with --force",
        )
    return {
        "video.height": context.height,
        "video.width": context.width,
        "video.channels": 3,
        "video.codec": context.codec.canonical_name,
        "video.pix_fmt": context.pix_fmt,
        "video.fps": int(rate) if rate.is_integer() else rate,
        "video.is_depth_map": False,
        "has_audio": False,
    }
