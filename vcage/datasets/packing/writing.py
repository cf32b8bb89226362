"""Compressed recordings as files: HDF5 with its videos beside it, a LeRobot data set, or videos alone."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import h5py

from vcage.base.files import atomic_path
from vcage.base.progress import Progress
from vcage.datasets.lerobot.formats import open_writer
from vcage.datasets.lerobot.repack import repack
from vcage.datasets.packed import write_packed
from vcage.datasets.packing.dataset_search import Key
from vcage.datasets.packing.lerobot_episodes import encodings, lerobot_episode
from vcage.datasets.packing.sources import Source
from vcage.datasets.packing.targets import HDF5, VIDEOS, Wanted, episode_names, keeps_format
from vcage.datasets.picture_links import Stream, find_links
from vcage.datasets.recordings.hdf5_layouts import damage
from vcage.datasets.recordings.recording import Recording
from vcage.schema.compression import VideoStream

T = TypeVar("T")


@dataclass(frozen=True)
class Compressed:
    """Recordings, and what a campaign made of them.

    Args:
        sources: the recordings.
        streams: (recording, camera) → what is known of its video.
        videos: (recording, camera) → the video.
        preset: of the encoder of all.
    """

    sources: Sequence[Source]
    streams: Mapping[Key, VideoStream]
    videos: Mapping[Key, Path]
    preset: str


def write_target(compressed: Compressed, wanted: Wanted, out: Path, progress: Progress) -> None:
    """Write recordings with their videos into the folder ``out``, which is new.

    Raises:
        UsageError: recordings do not fit into one LeRobot data set.
        DamagedFile: a recording cannot be read.
        DiskFull, OutputFolderError: the folder cannot be written.
    """
    writer: Callable[..., None] = {HDF5: _write_hdf5, VIDEOS: _write_videos}.get(str(wanted.target), _write_lerobot)
    writer(compressed, wanted, out, progress)


def _write_videos(compressed: Compressed, _wanted: Wanted, out: Path, _progress: Progress) -> None:
    for key, stream in compressed.streams.items():
        _copy(compressed.videos[key], out / stream.file)


def _copy(file: Path, target: Path) -> None:
    with atomic_path(target) as part:
        shutil.copyfile(file, part)


def _write_hdf5(compressed: Compressed, wanted: Wanted, out: Path, progress: Progress) -> None:
    _write_videos(compressed, wanted, out, progress)
    streams_of = _by_recording(compressed.streams)
    links: dict[str, list[Stream]] = {}
    for source in compressed.sources:
        own = streams_of[source.name].values()
        links.setdefault(source.file, []).extend(_link(source.recording, stream) for stream in own)
    paths = {source.file: source.recording.path for source in compressed.sources}
    for number, (file, path) in enumerate(paths.items()):
        progress(f"writing {file}", number, len(paths))
        target = out / f"{file}.hdf5"
        write_packed(path, target, links[file])
        for video in _kept_videos(path, links[file]):
            _copy(video, target.with_name(video.name))


def _by_recording(of: Mapping[Key, T]) -> dict[str, dict[str, T]]:
    """Recording → camera → what there is of it."""
    found: dict[str, dict[str, T]] = {}
    for (name, camera), one in of.items():
        found.setdefault(name, {})[camera] = one
    return found


def _kept_videos(path: Path, replaced: Sequence[Stream]) -> list[Path]:
    """Videos of a file that was compressed before, of pictures that are not compressed now. Those of a demonstration
    that is left out may be missing, and stay so."""
    keys = {stream.key for stream in replaced}
    with damage(path), h5py.File(path) as file:
        kept = [link.stream.file for key, link in find_links(file).items() if key not in keys]
    return [video for name in kept if (video := path.with_name(name)).is_file()]


def _link(recording: Recording, stream: VideoStream) -> Stream:
    camera = recording.camera(stream.camera)
    return Stream(
        camera=camera.name,
        key=camera.key,
        file=Path(stream.file).name,
        frames=camera.frames,
        width=camera.width,
        height=camera.height,
        storage=camera.storage,
        swapped=recording.swapped(camera.name),
    )


# --- LeRobot -------------------------------------------------------------------------------------------


def _write_lerobot(compressed: Compressed, wanted: Wanted, out: Path, progress: Progress) -> None:
    if keeps_format(compressed.sources, wanted):
        _repack_lerobot(compressed, out, progress)
        return
    videos_of = _by_recording(compressed.videos)
    with open_writer(
        str(wanted.target), out, encodings(list(compressed.streams.values()), compressed.preset)
    ) as writer:
        for number, source in enumerate(compressed.sources):
            progress(f"writing {source.name}", number, len(compressed.sources))
            writer.add(lerobot_episode(source.recording, videos_of[source.name], wanted))


def _repack_lerobot(compressed: Compressed, out: Path, progress: Progress) -> None:
    """All stays as it is but the videos of the cameras that were compressed."""
    recording = compressed.sources[0].recording
    told = {
        recording.camera(camera).key: facts
        for camera, facts in encodings(list(compressed.streams.values()), compressed.preset).items()
    }
    new: dict[str, dict[int, Path]] = {key: {} for key in told}
    for episode, name in episode_names(compressed.sources).items():
        for camera in {camera for _, camera in compressed.videos}:
            new[recording.camera(camera).key][episode] = compressed.videos[name, camera]
    repack(recording.path, out, new, told, progress)
