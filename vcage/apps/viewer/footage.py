"""Camera pictures as JPEG, or the videos of a compressed run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vcage.apps.viewer.rerun_log import Clock, RerunLog, rr
from vcage.base.commands import vcage_command
from vcage.base.errors import DamagedFile, MissingStage
from vcage.base.files import RunFolder
from vcage.base.pictures import jpeg
from vcage.schema.compression import Compression


@dataclass(frozen=True)
class PictureSettings:
    """Settings of pictures in a Rerun recording.

    Args:
        jpeg_quality: of each picture.
        chunk_rows: pictures sent at a time: bounds the memory, and keeps the chunks small that the viewer
            loads.
    """

    jpeg_quality: int = 90
    chunk_rows: int = 64


SETTINGS = PictureSettings()


def log_pictures(log: RerunLog, entity: str, clock: Clock, read: Callable[[range], NDArray[np.uint8]]) -> None:
    """Pictures as JPEG.

    Args:
        read: gives the pictures (N, H, W, 3) uint8 RGB of a range of rows.
    """
    for start in range(0, len(clock), SETTINGS.chunk_rows):
        rows = range(start, min(start + SETTINGS.chunk_rows, len(clock)))
        files = [jpeg(picture, SETTINGS.jpeg_quality) for picture in read(rows)]
        columns = rr.EncodedImage.columns(blob=files, media_type=["image/jpeg"] * len(files))
        log.rows(entity, clock.at(rows), columns)


def log_video(log: RerunLog, entity: str, clock: Clock, file: Path) -> None:
    """A video as it is, one frame of it for each row.

    Args:
        log: where it is written.
        entity: that shows it.
        clock: when its frames are.
        file: the video.

    Raises:
        DamagedFile: it is no video, or has another number of frames than ``clock`` has rows.
    """
    try:
        video = rr.AssetVideo(path=file)
        shown = video.read_frame_timestamps_nanos()
    except (OSError, RuntimeError, ValueError) as error:
        raise _bad_video(f"{file} cannot be read: {error}") from error
    if len(shown) != len(clock):
        raise _bad_video(f"{file} has {len(shown)} frames, its episode {len(clock)}")
    log.always(entity, video)
    log.rows(entity, clock, rr.VideoFrameReference.columns_nanos(shown))


def compressed_videos(episode: Path) -> dict[str, Path]:
    """Camera → video of an episode in a run folder, as ``compress`` left them.

    Raises:
        MissingStage: the run, if it is one, was not compressed, or without this episode.
        DamagedFile, SchemaMismatch: see :meth:`vcage.schema.base.Document.read`.
    """
    run = RunFolder(episode.resolve().parents[1])
    record = run.compression
    streams = Compression.read(record).streams if record.is_file() else []
    videos = {s.camera: run.file(s.file) for s in streams if s.episode == run.relative(episode)}
    if not videos:
        raise MissingStage(
            f"{episode} has no compressed videos: looked in {record}",
            hint="leave out --pictures compressed, or compress first",
            command=vcage_command("compress", "--run", run),
        )
    return videos


def _bad_video(message: str) -> DamagedFile:
    return DamagedFile(message, hint="make the videos again, by the stage compress")
