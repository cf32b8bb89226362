"""The rows of a LeRobot episode, and the frames of its videos that belong to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from vcage.base.errors import DamagedFile
from vcage.datasets.lerobot.features import TIME_TOLERANCE_S
from vcage.datasets.lerobot.parquet import MEND, read_table
from vcage.datasets.recordings.lerobot_files import EpisodeFiles
from vcage.datasets.recordings.lerobot_times import (
    RowTimes,
    TooShort,
    Unclear,
    frames_of_rows,
    row_times,
    shown_times,
)
from vcage.datasets.recordings.success import label_of

OUTCOME = "next.success"
"""Column that says after which frame the task is done."""


@dataclass
class EpisodeRows:
    """The rows of an episode in its table.

    Args:
        name: of the episode, for messages.
        files: of the episode.
    """

    name: str
    files: EpisodeFiles
    _frames: dict[str, tuple[Sequence[int], str]] = field(default_factory=dict)

    def __len__(self) -> int:
        return int(self.files.row["length"])

    @property
    def fps(self) -> float:
        """Frames per second of the data set."""
        return float(self.files.info["fps"])

    def column(self, key: str) -> pa.ChunkedArray:
        """Return a column of the episode's rows.

        Raises:
            DamagedFile: there is no row, or other than the list of episodes says.
        """
        table = self.files.table
        found = read_table(table, [key], pc.field("episode_index") == int(self.files.row["episode_index"]))[key]
        if len(found) == 0:
            raise DamagedFile(f"{self.name} holds no frame", hint="leave the episode out")
        if len(found) != len(self):
            raise DamagedFile(f"{self.name} has {len(found)} frames in {table}, not {len(self)}", hint=MEND)
        return found

    def labels(self) -> set[bool | None]:
        """Return the outcomes of the rows.

        Raises:
            UnclearLabel: one says neither true nor false.
        """
        where = f"{self.name}, {self.files.table}: {OUTCOME}"
        return {label_of(value, where, OUTCOME) for value in self.column(OUTCOME).to_pylist()}

    @cached_property
    def times(self) -> RowTimes:
        """Times of the rows.

        Raises:
            DamagedFile: they do not tell which pictures belong to the rows.
        """
        if "timestamp" not in self.files.info["features"]:
            return RowTimes(np.arange(len(self)) / self.fps)
        stored = self.column("timestamp")
        single = pa.types.is_float32(stored.type)
        try:
            values = np.array(stored.to_pylist(), np.float32 if single else np.float64)
            return row_times(values.reshape(len(stored), -1)[:, 0], self.fps)
        except (TypeError, ValueError) as error:
            message = f"{self.name}, {self.files.table}: its timestamps are no numbers"
            raise DamagedFile(message, hint=MEND) from error
        except Unclear as error:
            raise self._unclear(error, self.files.table) from error

    def frames_in_video(self, key: str) -> tuple[Sequence[int], str]:
        """Return the frame of a camera's video for each row, and a note on how they were found.

        Raises:
            DamagedFile: they are not certain.
        """
        if key not in self._frames:
            clip = self.files.clip(key)
            try:
                shown = shown_times(clip.file)
                self._frames[key] = frames_of_rows(shown, clip.begin_s, self.times, self.fps, clip.share)
            except TooShort as error:
                message = f"{self.name} is longer than its video: {clip.file} {error.message}"
                raise DamagedFile(message, hint=MEND) from error
            except Unclear as error:
                raise self._unclear(error, clip.file) from error
        return self._frames[key]

    def _unclear(self, error: Unclear, file: Path) -> DamagedFile:
        number = int(self.files.row["episode_index"])
        return DamagedFile(
            f"{self.name}, {file.relative_to(self.files.root)}: {error.message}",
            hint="where row k belongs to frame k, set timestamp to frame_index / fps, from_timestamp to the frames "
            "before it / fps, and fps of meta/info.json to the true rate; or leave the episode out",
            details={"episode": number, "file": str(file), "off_s": error.off_s, "tolerance_s": TIME_TOLERANCE_S},
        )
