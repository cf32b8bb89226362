"""What the files of accepted episodes hold: raw pictures, or links to the videos that these were compressed to.

The videos lie beside the episodes' files (hard links to those of the compression, where the file system has them), so
that the folder of episodes can be read, copied and added to by itself. A file is replaced as a whole, after its videos:
a stage that is killed leaves it with the one or the other.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from itertools import chain
from pathlib import Path

from vcage.base.errors import DamagedFile, InputFileError, MissingStage, StaleStage
from vcage.base.files import RunFolder, atomic_path, sha256_file
from vcage.base.videos import decoded_count
from vcage.base.workers import cores
from vcage.datasets.hdf5_files import damage, open_hdf5_file
from vcage.datasets.packed import write_packed
from vcage.datasets.packing.writing import link_to
from vcage.datasets.picture_links import find_links
from vcage.datasets.recordings.opening import open_hdf5
from vcage.schema.compression import Compression, VideoStream


def holds_links(path: Path) -> bool:
    """Whether the pictures of an episode lie in videos beside its file.

    Raises:
        DamagedFile: it cannot be read.
    """
    with damage(path), open_hdf5_file(path) as file:
        return bool(find_links(file))


def require_raw(paths: Iterable[Path]) -> None:
    """Nothing, if these episodes hold their raw pictures.

    Raises:
        MissingStage: some do not; says how to have them again.
    """
    gone = [path for path in paths if holds_links(path)]
    if gone:
        raise MissingStage(
            f"{gone[0]}{f' and {len(gone) - 1} more' if gone[1:] else ''} holds no raw pictures any more: they were "
            "compressed, and it refers to their videos",
            hint="record the episodes again, and compress them with --keep-raw",
            maker="collect",
            details={"episodes": [str(path) for path in gone]},
        )


def originals(run: RunFolder) -> dict[str, str]:
    """SHA-256 of episodes that refer to videos → that of the same with raw pictures, which the run's other files were
    made from; none where the run was not compressed."""
    with suppress(InputFileError):
        record = Compression.read(run.compression)
        counted = {now: record.provenance.inputs[file] for file, now in record.packed.items()}
        return counted | {one.packed: one.original for one in record.set_aside.values()}
    return {}


def packed_hash(run: RunFolder, streams: Iterable[VideoStream], scratch: Path) -> str:
    """SHA-256 that an episode's file will have once it refers to its videos.

    Args:
        run: its run.
        streams: its videos, all of one episode.
        scratch: a folder for what is written meanwhile.
    """
    digest = sha256_file(target := _packed(run, list(streams), scratch))
    target.unlink()
    return digest


def refer_to_videos(run: RunFolder, record: Compression, scratch: Path) -> None:
    """Let every compressed episode of a run refer to its videos, which lie beside it from now on.

    Args:
        run: the run.
        record: of its compression.
        scratch: a folder on the same file system for what is written meanwhile.

    Raises:
        DamagedFile: a video does not hold what it should; then all episodes keep their pictures.
        DiskFull, OutputFolderError: the episodes cannot be written.
    """
    waiting = {
        file: [stream for stream in record.streams if stream.episode == file]
        for file in record.packed
        if not holds_links(run.file(file))
    }
    with ThreadPoolExecutor(cores()) as pool:  # FFmpeg releases the interpreter
        list(pool.map(partial(_verify, run), chain(*waiting.values())))
    for file, streams in waiting.items():
        path = run.file(file)
        for stream in streams:
            _beside(run.file(stream.file), path)
        packed = _packed(run, streams, scratch)
        if sha256_file(packed) != record.packed[file]:
            raise StaleStage(
                f"{run.compression} was made with another version of HDF5, which stores {file} in other bytes",
                hint="leave the raw pictures with --keep-raw",
            )
        os.replace(packed, path)


def _packed(run: RunFolder, streams: list[VideoStream], scratch: Path) -> Path:
    path = run.file(streams[0].episode)
    recording = open_hdf5(path)
    return write_packed(path, scratch / path.name, [link_to(recording, stream) for stream in streams])


def _verify(run: RunFolder, stream: VideoStream) -> None:
    """Decode all of a video.

    Raises:
        DamagedFile: it does not hold what was written.
    """
    video = run.file(stream.file)
    frames = decoded_count(video)
    if frames != stream.frames or video.stat().st_size != stream.bytes:
        raise DamagedFile(
            f"{video} holds {frames} frames in {video.stat().st_size} bytes, {stream.frames} in {stream.bytes} were "
            "written",
            maker="compress",
        )


def _beside(video: Path, episode: Path) -> None:
    """Give a video a second name in the folder of its episode."""
    with atomic_path(episode.with_name(video.name)) as part:
        try:
            os.link(video, part)
        except OSError:  # a file system without hard links
            shutil.copyfile(video, part)
