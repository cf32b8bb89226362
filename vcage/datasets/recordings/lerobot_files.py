"""The files of a LeRobot episode, its rows, and the frames of its videos that belong to them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import av
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from vcage.base.errors import DamagedFile
from vcage.base.placeholders import require_fetched
from vcage.base.video_files import open_video
from vcage.datasets.lerobot.features import TIME_TOLERANCE_S
from vcage.datasets.lerobot.meta import PER_EPISODE
from vcage.datasets.lerobot.parquet import FETCH_AGAIN, read_table
from vcage.datasets.lerobot.places import placed
from vcage.datasets.recordings.lerobot_times import (
    RowTimes,
    Share,
    TooShort,
    Unclear,
    frames_of_rows,
    row_times,
    shown_times,
)
from vcage.datasets.recordings.success import label_of


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
            raise DamagedFile(f"{self.file} is missing", hint=FETCH_AGAIN) from error
        with open_video(self.file) as container:
            whole_s = float(container.duration or 0) / av.time_base
        return size if self.share_s is None else round(size * min(1.0, self.share_s / max(whole_s, 1e-9)))


OUTCOME = "next.success"
"""Column that says after which frame the task is done."""


@dataclass
class EpisodeFiles:
    """The files of one episode, its rows in its table, and the frames of its videos that belong to them.

    In v2.0 and v2.1 it has a file for each camera, and a table; in v3.0 it shares them with other episodes.

    Args:
        root: folder of the data set.
        info: its ``meta/info.json``.
        row: of the list of episodes.
        shares: key of a camera → the episode's part of a video that it shares.
    """

    root: Path
    info: Mapping[str, Any]
    row: Mapping[str, Any]
    shares: Mapping[str, Share] = field(default_factory=dict)
    _frames: dict[str, tuple[Sequence[int], str]] = field(default_factory=dict)

    def __str__(self) -> str:
        """Return its name in messages."""
        return f"{self.root} episode {self.number}"

    def __len__(self) -> int:
        return int(self.row["length"])

    @property
    def number(self) -> int:
        """Number of the episode."""
        return int(self.row["episode_index"])

    @property
    def fps(self) -> float:
        """Frames per second of the data set."""
        return float(self.info["fps"])

    @property
    def table(self) -> Path:
        """The table that holds the episode's rows."""
        return placed(self.root, "data_path", self.info["data_path"], **self._place("data"))

    def clip(self, key: str) -> Clip:
        """Return where the pictures of a camera are."""
        begin_s, share, share_s = 0.0, Share(0, len(self)), None
        if not self._alone:
            begin_s, end_s = (float(self._stated(f"videos/{key}/{name}_timestamp")) for name in ("from", "to"))
            share, share_s = self.shares.get(key), end_s - begin_s
        names = self._place(f"videos/{key}")
        return Clip(
            placed(self.root, "video_path", self.info["video_path"], video_key=key, **names), begin_s, share, share_s
        )

    @property
    def _alone(self) -> bool:
        return self.info["codebase_version"] in PER_EPISODE

    def _place(self, prefix: str) -> dict[str, int]:
        """Return the fields of the path of a table or a video."""
        if self._alone:
            return {"episode_chunk": self.number // int(self.info["chunks_size"]), "episode_index": self.number}
        return {name: int(self._stated(f"{prefix}/{name}")) for name in ("chunk_index", "file_index")}

    def _stated(self, name: str) -> float:
        """Return a number in the episode's row of the list of episodes."""
        value, listed = self.row.get(name), f"the list of episodes of {self.root}"
        if value is None:
            raise DamagedFile(f"{listed} does not say {name} of {self.number}", hint=FETCH_AGAIN)
        if not (isinstance(value, int | float) and math.isfinite(value)):
            raise DamagedFile(
                f"{listed} says that {name} of {self.number} is {value!r}, not a number", hint=FETCH_AGAIN
            )
        return value

    def column(self, key: str) -> pa.ChunkedArray:
        """Return a column of the episode's rows.

        Raises:
            DamagedFile: there is no row, or another number than the list of episodes states.
        """
        table = self.table
        found = read_table(table, [key], pc.field("episode_index") == self.number)[key]
        if len(found) == 0:
            raise DamagedFile(f"{self} holds no frame", hint="leave the episode out")
        if len(found) != len(self):
            raise DamagedFile(f"{self} has {len(found)} frames in {table}, not {len(self)}", hint=FETCH_AGAIN)
        return found

    def labels(self) -> set[bool | None]:
        """Return the outcomes of the rows.

        Raises:
            UnclearLabel: one says neither true nor false.
        """
        where = f"{self}, {self.table}: {OUTCOME}"
        return {label_of(value, where, OUTCOME) for value in self.column(OUTCOME).to_pylist()}

    @cached_property
    def times(self) -> RowTimes:
        """Times of the rows.

        Raises:
            DamagedFile: they do not tell which pictures belong to the rows.
        """
        if "timestamp" not in self.info["features"]:
            return RowTimes(np.arange(len(self)) / self.fps)
        stored = self.column("timestamp")
        single = pa.types.is_float32(stored.type)
        try:
            values = np.array(stored.to_pylist(), np.float32 if single else np.float64)
            return row_times(values.reshape(len(stored), -1)[:, 0], self.fps)
        except (TypeError, ValueError) as error:
            message = f"{self}, {self.table}: its timestamps are no numbers"
            raise DamagedFile(message, hint=FETCH_AGAIN) from error
        except Unclear as error:
            raise self._unclear(error, self.table) from error

    def frames_in_video(self, key: str) -> tuple[Sequence[int], str]:
        """Return the frame of a camera's video for each row, and a note on how they were found.

        Raises:
            DamagedFile: they are not certain.
        """
        if key not in self._frames:
            clip = self.clip(key)
            try:
                shown = shown_times(clip.file)
                self._frames[key] = frames_of_rows(shown, clip.begin_s, self.times, self.fps, clip.share)
            except TooShort as error:
                message = f"{self} is longer than its video: {clip.file} {error.message}"
                raise DamagedFile(message, hint=FETCH_AGAIN) from error
            except Unclear as error:
                raise self._unclear(error, clip.file) from error
        return self._frames[key]

    def _unclear(self, error: Unclear, file: Path) -> DamagedFile:
        return DamagedFile(
            f"{self}, {file.relative_to(self.root)}: {error.message}",
            hint="where row k belongs to frame k, set timestamp to frame_index / fps, from_timestamp to the frames "
            "before it / fps, and fps of meta/info.json to the true rate; or leave the episode out",
            details={"episode": self.number, "file": str(file), "off_s": error.off_s, "tolerance_s": TIME_TOLERANCE_S},
        )
