"""What compressed recordings can be written as, and whether those at hand fit into it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any, Literal

from vcage.base.errors import UsageError
from vcage.datasets.lerobot.formats import FORMATS
from vcage.datasets.lerobot.repack import require_whole
from vcage.datasets.packing.clips import Clip
from vcage.datasets.packing.sources import SourceRecording
from vcage.datasets.recordings.recording import HDF5, VIDEOS
from vcage.schema.compression import OtherStream

TARGETS = (HDF5, *FORMATS, VIDEOS)


@dataclass(frozen=True)
class OutputSpec:
    """What is to be written.

    Args:
        target: one of :data:`TARGETS`; None for what suits the recordings, see :func:`resolve_output`.
        fps: of recordings that do not say.
        task, robot: for a LeRobot data set, of recordings that do not say.
    """

    target: str | None = None
    fps: float | None = None
    task: str | None = None
    robot: str | None = None

    @property
    def lerobot(self) -> bool:
        """Whether it is a LeRobot data set."""
        return self.target in FORMATS


def resolve_output(wanted: OutputSpec, sources: Sequence[SourceRecording]) -> OutputSpec:
    """What is wanted, with a target, once it is sure that every recording can be written so.

    Raises:
        UsageError: one cannot; names it, and the option that is missing. Or episodes of a LeRobot data set are left out
            that is to keep its version, and with it the numbers of its episodes.
    """
    output = replace(wanted, target=wanted.target or sources[0].recording.TARGET)
    keeps = keeps_version(sources, output)
    if keeps:
        require_whole(sources[0].recording.path, [source.recording.number for source in sources])
    for source in sources:
        recording = source.recording
        if output.target == HDF5 != recording.TARGET:
            raise UsageError(
                f"{recording} is no HDF5 file, so none can be written with its videos beside it",
                hint=f"give --to {recording.TARGET}",
            )
        if output.lerobot and not (keeps or recording.task or output.task):
            raise UsageError(
                f"{recording} does not say what the robot was told, which LeRobot wants to know",
                hint='give --task "what it was told"',
            )
    return output


def keeps_version(sources: Sequence[SourceRecording], output: OutputSpec) -> bool:
    """Whether a LeRobot data set is written as one of the same version, so that only its pictures change."""
    return output.lerobot and all(output.target == source.recording.TARGET for source in sources)


def output_notes(sources: Sequence[SourceRecording], output: OutputSpec) -> dict[str, list[str]]:
    """Recording → what a user must know about what is written of it, besides how it was understood."""
    done = stays_or_not(sources, output)
    notes = {source.name: [f"{one}: {done}" for one in source.recording.other_streams] for source in sources}
    if not output.lerobot:
        return notes
    left_out = [] if keeps_version(sources, output) else sources[0].recording.left_out()
    if left_out:
        notes = {
            name: [f"left out, as another version is written: {', '.join(left_out)}", *own]
            for name, own in notes.items()
        }
    return {source.name: notes[source.name] + source.recording.state_notes for source in sources}


def stays_or_not(sources: Sequence[SourceRecording], output: OutputSpec) -> Literal["left as it was", "left out"]:
    """What becomes of the streams that no 8-bit video keeps: they stay in files that are written again."""
    return "left as it was" if output.target == HDF5 or keeps_version(sources, output) else "left out"


def other_streams(sources: Sequence[SourceRecording], output: OutputSpec) -> list[OtherStream]:
    """Depth, labels and the like of all recordings, and what becomes of them."""
    done = stays_or_not(sources, output)
    counts = Counter(stream for source in sources for stream in source.recording.other_streams)
    return [
        OtherStream(stream=one.key, shows=one.shows, stored=one.stored, done=done, recordings=count)
        for one, count in counts.items()
    ]


def require_alike(clips: Sequence[Clip], output: OutputSpec) -> None:
    """Nothing, if the recordings fit into what is wanted together: a LeRobot data set says once for all what they are.

    Raises:
        UsageError: one differs from the first in its cameras, their sizes, its frame rate or its numbers; names both.
            Or a camera of a LeRobot data set shows depth or grey, whatever is written.
        DamagedFile: the state of one holds NaN, or has not as many rows as there are pictures.
    """
    episodes = [list(group) for _, group in groupby(clips, key=lambda clip: clip.name)]
    for episode in episodes:
        episode[0].recording.require_rgb([clip.camera for clip in episode])
    if not output.lerobot:
        return
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
