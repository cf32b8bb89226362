"""What compressed recordings can be written as, and whether those at hand fit into it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

from vcage.base.errors import UsageError
from vcage.base.files import read_json
from vcage.datasets.lerobot.features import SUBTASK, other_columns
from vcage.datasets.lerobot.formats import FORMATS
from vcage.datasets.lerobot.info import INFO
from vcage.datasets.lerobot.repack import require_colour, require_whole
from vcage.datasets.packing.clips import Clip
from vcage.datasets.packing.sources import Source
from vcage.datasets.recordings.hdf5_layouts import Hdf5Recording
from vcage.datasets.recordings.lerobot_layouts import LeRobotRecording
from vcage.datasets.recordings.recording import Recording

HDF5, VIDEOS = "hdf5", "videos"

TARGETS = (HDF5, *FORMATS, VIDEOS)


@dataclass(frozen=True)
class Wanted:
    """What is to be written.

    Args:
        target: one of :data:`TARGETS`; None for what suits the recordings, see :func:`suited`.
        fps: of recordings that do not say.
        task, robot: for a LeRobot data set, of recordings that do not say.
    """

    target: str | None = None
    fps: float | None = None
    task: str | None = None
    robot: str | None = None


def suited(wanted: Wanted, sources: Sequence[Source]) -> Wanted:
    """What is wanted, with a target, once it is sure that every recording can be written so.

    The recordings get a note where a part of them is left out of what is written.

    Raises:
        UsageError: one cannot; names it, and the option that is missing. Or episodes of a LeRobot data set are left out
            that is to keep its version, and with it the numbers of its episodes.
    """
    wanted = replace(wanted, target=wanted.target or _own_target(sources[0].recording))
    keeps = keeps_format(sources, wanted)
    if keeps:
        require_whole(sources[0].recording.path, episode_names(sources))
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


def keeps_format(sources: Sequence[Source], wanted: Wanted) -> bool:
    """Whether a LeRobot data set is written as one of the same version, so that only its pictures change."""
    return all(isinstance(one.recording, LeRobotRecording) and wanted.target == one.recording.LAYOUT for one in sources)


def episode_names(sources: Sequence[Source]) -> dict[int, str]:
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
