"""The search over a data set: videos that share a CRF, the order of the searches, and the number of processes.

Where a camera's episodes share one, they come to it step by step (:mod:`vcage.datasets.packing.agreement`); the steps
of all cameras are taken side by side.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from vcage.base.folders import natural_key
from vcage.base.memory import free_memory
from vcage.base.progress import Progress, silent
from vcage.base.workers import Processes, SameProcess, cores
from vcage.datasets.packing.agreement import Agreement, Bound
from vcage.datasets.packing.clips import Clip, EncodedVideo, Key, SearchTask, is_finished, known, perform
from vcage.datasets.packing.settings import CompressionSettings
from vcage.schema.compression import Evaluation, VideoStream
from vcage.video.choices import LOSSLESS, Choices
from vcage.video.codec import formats_for
from vcage.video.encoders import CODECS, require_encoder
from vcage.video.jod import require_display


def search_data_set(
    clips: Sequence[Clip],
    settings: CompressionSettings,
    folder: Path,
    *,
    agreed: Mapping[str, Bound] | None = None,
    workers: int | None = None,
    progress: Progress = silent,
) -> dict[Key, EncodedVideo]:
    """Search and encode all clips; continue the work of an interrupted call in ``folder``.

    Args:
        clips: every camera of every recording.
        settings: of the search.
        folder: for the videos and their records.
        agreed: camera → the agreement of other episodes, which stay unchanged; it is the highest that these get.
        workers: largest number of processes, up to one per clip; None for as many as cores and memory allow.
        progress: called for each encoded clip; its number falls where clips must be encoded again.

    Returns:
        (recording, camera) → its video in ``folder``, in the order of the clips.

    Raises:
        UnknownName, MissingDependency: see :func:`require_tools`.
        VcageError: of any clip, see :func:`vcage.datasets.packing.clips.perform`; finished work stays in ``folder``.
    """
    require_tools(settings)
    workers = workers_for(clips, workers)
    with Processes(perform, workers) if workers > 1 else SameProcess(perform) as crew:
        return _DataSetSearch(list(clips), settings, folder, crew, progress, agreed or {}).run()


def require_tools(settings: CompressionSettings) -> None:
    """Require the tools of the search.

    Raises:
        UnknownName, MissingDependency: there is no such display model, or the metric or encoder is not installed.
    """
    require_encoder(CODECS[settings.codec])
    require_display(settings.display)


def workers_for(
    clips: Sequence[Clip], most: int | None = None, clip_copies: int = 3, process_bytes: int = 500_000_000
) -> int:
    """Return the number of useful processes: at least one, at most one per clip.

    Args:
        clips: the work.
        most: upper limit; None for as many as this machine has cores and memory for.
        clip_copies: copies of a clip in the memory of a process at most: itself, decoded frames, and those of the
            encoder.
        process_bytes: memory of a process besides its clip; measured, it takes half of it.
    """
    if most is None:
        largest = max((c.recording.camera(c.camera).raw_bytes for c in clips), default=0)
        most = min(cores(), free_memory() // (clip_copies * largest + process_bytes))
    return max(1, min(most, len(clips)))


def cameras_of(clips: Iterable[Clip]) -> list[str]:
    """Return the names of the cameras, in natural order."""
    return sorted({clip.camera for clip in clips}, key=natural_key)


def stored_per_frame(clip: Clip) -> float:
    """Return stored bytes per frame: pictures that are hard to store are hard to encode.

    Where pictures are not compressed, all are alike. Measured on ten episodes of three cameras, deflated: with two of
    these the loss at a CRF follows the bytes (rank correlation .9), with the third, where all lose about as much, less
    (.3).
    """
    camera = clip.recording.camera(clip.camera)
    return camera.stored_bytes / camera.frames


@dataclass
class _DataSetSearch:
    clips: list[Clip]
    settings: CompressionSettings
    folder: Path
    crew: SameProcess[SearchTask, VideoStream] | Processes[SearchTask, VideoStream]
    progress: Progress
    agreed: Mapping[str, Bound]
    plans: dict[str, Agreement] = field(default_factory=dict)
    waiting: dict[str, list[SearchTask]] = field(default_factory=dict)
    found: dict[Key, VideoStream] = field(default_factory=dict)
    tasks: dict[Key, SearchTask] = field(default_factory=dict)
    trials: dict[Key, list[Evaluation]] = field(default_factory=dict)

    def run(self) -> dict[Key, EncodedVideo]:
        for camera in sorted(cameras_of(self.clips), key=self._stored, reverse=True):
            self.plans[camera] = self._plan(camera)
            self._go_on(camera)
        for one in self.crew.results():
            self._finished(one)
            if all(task.clip.key in self.found for task in self.waiting[one.camera]):
                self._take(one.camera)
                self._go_on(one.camera)
        for task in self.tasks.values():  # it may be damaged, or was replaced in a call with other clips
            if not is_finished(task):
                del self.found[task.clip.key]
                self.crew.submit(task)
        for one in self.crew.results():
            self._finished(one)
        return {clip.key: self._video(clip.key) for clip in self.clips}

    def _stored(self, camera: str) -> int:
        """Return the bytes of a camera's clips: long searches should not be the last to end."""
        return sum(clip.recording.camera(camera).stored_bytes for clip in self.clips if clip.camera == camera)

    def _plan(self, camera: str) -> Agreement:
        clips = sorted((clip for clip in self.clips if clip.camera == camera), key=stored_per_frame, reverse=True)
        names, choices = [clip.name for clip in clips], self.settings.choices()
        if not self.settings.agrees:
            return Agreement(names, choices, apart=True)
        formats = self._formats({(c.width, c.height) for c in (clip.recording.camera(camera) for clip in clips)})
        return Agreement(names, replace(choices, pixel_formats=formats), self._bound(camera, formats))

    def _formats(self, sizes: Iterable[tuple[int, int]]) -> tuple[str, ...]:
        """Return the pixel formats that videos of several sizes (width, height) can share."""
        choices = self.settings.choices()
        fitting = [formats_for(choices.settings(), *size, choices.pixel_formats) for size in sizes]
        common = [name for name in fitting[0] if all(name in names for names in fitting)]
        # without a lossless format, only the best is sure to leave no episode behind
        return tuple(common if choices.settings().facts.lossless_format else common[:1])

    def _bound(self, camera: str, formats: Sequence[str]) -> Bound | None:
        """Return the agreement of a camera's other episodes; None without one, or where their pictures' size differs,
        so that its pixel format does not fit."""
        bound = self.agreed.get(camera)
        if bound is None or bound.crf == LOSSLESS or bound.pixel_format in formats:
            return bound
        return None

    def _go_on(self, camera: str) -> None:
        """Begin a camera's next step with work left; results of an earlier call are reused.

        A video that a later step replaced is not needed again, but its results are.
        """
        while step := self.plans[camera].next_step():
            clips = {clip.name: clip for clip in self.clips if clip.camera == camera}
            names, choices = step
            tasks = self.waiting[camera] = [self._task(clips[name], choices) for name in names]
            for task in tasks:
                self.found.pop(task.clip.key, None)
                if (one := known(task)) is not None:
                    self.found[task.clip.key] = one
                else:
                    self.crew.submit(task)
            if any(task.clip.key not in self.found for task in tasks):
                return
            self._take(camera)

    def _take(self, camera: str) -> None:
        """Note a finished step, in its order, and delete the videos that it replaces."""
        found = {task.clip.name: self.found[task.clip.key] for task in self.waiting[camera]}
        for task in self.waiting[camera]:
            key = task.clip.key
            self.trials[key] = self.trials.get(key, []) + self.found[key].evaluations
            if key in self.tasks:
                self.tasks[key].video.unlink(missing_ok=True)
            self.tasks[key] = task
        self.plans[camera].take(found)

    def _finished(self, one: VideoStream) -> None:
        """Record a video, and report how many are final so far."""
        self.found[one.episode, one.camera] = one
        found = list(self.found.values())
        staying = sum(plan.staying([s for s in found if s.camera == name]) for name, plan in self.plans.items())
        quality = "lossless" if one.crf is None else f"CRF {one.crf}"
        self.progress(f"{one.episode} {one.camera}, {quality}", max(0, staying - 1), len(self.clips))

    def _task(self, clip: Clip, choices: Choices) -> SearchTask:
        return SearchTask(
            clip=clip,
            choices=choices,
            criterion=self.settings.criterion(),
            display=self.settings.display,
            keyframes=self.settings.keyframes,
            folder=self.folder,
        )

    def _video(self, key: Key) -> EncodedVideo:
        stream = self.found[key].model_copy(update={"evaluations": self.trials[key]})
        return EncodedVideo(self.tasks[key].video, stream)
