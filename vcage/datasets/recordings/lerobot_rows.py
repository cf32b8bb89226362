"""The rows of a LeRobot episode in time, and the frames of its videos that belong to them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pyarrow as pa

from vcage.base.errors import DamagedFile, InputFileError
from vcage.datasets.lerobot.features import TIME_TOLERANCE
from vcage.datasets.lerobot.parquet import MEND
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

OUTCOME = "next.success"
"""Column that says after which frame the task is done."""


@dataclass(frozen=True)
class Clip:
    """Where an episode's pictures of one camera are: in a video that may hold other episodes too.

    Args:
        file: the video.
        begin: when the episode begins in it, seconds.
        share: which of its frames are the episode's, where the lengths of all episodes say so.
    """

    file: Path
    begin: float
    share: Share | None


class TimedRows(ABC):
    """Times and outcome of an episode, from its table and its videos."""

    TARGET: ClassVar[str]
    path: Path
    number: int
    _info: Mapping[str, Any]
    _placed: dict[str, tuple[Sequence[int], str]]

    _labelled: bool = True
    """Its data set's column of outcomes tells anything: some episode of it succeeds."""

    @property
    @abstractmethod
    def frames(self) -> int:
        """How many rows it has."""

    @property
    @abstractmethod
    def _data_file(self) -> Path:
        """The table that holds the episode's rows."""

    @abstractmethod
    def _clip(self, key: str) -> Clip:
        """Where the pictures of a camera are."""

    @abstractmethod
    def _column(self, key: str) -> pa.ChunkedArray:
        """A column of the episode's rows."""

    @property
    def failed(self) -> str | None:
        if OUTCOME not in self._info["features"]:
            return None
        labels = self._labels()
        never = self._labelled and False in labels and True not in labels
        return f"its {OUTCOME} is never true" if never else None

    def set_unlabelled(self) -> None:
        """Note that no episode of its data set succeeds, so that its outcomes tell nothing."""
        self._labelled = False

    def succeeds(self) -> bool:
        """Check for a true outcome; what is not understood or damaged is named where the episode is read."""
        with suppress(InputFileError):
            return True in self._labels()
        return True

    def _labels(self) -> set[bool | None]:
        """The outcomes of its rows.

        Raises:
            UnclearLabel: one says neither true nor false.
        """
        where = f"{self}, {self._data_file}: {OUTCOME}"
        return {label_of(value, where, OUTCOME) for value in self._column(OUTCOME).to_pylist()}

    def time_fault(self, target: str, fps: float) -> str | None:
        times = self._row_times
        kept = f"{times.note}; a data set of the same version keeps them"
        return kept if times.note and target == self.TARGET else None

    @cached_property
    def _row_times(self) -> RowTimes:
        """When its rows were recorded.

        Raises:
            DamagedFile: their times leave it open which pictures are theirs.
        """
        fps = float(self._info["fps"])
        if "timestamp" not in self._info["features"]:
            return RowTimes(np.arange(self.frames) / fps)
        stored = self._column("timestamp")
        single = pa.types.is_float32(stored.type)
        try:
            values = np.array(stored.to_pylist(), np.float32 if single else np.float64)
            return row_times(values.reshape(len(stored), -1)[:, 0], fps)
        except (TypeError, ValueError) as error:
            raise DamagedFile(f"{self}, {self._data_file}: its timestamps are no numbers", hint=MEND) from error
        except Unclear as error:
            raise self._unclear(error, self._data_file) from error

    def _frames_in_video(self, key: str) -> tuple[Sequence[int], str]:
        """The frame of a camera's video for each row, and what must be said of how they were found.

        Raises:
            DamagedFile: that is not certain.
        """
        if key not in self._placed:
            clip = self._clip(key)
            try:
                shown = shown_times(clip.file)
                self._placed[key] = frames_of_rows(
                    shown, clip.begin, self._row_times, float(self._info["fps"]), clip.share
                )
            except TooShort as error:
                raise DamagedFile(f"{self} is longer than its video: {clip.file} {error.message}", hint=MEND) from error
            except Unclear as error:
                raise self._unclear(error, clip.file) from error
        return self._placed[key]

    def _unclear(self, error: Unclear, file: Path) -> DamagedFile:
        return DamagedFile(
            f"{self}, {file.relative_to(self.path)}: {error.message}",
            hint="where row k belongs to frame k, set timestamp to frame_index / fps, from_timestamp to the frames "
            "before it / fps, and fps of meta/info.json to the true rate; or leave the episode out",
            details={"episode": self.number, "file": str(file), "off_s": error.off_s, "tolerance_s": TIME_TOLERANCE},
        )
