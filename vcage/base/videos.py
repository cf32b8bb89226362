"""Video files as arrays: decoded as any reader decodes them (PyAV), any picture without those before it.

A frame is found by its time, never by counting packets from where a seek landed: of the frames behind an open GOP's
random-access point some are shown before it, and cannot be decoded from there.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from typing import Any

import av
import numpy as np
from av.video.reformatter import VideoReformatter
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile, UsageError
from vcage.base.video_files import MAKE_AGAIN, open_video, video_name


def decode(
    video: bytes | Path, indices: Sequence[int] | None = None, frames_for_threads: int = 16
) -> NDArray[np.uint8]:
    """The pictures at ``indices`` (None: all), the same as when the video is decoded from its start.

    Args:
        video: a file, or its content.
        indices: frames from 0, in order of time; a repeated one comes once.
        frames_for_threads: frames to decode from which several are decoded at a time; for fewer, that only delays
            the first.

    Returns:
        (N, H, W, 3) uint8 RGB in the order of time.

    Raises:
        DamagedFile: it is no video, is cut off, or holds fewer frames than it claims.
        UsageError: an index lies outside the video.
    """
    if indices is None:
        return np.stack(list(pictures(video)))
    table = _table(video)
    wanted = sorted(set(indices))
    for index in wanted[:1] + wanted[-1:]:
        if not 0 <= index < len(table.times):
            raise UsageError(f"{video_name(video)} has {len(table.times)} frames, frame {index} was asked for")
    runs = table.runs(wanted)
    with _opened(video) as source:
        source.decode_ahead(sum(run.length for run in runs) >= frames_for_threads)
        found = [picture for run in runs for picture in source.run(run)]
        return np.stack(found) if found else np.empty((0, *source.size, 3), np.uint8)


def pictures(video: bytes | Path) -> Iterator[NDArray[np.uint8]]:
    """All pictures in the order of time, (H, W, 3) uint8 RGB, one in memory at a time.

    Raises:
        DamagedFile: it is no video, is truncated, or holds fewer frames than it claims; after the pictures before that.
    """
    with _opened(video) as source:
        yield from map(source.picture, source.all())


def decode_whole(video: bytes | Path, indices: Sequence[int]) -> tuple[NDArray[np.uint8], int]:
    """The pictures at ``indices`` as of :func:`decode`, and the number of all frames, each of which is decoded.

    Raises:
        DamagedFile: it is no video, is cut off, or holds fewer frames than it claims, or one is damaged.
    """
    wanted, found, count = set(indices), [], 0
    with _opened(video) as source:
        for count, frame in enumerate(source.all(), start=1):
            if count - 1 in wanted:
                found.append(source.picture(frame))
        return np.stack(found) if found else np.empty((0, *source.size, 3), np.uint8), count


def frame_count(video: bytes | Path) -> int:
    """Count the frames without decoding them.

    Raises:
        DamagedFile: it is no video, is cut off, or holds fewer frames than it claims.
    """
    return len(_table(video).times)


def frame_times(video: bytes | Path) -> list[float]:
    """When each frame is shown, seconds, in order; read without decoding them.

    Raises:
        DamagedFile: it is no video, is cut off, or holds fewer frames than it claims.
    """
    table = _table(video)
    return [float(time * table.unit) for time in table.times]


def codec_name(video: bytes | Path) -> str:
    """FFmpeg's name of the format of its pictures: ``hevc``, ``av1``, ``h264``…

    Raises:
        DamagedFile: it is no video.
    """
    with _opened(video) as source:
        return str(source.stream.codec_context.codec.canonical_name)


def frame_rate(video: bytes | Path) -> float:
    """Frames per second, on average where they are not evenly spaced.

    Raises:
        DamagedFile: it is no video, or does not say.
    """
    with _opened(video) as source:
        rate = source.stream.average_rate
        if not rate:
            raise DamagedFile(f"{source.name} does not say how fast its frames follow each other", hint=MAKE_AGAIN)
        return float(rate)


# --- where frames are ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Entry:
    """A random-access point: where the decoder can start.

    Args:
        time: when its picture is shown.
        seek: the time to seek to, in decoding order.
    """

    time: int
    seek: int


@dataclass(frozen=True)
class _Run:
    """Frames that are decoded in one go from a random-access point on; ``length`` frames in all."""

    entry: _Entry
    times: frozenset[int]
    length: int


@dataclass(frozen=True)
class _Table:
    """Times of all frames in order, and the random-access points in order, in units of the stream.

    Args:
        unit: of the times, seconds.
    """

    times: list[int]
    entries: list[_Entry]
    unit: Fraction

    def runs(self, wanted: Sequence[int], frames_per_seek: int = 8) -> list[_Run]:
        """Return the runs to decode for increasing frame numbers ``wanted``.

        Args:
            frames_per_seek: that a seek must spare: it costs the decoder about as much (flushed, and its threads filled
                again).
        """
        runs: list[tuple[_Entry, list[int]]] = []
        starts = [entry.time for entry in self.entries]
        for index in wanted:
            time = self.times[index]
            # frames at an entry or later do not depend on anything before the entry
            entry = self.entries[max(0, bisect_right(starts, time) - 1)]
            if runs and self._index(entry.time) - self._index(runs[-1][1][-1]) <= frames_per_seek:
                runs[-1][1].append(time)
            else:
                runs.append((entry, [time]))
        return [
            _Run(entry, frozenset(times), self._index(times[-1]) - self._index(entry.time) + 1) for entry, times in runs
        ]

    def _index(self, time: int) -> int:
        return bisect_right(self.times, time) - 1


def _table(video: bytes | Path) -> _Table:
    """The table of a video; that of a file is cached, as reading it needs every packet."""
    if isinstance(video, bytes):
        return _read_table(video)
    try:
        stat = video.stat()
    except OSError as error:
        raise DamagedFile(f"{video} cannot be read: {error.strerror}", hint=MAKE_AGAIN) from error
    return _kept_table(video, stat.st_size, stat.st_mtime_ns)


@lru_cache(maxsize=8)  # a table of 100,000 frames takes 10 MB
def _kept_table(video: Path, _size: int, _changed: int) -> _Table:
    return _read_table(video)


def _read_table(video: bytes | Path) -> _Table:
    with _opened(video) as source:
        return source.scan()


# --- an open file --------------------------------------------------------------------------------------


class _Source:
    """An open video file."""

    def __init__(self, name: str, container: Any):
        self.name = name
        self.container = container
        self.stream = container.streams.video[0]
        self._converter = VideoReformatter()  # a frame's own rebuilds its tables, which takes longer than their use

    @property
    def size(self) -> tuple[int, int]:
        """Height and width, pixels."""
        return self.stream.codec_context.height, self.stream.codec_context.width

    def decode_ahead(self, ahead: bool) -> None:
        """Turn decoding of several frames at a time on or off; to be called before the first frame."""
        self.stream.thread_type = "AUTO" if ahead else "SLICE"

    def all(self) -> Iterator[av.VideoFrame]:
        """All frames, decoded from the start."""
        self.decode_ahead(True)
        shown = decoded = 0
        for packet in self._packets():
            shown += not packet.is_discard
            for frame in packet.decode():
                decoded += 1
                yield self._whole(frame)
        for frame in self.stream.decode(None):
            decoded += 1
            yield self._whole(frame)
        if decoded < shown:
            raise DamagedFile(f"{self.name}: only {decoded} of its {shown} frames can be decoded", hint=MAKE_AGAIN)

    def picture(self, frame: av.VideoFrame) -> NDArray[np.uint8]:
        """(H, W, 3) uint8 RGB of a frame."""
        return np.asarray(self._converter.reformat(frame, format="rgb24").to_ndarray(), np.uint8)

    def scan(self) -> _Table:
        """The times of the frames, read from the file's packets."""
        times: list[int] = []
        entries: list[_Entry] = []
        for packet in self._packets():
            if packet.pts is None:
                raise DamagedFile(f"{self.name} does not say when its frames are shown", hint="put it into MP4 again")
            if packet.is_keyframe:
                entries.append(_Entry(packet.pts, packet.pts if packet.dts is None else packet.dts))
            if not packet.is_discard:  # cut off by an edit list, decoded only for the sake of others
                times.append(packet.pts)
        if not entries or len(set(times)) < len(times):
            raise DamagedFile(f"{self.name} has no frame to start at, or two at the same time", hint=MAKE_AGAIN)
        return _Table(sorted(times), sorted(entries, key=lambda entry: entry.time), self.stream.time_base)

    def run(self, run: _Run) -> Iterator[NDArray[np.uint8]]:
        """The pictures of a run, in order of time."""
        self.container.seek(run.entry.seek, stream=self.stream)
        self.stream.codec_context.flush_buffers()
        left = len(run.times)
        started = False
        for packet in self.container.demux(self.stream):
            started = started or packet.pts == run.entry.time
            for frame in packet.decode() if started else ():
                if frame.pts in run.times:
                    yield self.picture(self._whole(frame))
                    left -= 1
            if not left:
                return
        raise DamagedFile(f"{self.name}: {left} of the requested frames cannot be decoded", hint=MAKE_AGAIN)

    def _packets(self) -> Iterator[Any]:
        """All packets, in the order of decoding."""
        count = 0
        for packet in self.container.demux(self.stream):
            if packet.is_corrupt:
                raise DamagedFile(f"{self.name} is cut off or damaged at frame {count}", hint=MAKE_AGAIN)
            if packet.size:
                count += 1
                yield packet
        claimed = min(self.stream.frames, len(self.stream.index_entries))
        if count < claimed:
            raise DamagedFile(f"{self.name} claims {claimed} frames and holds {count}", hint=MAKE_AGAIN)

    def _whole(self, frame: av.VideoFrame) -> av.VideoFrame:
        if frame.is_corrupt:
            raise DamagedFile(f"{self.name} is damaged {frame.time or 0:.3f} s after its start", hint=MAKE_AGAIN)
        return frame


@contextmanager
def _opened(video: bytes | Path) -> Iterator[_Source]:
    with open_video(video) as container:
        yield _Source(video_name(video), container)
