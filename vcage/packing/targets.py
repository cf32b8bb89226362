"""What is written of compressed recordings: HDF5 with its videos beside it, a LeRobot data set, or videos alone."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from vcage.dataset.lerobot import FORMATS, open_writer
from vcage.dataset.lerobot_append import INFO
from vcage.dataset.lerobot_episode import LeRobotEpisode, episode_of
from vcage.dataset.lerobot_features import SUBTASK, other_columns
from vcage.dataset.lerobot_repack import repack, require_colour, require_whole
from vcage.dataset.packed import write_packed
from vcage.dataset.picture_links import Stream
from vcage.dataset.reader import EpisodeReader
from vcage.dataset.recordings.hdf5_layouts import Hdf5Recording, VcageEpisode
from vcage.dataset.recordings.lerobot_layouts import LeRobotRecording
from vcage.dataset.recordings.recording import Recording
from vcage.dataset.statistics import picture_histogram
from vcage.errors import UsageError
from vcage.files import atomic_path, read_json
from vcage.packing.campaign import Key
from vcage.packing.clips import Clip
from vcage.packing.sources import Source
from vcage.progress import Progress, silent
from vcage.schema.compression import VideoStream

T = TypeVar("T")

HDF5, VIDEOS = "hdf5", "videos"

TARGETS = (HDF5, *FORMATS, VIDEOS)

SAMPLES = 50
"""Pictures per episode and camera, evenly spaced, for the statistics of pixels."""


@dataclass(frozen=True)
class Wanted:
    """What is to be written.

    Args:
        target: one of :data:`TARGETS`; None for what suits the recordings, see :func:`suited`.
        task, robot, fps: for a LeRobot data set, of recordings that do not say.
    """

    target: str | None = None
    fps: float | None = None
    task: str | None = None
    robot: str | None = None


def suited(wanted: Wanted, sources: Sequence[Source]) -> Wanted:
    """What is wanted, with a target, once it is sure that every recording can be written so.

    Raises:
        UsageError: one cannot; names it, and the option that is missing. Or episodes of a LeRobot data set are left out
            that is to keep its version, and with it the numbers of its episodes.
    """
    wanted = replace(wanted, target=wanted.target or _own_target(sources[0].recording))
    keeps = _keeps_format(sources, wanted)
    if keeps:
        require_whole(sources[0].recording.path, _episodes(sources))
    left_out = [] if keeps else _left_out(sources[0].recording, wanted)
    for source in sources:
        recording = source.recording
        if wanted.target == HDF5 and not isinstance(recording, Hdf5Recording):
            raise UsageError(
                f"{recording} is no HDF5 file, so none can be written with its videos beside it",
                hint=f"give --to {_own_target(recording)}",
            )
        if wanted.target in FORMATS and not (keeps or recording.task or wanted.task):
            raise UsageError(
                f"{recording} does not say what the robot was told, which LeRobot wants to know",
                hint='give --task "what it was told"',
            )
        recording.notes += [note for note in left_out if note not in recording.notes]
    return wanted


def require_alike(clips: Sequence[Clip], wanted: Wanted) -> None:
    """Nothing, if the recordings fit into what is wanted together: a LeRobot data set says once for all what they are.

    Raises:
        UsageError: one differs from the first in its cameras, their sizes, its frame rate or its numbers; names both.
            Or a camera of a LeRobot data set shows depth or grey.
        DamagedFile: the state of one holds NaN, or has not as many rows as there are pictures.
    """
    if wanted.target not in FORMATS:
        return
    if isinstance(clips[0].recording, LeRobotRecording):
        require_colour(clips[0].recording.path, {clip.recording.camera(clip.camera).key for clip in clips})
    episodes = [list(group) for _, group in groupby(clips, key=lambda clip: clip.name)]
    first = _facts(episodes[0])
    for episode in episodes[1:]:
        for what, value in _facts(episode).items():
            if value != first[what]:
                raise UsageError(
                    f"{episode[0].recording} has other {what} ({value}) than {episodes[0][0].recording} "
                    f"({first[what]}), and a LeRobot data set holds one kind of episodes",
                    hint="compress them apart, name the cameras that all have with --cameras, or give --to hdf5",
                )


def _facts(clips: Sequence[Clip]) -> dict[str, Any]:
    """What all episodes of a LeRobot data set have in common, of the clips of one."""
    recording = clips[0].recording
    cameras = [recording.camera(clip.camera) for clip in clips]
    return {
        "cameras": ", ".join(f"{camera.name} {camera.width}x{camera.height}" for camera in cameras),
        "frame rate": clips[0].fps,
        "numbers in its state": len(recording.state_names),
        "numbers in its commands": len(recording.action_names),
    }


def _keeps_format(sources: Sequence[Source], wanted: Wanted) -> bool:
    """Whether a LeRobot data set is written as one of the same version, so that only its pictures change."""
    return all(isinstance(one.recording, LeRobotRecording) and wanted.target == one.recording.LAYOUT for one in sources)


def _episodes(sources: Sequence[Source]) -> dict[int, str]:
    """Number of an episode in its LeRobot data set → name of the recording."""
    return {one.recording.index: one.name for one in sources if isinstance(one.recording, LeRobotRecording)}


def _left_out(recording: Recording, wanted: Wanted) -> list[str]:
    """Says which columns do not come along from a LeRobot data set into one of another version."""
    if wanted.target not in FORMATS or not isinstance(recording, LeRobotRecording):
        return []
    features = read_json(recording.path / INFO)["features"]
    names = [name for name in other_columns(features) if features[name]["dtype"] != "image"]
    names += [SUBTASK] if SUBTASK in features else []
    return [f"left out, as another version is written: {', '.join(names)}"] if names else []


def _own_target(recording: Recording) -> str:
    """Its own kind of files, and videos alone for pictures."""
    if isinstance(recording, Hdf5Recording):
        return HDF5
    return recording.LAYOUT if isinstance(recording, LeRobotRecording) else VIDEOS


def write_target(
    sources: Sequence[Source],
    streams: Mapping[Key, VideoStream],
    videos: Mapping[Key, Path],
    wanted: Wanted,
    out: Path,
    progress: Progress = silent,
) -> None:
    """Write the recordings with their videos into the folder ``out``, which is new.

    Raises:
        UsageError: recordings do not fit into one LeRobot data set.
        DamagedFile: a recording cannot be read.
        DiskFull, OutputFolderError: the folder cannot be written.
    """
    writer: Callable[..., None] = {HDF5: _write_hdf5, VIDEOS: _write_videos}.get(str(wanted.target), _write_lerobot)
    writer(sources, streams, videos, wanted, out, progress)


def _write_videos(
    sources: Sequence[Source],
    streams: Mapping[Key, VideoStream],
    videos: Mapping[Key, Path],
    _wanted: Wanted,
    out: Path,
    _progress: Progress,
) -> None:
    for key, stream in streams.items():
        _copy(videos[key], out / stream.file)


def _copy(file: Path, target: Path) -> None:
    with atomic_path(target) as part:
        shutil.copyfile(file, part)


def _write_hdf5(
    sources: Sequence[Source],
    streams: Mapping[Key, VideoStream],
    videos: Mapping[Key, Path],
    wanted: Wanted,
    out: Path,
    progress: Progress,
) -> None:
    _write_videos(sources, streams, videos, wanted, out, progress)
    streams_of = _by_recording(streams)
    for number, source in enumerate(sources):
        progress(f"writing {source.name}", number, len(sources))
        own = [_link(source.recording, stream) for stream in streams_of[source.name].values()]
        target = out / f"{source.name}.hdf5"
        write_packed(source.recording.path, target, own)
        for video in _kept_videos(source.recording, own):
            _copy(video, target.with_name(video.name))


def _by_recording(of: Mapping[Key, T]) -> dict[str, dict[str, T]]:
    """Recording → camera → what there is of it."""
    found: dict[str, dict[str, T]] = {}
    for (name, camera), one in of.items():
        found.setdefault(name, {})[camera] = one
    return found


def _kept_videos(recording: Recording, replaced: Sequence[Stream]) -> list[Path]:
    """Videos of a recording that was compressed before, of cameras that are not compressed now."""
    if not isinstance(recording, Hdf5Recording):
        return []
    keys = {stream.key for stream in replaced}
    return [video for key, video in recording.videos.items() if key not in keys]


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


def _write_lerobot(
    sources: Sequence[Source],
    streams: Mapping[Key, VideoStream],
    videos: Mapping[Key, Path],
    wanted: Wanted,
    out: Path,
    progress: Progress,
) -> None:
    if _keeps_format(sources, wanted):
        _repack_lerobot(sources, streams, videos, out, progress)
        return
    videos_of = _by_recording(videos)
    with open_writer(str(wanted.target), out, encodings(list(streams.values()))) as writer:
        for number, source in enumerate(sources):
            progress(f"writing {source.name}", number, len(sources))
            writer.add(lerobot_episode(source.recording, videos_of[source.name], wanted))


def _repack_lerobot(
    sources: Sequence[Source],
    streams: Mapping[Key, VideoStream],
    videos: Mapping[Key, Path],
    out: Path,
    progress: Progress,
) -> None:
    """All stays as it is but the videos of the cameras that were compressed."""
    recording = sources[0].recording
    told = {recording.camera(camera).key: facts for camera, facts in encodings(list(streams.values())).items()}
    new: dict[str, dict[int, Path]] = {key: {} for key in told}
    for episode, name in _episodes(sources).items():
        for camera in {camera for _, camera in videos}:
            new[recording.camera(camera).key][episode] = videos[name, camera]
    repack(recording.path, out, new, told, progress)


def lerobot_episode(recording: Recording, videos: Mapping[str, Path], wanted: Wanted) -> LeRobotEpisode:
    """A recording with its videos, as an episode of a LeRobot data set."""
    frames = recording.camera(next(iter(videos))).frames
    sample = np.unique(np.linspace(0, frames - 1, SAMPLES).astype(int)).tolist()
    histograms = {camera: picture_histogram(recording.pictures(camera, sample)) for camera in videos}
    if isinstance(recording, VcageEpisode):
        with EpisodeReader(recording.path) as reader:
            return episode_of(reader.episode, videos, histograms, len(sample))
    return _foreign(recording, videos, histograms, len(sample), wanted, frames)


def _foreign(
    recording: Recording,
    videos: Mapping[str, Path],
    histograms: Mapping[str, NDArray[np.int64]],
    sampled: int,
    wanted: Wanted,
    frames: int,
) -> LeRobotEpisode:
    motion = recording.motion
    return LeRobotEpisode(
        fps=recording.fps or wanted.fps or 0.0,
        robot=recording.robot or wanted.robot or "unknown",
        task=recording.task or wanted.task or "",
        videos=videos,
        histograms=histograms,
        sampled=sampled,
        state=recording.state,
        state_names=recording.state_names,
        action=None if motion is None else motion.action,
        action_names=recording.action_names,
        frames=frames,
    )


def encodings(streams: Sequence[VideoStream]) -> dict[str, dict[str, Any]]:
    """Camera → what ``info.json`` says of its encoding beyond the stream itself, if all its streams have it alike."""
    told: dict[str, dict[str, Any]] = {}
    for camera in sorted({stream.camera for stream in streams}):
        own = [stream for stream in streams if stream.camera == camera]
        facts: dict[str, Any] = {"video.g": own[0].gop, "video.crf": own[0].crf}
        if own[0].lossless:
            facts = {"video.g": own[0].gop, "video.lossless": True}
        alike = all((s.gop, s.crf) == (own[0].gop, own[0].crf) for s in own)
        told[camera] = facts if alike else {"video.pix_fmt": None}  # which may differ too
    return told
