"""The search over a data set: which videos share a CRF, in what order they are searched, and by how many processes.

Where a camera's episodes share one, a few of them choose pixel format and GOP; then all are searched below the CRF that
those allow, and what was encoded above the lowest that any allows is encoded again, until all agree. The rounds do not
depend on the number of processes, so neither does the result.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from vcage.base.progress import Progress, silent
from vcage.base.workers import cores, in_processes
from vcage.datasets.packing.clips import Clip, EncodedVideo, SearchTask, is_finished, known, perform
from vcage.datasets.packing.memory import free_memory
from vcage.datasets.packing.settings import CompressionSettings
from vcage.schema.compression import VideoStream
from vcage.video.choices import LOSSLESS, Choices
from vcage.video.codec import formats_for
from vcage.video.encoders import CODECS, require_encoder
from vcage.video.jod import require_display

SAMPLE = 3
"""Episodes that choose pixel format and GOP for all."""

COPIES = 3
"""How often a clip is in memory at most: itself, decoded frames, and what the encoder holds."""

OF_A_PROCESS = 1_500_000_000
"""Bytes that a process takes besides its clip, most of it for the metric."""

Key = tuple[str, str]
"""Recording and camera."""


@dataclass(frozen=True)
class Bound:
    """What a camera's episodes agree on so far.

    Args:
        pixel_format, gop: of all.
        crf: the highest that is still possible; :data:`LOSSLESS` when none is.
    """

    pixel_format: str
    gop: int
    crf: int

    def kept_by(self, stream: VideoStream) -> bool:
        """Whether a stream is already encoded so."""
        if self.crf == LOSSLESS:
            return stream.lossless
        return (stream.pixel_format, stream.gop, stream.crf) == (self.pixel_format, self.gop, self.crf)


def search_data_set(
    clips: Sequence[Clip],
    settings: CompressionSettings,
    folder: Path,
    *,
    workers: int | None = None,
    threads: int | None = None,
    progress: Progress = silent,
) -> dict[Key, EncodedVideo]:
    """Search and encode all clips; what an interrupted call left in ``folder`` is taken up.

    Args:
        clips: every camera of every recording.
        settings: how.
        folder: for the videos and what is known of them.
        workers: processes at most, no more than there are clips; None takes as many as there are cores and memory for.
        threads: of the encoder in each process; None shares the cores out.
        progress: told of each clip that was encoded; its number falls where clips must be encoded again.

    Returns:
        (recording, camera) → its video in ``folder``, in the order of the clips.

    Raises:
        UnknownName, MissingDependency: see :func:`require_tools`.
        VcageError: of any clip, see :func:`vcage.datasets.packing.clips.perform`; what was finished stays in
            ``folder``.
    """
    require_tools(settings)
    workers = workers_for(clips, workers)
    return _DataSetSearch(list(clips), settings, folder, workers, threads or encoder_threads(workers), progress).run()


def require_tools(settings: CompressionSettings) -> None:
    """Nothing, if this machine has what the search needs.

    Raises:
        UnknownName, MissingDependency: there is no such display model, or the metric or encoder is not installed.
    """
    require_encoder(CODECS[settings.codec])
    require_display(settings.display)


def workers_for(clips: Sequence[Clip], most: int | None = None) -> int:
    """Processes that are of use: no more than there are clips, at least one.

    Args:
        clips: the work.
        most: that there may be; None for as many as this machine has cores and memory for.
    """
    if most is None:
        largest = max((c.recording.camera(c.camera).raw_bytes for c in clips), default=0)
        most = min(cores(), free_memory() // (COPIES * largest + OF_A_PROCESS))
    return max(1, min(most, len(clips)))


def encoder_threads(workers: int) -> int:
    """Threads of the encoder in each of so many processes."""
    return max(1, cores() // workers)


def cameras_of(clips: Iterable[Clip]) -> list[str]:
    """Names of the cameras, sorted."""
    return sorted({clip.camera for clip in clips})


def sample_of(clips: Sequence[Clip]) -> list[Clip]:
    """A few clips of each camera, evenly spaced over the data set."""
    sample = []
    for camera in cameras_of(clips):
        own = [clip for clip in clips if clip.camera == camera]
        places = np.unique(np.linspace(0, len(own) - 1, SAMPLE).round().astype(int))
        sample += [own[place] for place in places]
    return sample


@dataclass(frozen=True)
class _Found:
    """What a clip was searched with last, and what was found."""

    task: SearchTask
    stream: VideoStream


@dataclass
class _DataSetSearch:
    clips: list[Clip]
    settings: CompressionSettings
    folder: Path
    workers: int
    threads: int
    progress: Progress
    found: dict[Key, _Found] = field(default_factory=dict)

    def run(self) -> dict[Key, EncodedVideo]:
        choices = self.settings.choices()
        if self.settings.scope != "camera" or self.settings.crf is not None:
            self._round({_key(clip): choices for clip in self.clips})
            return self._videos()
        self._round({_key(clip): choices for clip in sample_of(self.clips)})
        bounds = {camera: self._agreed(camera) for camera in cameras_of(self.clips)}
        while waiting := self._unsettled(bounds):
            self._round({_key(clip): self._below(bounds[clip.camera]) for clip in waiting})
            bounds = {camera: self._lowered(camera, bound) for camera, bound in bounds.items()}
        return self._videos()

    def _agreed(self, camera: str) -> Bound:
        """What most episodes of the sample chose of what all can have, at the lowest CRF of any of them."""
        found = self._of(camera)
        if any(stream.lossless for stream in found):
            return Bound(found[0].pixel_format, found[0].gop, LOSSLESS)
        formats = self._formats(camera)
        chosen = Counter((s.pixel_format, s.gop) for s in found if s.pixel_format in formats).most_common(1)
        pixel_format, gop = chosen[0][0] if chosen else (formats[0], found[0].gop)
        return Bound(pixel_format, gop, min(s.crf for s in found if s.crf is not None))

    def _lowered(self, camera: str, bound: Bound) -> Bound:
        """The bound that all episodes allow; where none does in a chosen pixel format, the best one gets its turn."""
        found = self._of(camera)
        if bound.crf == LOSSLESS or any(stream.lossless for stream in found):
            best = self._formats(camera)[0]
            if bound.crf != LOSSLESS and bound.pixel_format != best:
                return Bound(best, bound.gop, self.settings.choices().highest)
            return Bound(bound.pixel_format, bound.gop, LOSSLESS)
        return Bound(bound.pixel_format, bound.gop, min(bound.crf, *(s.crf for s in found if s.crf is not None)))

    def _formats(self, camera: str) -> list[str]:
        """The pixel formats that all episodes of a camera can have, the best first."""
        choices = self.settings.choices()
        cameras = [clip.recording.camera(camera) for clip in self.clips if clip.camera == camera]
        fitting = [
            formats_for(choices.settings(), *size, choices.pixel_formats)
            for size in {(c.width, c.height) for c in cameras}
        ]
        common = [name for name in fitting[0] if all(name in names for names in fitting)]
        # where nothing could be kept without loss, only the best is sure to leave no episode behind
        return common if choices.settings().facts.lossless_format else common[:1]

    def _below(self, bound: Bound) -> Choices:
        choices = self.settings.choices()
        settings = choices.settings(gop=bound.gop)
        if bound.crf != LOSSLESS:
            settings = choices.settings(bound.pixel_format, bound.gop)
        return choices.fixed(settings, bound.crf)

    def _of(self, camera: str) -> list[VideoStream]:
        return [self.found[key].stream for key in sorted(self.found) if key[1] == camera]

    def _unsettled(self, bounds: Mapping[str, Bound]) -> list[Clip]:
        settled = {key for key, one in self.found.items() if bounds[key[1]].kept_by(one.stream)}
        return [clip for clip in self.clips if _key(clip) not in settled]

    def _round(self, wanted: Mapping[Key, Choices]) -> None:
        """Search clips with the choices given, as many at a time as there are processes."""
        tasks = [self._task(clip, wanted[_key(clip)]) for clip in self.clips if _key(clip) in wanted]
        waiting = []
        for task in tasks:
            # a video that a later round replaced is not needed again, what was found in it is
            stream = known(task)
            if stream is None:
                waiting.append(task)
            else:
                self._note(task, stream)
        self._perform(waiting)

    def _perform(self, tasks: Sequence[SearchTask]) -> None:
        of = {_key(task.clip): task for task in tasks}
        again = len(self.found.keys() & of.keys())
        for clip, stream in in_processes(perform, tasks, self.workers):
            quality = "lossless" if stream.crf is None else f"CRF {stream.crf}"
            self.progress(f"{clip.name} {clip.camera}, {quality}", len(self.found) - again, len(self.clips))
            again -= _key(clip) in self.found
            self._note(of[_key(clip)], stream)

    def _videos(self) -> dict[Key, EncodedVideo]:
        """All videos in the order of the clips, of which those that an interruption left unwritten are made now."""
        self._perform([one.task for one in self.found.values() if not is_finished(one.task)])
        found = {_key(clip): self.found[_key(clip)] for clip in self.clips}
        return {key: EncodedVideo(one.task.video, one.stream) for key, one in found.items()}

    def _task(self, clip: Clip, choices: Choices) -> SearchTask:
        return SearchTask(
            clip=clip,
            choices=choices,
            criterion=self.settings.criterion(),
            display=self.settings.display,
            keyframes=self.settings.keyframes,
            folder=self.folder,
            threads=self.threads,
        )

    def _note(self, task: SearchTask, stream: VideoStream) -> None:
        before = self.found.get(_key(task.clip))
        if before is not None and before.task.video != task.video:
            before.task.video.unlink(missing_ok=True)
        self.found[_key(task.clip)] = _Found(task, stream)


def _key(clip: Clip) -> Key:
    return clip.name, clip.camera
