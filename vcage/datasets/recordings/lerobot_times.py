"""Lookup of the video frame that belongs to each row of a LeRobot table.

LeRobot looks pictures up by time: the video's frame nearest to ``from_timestamp + timestamp``, which may not be further
away than ``tolerance_s`` (https://huggingface.co/docs/lerobot/lerobot-dataset-v3). Where that succeeds, its answer
counts. Where times are off by more, but by so little that numbers of rows and of frames leave no doubt, frames are
counted instead, and a note says so. Everything else is refused: a row never gets its neighbour's picture.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile
from vcage.base.videos import frame_times
from vcage.datasets.lerobot.features import TIME_TOLERANCE_S
from vcage.datasets.lerobot.parquet import FETCH_AGAIN


@dataclass(frozen=True)
class LookupSettings:
    """Limits on how far times may be off.

    Args:
        tolerance_s: of LeRobot's own lookup.
        counted_frames: in frames, where the rows of all episodes in a video are as many as its frames.
        alone_frames: in frames, where only the times show the frame of a video at which an episode begins.
        rounding_share: share of a limit by which double precision may exceed it.
    """

    tolerance_s: float = TIME_TOLERANCE_S
    counted_frames: float = 0.5
    alone_frames: float = 0.25
    rounding_share: float = 1e-6


SETTINGS = LookupSettings()


class Unclear(Exception):
    """Times that leave the frame in doubt.

    Args:
        message: the deviation.
        off_s: the largest distance, seconds.
    """

    def __init__(self, message: str, off_s: float):
        super().__init__(message)
        self.message, self.off_s = message, off_s


class TooShort(Unclear):
    """A video with fewer frames than its episode has rows."""


@dataclass(frozen=True)
class RowTimes:
    """Times of the rows of an episode.

    Args:
        seconds: (T,) from the episode's begin, as its pictures are looked up.
        off_s: the largest distance from evenly spaced rows; 0 within the tolerance.
        note: for the user, where they are off; empty else.
    """

    seconds: NDArray[np.float64]
    off_s: float = 0.0
    note: str = ""


def row_times(timestamps: NDArray[Any], fps: float) -> RowTimes:
    """Return the times of rows that should be evenly spaced from 0 on.

    Args:
        timestamps: (T,) seconds as stored, T ≥ 1.
        fps: of the data set.

    Raises:
        Unclear: they are not finite, do not grow, or are off by half a frame or more.
    """
    stored = np.asarray(timestamps, np.float64)
    even = np.arange(len(stored)) / fps
    if not np.all(np.isfinite(stored)):
        raise Unclear("its timestamps hold NaN or infinity", float("inf"))
    off = np.abs(stored - even)
    if off.max() <= _tolerance(timestamps):
        return RowTimes(stored)
    _require_growing(stored)
    by_clock = abs(stored[0]) >= len(stored) / fps  # no frame of the episode can be meant by such a time
    off = np.abs(stored - even - (stored[0] if by_clock else 0.0))
    worst = int(off.argmax())
    if off[worst] * fps >= SETTINGS.counted_frames:
        raise Unclear(_far_off(stored, worst, even[worst], off[worst], fps, by_clock), float(off[worst]))
    if by_clock:
        note = (
            f"its timestamps begin at {stored[0]:g} s and are taken for a clock's: time is counted from its first row"
        )
        return RowTimes(even, float(abs(stored[0])), note)
    note = (
        f"its timestamps are up to {1000 * off[worst]:.2g} ms off {fps:g} frames per second (LeRobot's tolerance is "
        f"{1000 * SETTINGS.tolerance_s:g} ms): its rows are counted"
    )
    return RowTimes(stored, float(off[worst]), note)


def _require_growing(stored: NDArray[np.float64]) -> None:
    steps = np.diff(stored)
    if np.any(steps <= 0):
        row = int(np.argmax(steps <= 0)) + 1
        how = "repeats" if steps[row - 1] == 0 else "goes back to"
        raise Unclear(f"its timestamp of frame {row} {how} {stored[row]:.4f} s", float(-steps.min()))


def _far_off(stored: NDArray[np.float64], worst: int, even: float, off: float, fps: float, by_clock: bool) -> str:
    since = stored[worst] - (stored[0] if by_clock else 0.0)
    rate = (len(stored) - 1) / (stored[-1] - stored[0]) if len(stored) > 1 else fps
    return (
        f"its timestamps put frame {worst} at {since:.4f} s, at {fps:g} frames per second it is {even:.4f} s: "
        f"{1000 * off:.1f} ms off, {off * fps:.2f} of a frame (LeRobot's tolerance is {1000 * SETTINGS.tolerance_s:g} "
        f"ms); they are those of {rate:.2f} frames per second"
    )


@dataclass(frozen=True)
class Share:
    """The part of a video that is an episode's, counted in frames: the lengths of all episodes in it, in order.

    Args:
        start: frames of the episodes before it.
        total: frames of all episodes.
        overlaps: an earlier episode that has not ended when it begins, by their times; None without.
    """

    start: int
    total: int
    overlaps: int | None = None


def frames_of_rows(
    shown: NDArray[np.float64], begin_s: float, times: RowTimes, fps: float, share: Share | None
) -> tuple[Sequence[int], str]:
    """Return the frame of a video for each row, and a note where LeRobot's lookup would fail.

    Args:
        shown: (N,) times of the video's frames, seconds, increasing.
        begin_s: begin of the episode in it.
        times: of its rows.
        fps: of the data set.
        share: first frame of the episode by the lengths of all; None where nothing but ``begin_s`` says it.

    Raises:
        Unclear: the frames are not certain.
    """
    rows, counted = len(times.seconds), share if share is not None and share.total == len(shown) else None
    nearest, off = _looked_up(shown, begin_s + times.seconds)
    if off.max() <= _tolerance(times.seconds) and np.all(np.diff(nearest) > 0):
        if counted is not None:
            _require_start(counted, int(nearest[0]), fps)
        return _compact(nearest), _remark(shown, rows, share)
    start = int(nearest[0]) if counted is None else counted.start
    if start + rows > len(shown):
        raise TooShort(f"has {len(shown)} frames, and {rows} are asked for from frame {start} on", float(off.max()))
    own = shown[start : start + rows] - begin_s
    off = np.abs(own - times.seconds)
    limit, worst = SETTINGS.alone_frames if counted is None else SETTINGS.counted_frames, int(off.argmax())
    words = (
        f"{1000 * off[worst]:.2g} ms off the video's frame {start + worst}, {off[worst] * fps:.2f} of a frame "
        f"(LeRobot's tolerance is {1000 * SETTINGS.tolerance_s:g} ms)"
    )
    if not off[worst] * fps <= limit * (1 + SETTINGS.rounding_share):  # which NaN is not either
        raise Unclear(f"its frame {worst} is looked up {words}", float(off[worst]))
    even = np.abs(own - np.arange(rows) / fps).max() <= SETTINGS.tolerance_s
    noted = times.note and even  # by the note on the rows
    return range(start, start + rows), "" if noted else f"its times are up to {words}: its frames are counted"


def _require_start(share: Share, first: int, fps: float) -> None:
    """Raise Unclear unless the lengths of the episodes before it put an episode's first frame where its time does."""
    gap = abs(first - share.start)
    if gap:
        raise Unclear(
            f"it begins at frame {first} of the video by its time, and at frame {share.start} by the lengths "
            f"of the episodes before it: {gap} frames off",
            gap / fps,
        )


def _remark(shown: NDArray[np.float64], rows: int, share: Share | None) -> str:
    """Return a note on an episode that LeRobot's lookup finds; empty if nothing is odd."""
    if share is None:
        return ""
    if share.overlaps is not None:
        return f"by its times it shows frames of episode {share.overlaps} too"
    more = len(shown) - rows
    return f"its video has {more} frames that belong to no row" if share.total == rows and more > 0 else ""


def _looked_up(
    shown: NDArray[np.float64], wanted: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the frame nearest to each time, and its distance."""
    after = np.clip(np.searchsorted(shown, wanted), 0, len(shown) - 1)
    before = np.maximum(after - 1, 0)
    nearest = np.where(np.abs(shown[before] - wanted) <= np.abs(shown[after] - wanted), before, after)
    return nearest, np.abs(shown[nearest] - wanted)


def _tolerance(times: NDArray[Any]) -> float:
    """Return LeRobot's tolerance plus the rounding of times in single precision."""
    largest = np.float32(np.max(np.abs(times)))
    return SETTINGS.tolerance_s + (float(np.spacing(largest)) if np.isfinite(largest) and largest < 1e5 else 0.0)


def _compact(frames: NDArray[np.int64]) -> Sequence[int]:
    """Return frames that follow each other as a range."""
    first, last = int(frames[0]), int(frames[-1])
    return range(first, last + 1) if last - first + 1 == len(frames) else frames.tolist()


def shown_times(video: Path) -> NDArray[np.float64]:
    """Return the times of a video's frames, seconds; cached for the last few videos, as episodes share them.

    Raises:
        DamagedFile: it cannot be read.
    """
    try:
        stat = video.stat()
    except OSError as error:
        raise DamagedFile(f"{video} cannot be read: {error.strerror}", hint=FETCH_AGAIN) from error
    return _cached_times(video, stat.st_size, stat.st_mtime_ns)


@lru_cache(maxsize=16)
def _cached_times(video: Path, _size: int, _changed: int) -> NDArray[np.float64]:
    return np.array(frame_times(video))


def shares(rows: Sequence[Mapping[str, Any]], key: str, fps: float) -> dict[int, Share]:
    """Return number of an episode → its part of a camera's video, of a v3.0 list of episodes.

    Args:
        rows: the list.
        key: feature of the camera.
        fps: of the data set.

    Episodes without a stated video, or place in it, are left out.
    """
    files: dict[tuple[Any, Any], list[tuple[Any, int, int]]] = {}
    for row in rows:
        file = row.get(f"videos/{key}/chunk_index"), row.get(f"videos/{key}/file_index")
        own = row.get(f"videos/{key}/from_timestamp"), int(row["episode_index"]), int(row["length"])
        files.setdefault(file, []).append(own)
    found: dict[int, Share] = {}
    for own in files.values():
        if not all(isinstance(begin_s, int | float) for begin_s, _, _ in own):
            continue
        total, start, end, before = sum(length for _, _, length in own), 0, 0.0, None
        for begin_s, number, length in sorted(own):
            begin = float(begin_s) * fps
            overlaps = before if begin < end - SETTINGS.counted_frames - SETTINGS.rounding_share else None
            found[number] = Share(start, total, overlaps)
            start, before = start + length, number if begin + length > end else before
            end = max(end, begin + length)
    return found
