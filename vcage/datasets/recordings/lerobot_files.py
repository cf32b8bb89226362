"""Files of a LeRobot episode: its table and its videos, alone in their files or together with other episodes."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import av

from vcage.base.errors import DamagedFile
from vcage.base.placeholders import require_fetched
from vcage.base.video_files import open_video
from vcage.datasets.lerobot.parquet import MEND
from vcage.datasets.lerobot.places import placed
from vcage.datasets.recordings.lerobot_times import Share


@dataclass(frozen=True)
class Clip:
    """The pictures of an episode and camera in a video that may hold other episodes too.

    Args:
        file: the video.
        begin_s: where the episode begins in it.
        share: its frames of the video, where the lengths of all episodes say so.
        share_s: seconds of the video that are the episode's; None for all.
    """

    file: Path
    begin_s: float
    share: Share | None
    share_s: float | None = None

    @property
    def bytes(self) -> int:
        """Size of the pictures: the share of the video's by its duration.

        Raises:
            DamagedFile: the video is missing, was not fetched, or is no video.
        """
        require_fetched(self.file)
        try:
            size = self.file.stat().st_size
        except OSError as error:
            raise DamagedFile(f"{self.file} is missing", hint=MEND) from error
        with open_video(self.file) as container:
            whole_s = float(container.duration or 0) / av.time_base
        return size if self.share_s is None else round(size * min(1.0, self.share_s / max(whole_s, 1e-9)))


@dataclass(frozen=True)
class EpisodeFiles(ABC):
    """Paths of the files of one episode.

    Args:
        root: folder of the data set.
        info: its ``meta/info.json``.
        row: of the list of episodes.
    """

    root: Path
    info: Mapping[str, Any]
    row: Mapping[str, Any]

    @property
    @abstractmethod
    def table(self) -> Path:
        """The table that holds the episode's rows."""

    @abstractmethod
    def clip(self, key: str) -> Clip:
        """Return where the pictures of a camera are."""

    def _placed(self, pattern: str, **names: int | str) -> Path:
        return placed(self.root, pattern, self.info[pattern], **names)


class OwnFiles(EpisodeFiles):
    """A file per episode and camera, as v2.0 and v2.1 have them."""

    @property
    def table(self) -> Path:
        return self._placed("data_path", **self._numbers)

    def clip(self, key: str) -> Clip:
        file = self._placed("video_path", video_key=key, **self._numbers)
        return Clip(file, 0.0, Share(0, int(self.row["length"])))

    @property
    def _numbers(self) -> dict[str, int]:
        episode = int(self.row["episode_index"])
        return {"episode_chunk": episode // int(self.info["chunks_size"]), "episode_index": episode}


@dataclass(frozen=True)
class SharedFiles(EpisodeFiles):
    """Many episodes in a file, as v3.0 has them.

    Args:
        shares: key of a camera → the episode's part of a video.
    """

    shares: Mapping[str, Share] = field(default_factory=dict)

    @property
    def table(self) -> Path:
        return self._placed("data_path", **self._numbers("data"))

    def clip(self, key: str) -> Clip:
        begin, end = (float(self._stated(f"videos/{key}/{name}_timestamp")) for name in ("from", "to"))
        file = self._placed("video_path", video_key=key, **self._numbers(f"videos/{key}"))
        return Clip(file, begin, self.shares.get(key), end - begin)

    def _numbers(self, prefix: str) -> dict[str, int]:
        return {name: int(self._stated(f"{prefix}/{name}")) for name in ("chunk_index", "file_index")}

    def _stated(self, name: str) -> float:
        """Return a number in the episode's row of the list of episodes."""
        value, listed = self.row.get(name), f"the list of episodes of {self.root}"
        episode = self.row["episode_index"]
        if value is None:
            raise DamagedFile(f"{listed} does not say {name} of {episode}", hint=MEND)
        if not (isinstance(value, int | float) and math.isfinite(value)):
            raise DamagedFile(f"{listed} says that {name} of {episode} is {value!r}, not a number", hint=MEND)
        return value
