"""A second verdict on sub-tasks that were judged while collecting, from the stored pictures.

Attempt, moment and camera of a picture are read from its name.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vcage.base.errors import AnswerNeeded, InputFileError, UnknownName
from vcage.base.files import RunFolder
from vcage.base.pictures import read_picture
from vcage.base.progress import Progress
from vcage.episodes.question import TOP, Asking, verdict
from vcage.episodes.store import background_name
from vcage.episodes.worlds import other_phrases, reworded
from vcage.runs.context import StageContext
from vcage.schema.episodes import Episodes, SingleVerdict, Verdict
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask
from vcage.tasks.setting import Seen
from vcage.tasks.templates import read_subtasks


@dataclass(frozen=True)
class JudgedStep:
    """A sub-task that was judged while collecting.

    Args:
        episode: its number.
        subtask: id.
        earlier: the verdict, with its pictures relative to the folder of the episodes.
    """

    episode: int
    subtask: str
    earlier: Verdict

    @property
    def pictures(self) -> tuple[str, ...]:
        """Names that no other attempt's pictures have."""
        return tuple(self.earlier.pictures)


class SecondJudge:
    """Judges the attempts of a run again.

    Args:
        run: the run folder.
        context: with the critic.
        take_over: keep an earlier verdict if the question is the same.
    """

    def __init__(self, run: RunFolder, context: StageContext, *, take_over: bool):
        self._run, self._context, self._take_over = run, context, take_over
        self._scene = Scene.read(run.layout)
        self._episodes = {episode.index: episode for episode in Episodes.read(run.episodes).episodes}
        self._subtasks = {s.id: s for s in read_subtasks(run.subtasks).kept}
        self.taken_over = 0

    def subtask(self, step: JudgedStep) -> Subtask:
        """Return the sub-task of a step, in the words of its episode."""
        phrases = other_phrases(self._scene, self._episodes[step.episode].objects)
        return reworded(self._subtasks[step.subtask], phrases)

    def has_pictures(self, step: JudgedStep) -> bool:
        """True if all pictures of the verdict are stored."""
        pictures = (*step.pictures, background_name(step.episode))
        return bool(step.pictures) and all(self._picture(name).is_file() for name in pictures)

    def pictures(self, step: JudgedStep) -> Seen:
        """Return the pictures of the verdict."""
        return _by_moment([self._picture(name) for name in step.pictures], self._scene)

    def _picture(self, name: str) -> Path:
        """Return a picture by its path from the folder of the episodes."""
        return self._run.file(name, self._run.episodes.parent.name)

    def picture_paths(self, step: JudgedStep) -> list[str]:
        """Return paths of a step's pictures, relative to the folder of the verdicts."""
        return [f"../{self._run.episodes.parent.name}/{name}" for name in step.pictures]

    def judge_all(self, steps: Iterable[JudgedStep], progress: Progress) -> dict[tuple[str, ...], Verdict]:
        """Return a verdict on each step, by its pictures; a repeated step is judged once.

        Raises:
            AnswerNeeded: an agent is asked about some; holds all these questions.
        """
        by_pictures = {step.pictures: step for step in steps}
        said, asked = dict[tuple[str, ...], Verdict](), list[dict[str, Any]]()
        for number, (pictures, step) in enumerate(by_pictures.items()):
            progress(f"episode {step.episode}", number, len(by_pictures))
            try:
                said[pictures] = self.judge(step)
            except AnswerNeeded as error:
                asked += error.details["asked"]
        if asked:
            raise AnswerNeeded.all_of(asked)
        return said

    def judge(self, step: JudgedStep) -> Verdict:
        """Return a verdict on a step, or the earlier one if the question is the same."""
        empty = read_picture(self._picture(background_name(step.episode)))
        asking = Asking.of(self.subtask(step), self.pictures(step), empty)
        known = self._take_over and step.earlier.question == asking.hash
        self.taken_over += known
        scene = self._episodes[step.episode].scene(self._scene)
        said = step.earlier if known else verdict(self._context, scene, asking)
        return said.model_copy(update={"pictures": self.picture_paths(step)})


def judge_pair(run: RunFolder, context: StageContext, subtask_id: str, before: Path, after: Path) -> SingleVerdict:
    """Return a verdict about two pictures from the run's top camera.

    Example:
        >>> judge_pair(RunFolder("runs/blocks"), StageContext(), "block_red-onto-plate_white", before, after).verdict

    Raises:
        MissingStage: the run has no layout or sub-tasks yet, or a picture is missing.
        DamagedFile, InputFileError: a picture cannot be read, or is of another size than the camera's.
        UnknownName: the run has no such sub-task.
    """
    kept = {s.id: s for s in read_subtasks(run.subtasks).kept}
    if subtask_id not in kept:
        raise UnknownName("sub-task", subtask_id, kept)
    scene = _scene_of(before, run)
    subtask = reworded(kept[subtask_id], other_phrases(Scene.read(run.layout), scene.objects))
    seen = dict(_by_moment(_of_same_attempt(after), scene))
    seen |= {
        when: {**seen.get(when, {}), TOP: _top_view(p, scene)} for when, p in (("before", before), ("after", after))
    }
    said = verdict(context, scene, Asking.of(subtask, seen, _empty_table_of(before, scene)))
    pictures = [str(before), str(after)]
    return SingleVerdict(text=subtask.text, verdict=said.model_copy(update={"pictures": pictures}))


# --- stored pictures --------------------------------------------------------------------------------------


_NAMED = re.compile(r"-(before|after|moment|later|start)-(\w+)\.png$")
"""Names of the pictures of a verdict: moment and camera."""


def _by_moment(pictures: Sequence[Path], scene: Scene) -> Seen:
    """Read pictures by the moment and camera in their names.

    Raises:
        InputFileError: one cannot be read, has another kind of name, or has not the size of the top camera.
    """
    found: dict[str, dict[str, np.ndarray]] = {}
    for path in pictures:
        named = _NAMED.search(path.name)
        if named is None:
            raise InputFileError(
                f"{path} is not named as collect names the pictures of a verdict: field pictures",
                hint="restore the written file",
                maker="collect",
            )
        when, camera = named.groups()
        found.setdefault(when, {})[camera] = _top_view(path, scene) if camera == TOP else read_picture(path)
    return found


def _of_same_attempt(picture: Path) -> list[Path]:
    """Return all stored pictures of the attempt that ends with a picture; none if collect names no end of one so."""
    named = _NAMED.search(picture.name)
    ends = named is not None and named[1] == "after"
    return sorted(picture.parent.glob(f"{picture.name[: named.start()]}-*.png")) if named and ends else []


def _scene_of(picture: Path, run: RunFolder) -> Scene:
    """Return the scene of the episode in a picture's name (``e000002-s0-…``), else the scene of the run."""
    scene, named = Scene.read(run.layout), re.match(r"e(\d+)-", picture.name)
    if named is None or not run.episodes.exists():
        return scene
    return next((e.scene(scene) for e in Episodes.read(run.episodes).episodes if e.index == int(named[1])), scene)


def _empty_table_of(picture: Path, scene: Scene) -> np.ndarray | None:
    """Return the empty table in the light of a picture's episode; None if it is not stored."""
    episode = re.match(r"e(\d+)-", picture.name)
    empty = picture.parent.parent / background_name(int(episode[1])) if episode else picture
    return _top_view(empty, scene) if episode and empty.exists() else None


def _top_view(path: Path, scene: Scene) -> np.ndarray:
    """Read a picture of the scene's top camera: (H, W, 3) uint8 RGB."""
    picture, camera = read_picture(path), scene.top_camera
    height, width = picture.shape[:2]
    if (width, height) != (camera.width, camera.height):
        raise InputFileError(
            f"{path} is {width} x {height}, the run's top camera takes {camera.width} x {camera.height}",
            hint="give pictures as collect keeps them in episodes/critic",
        )
    return picture
