"""A second verdict on sub-tasks that were judged while collecting, from the stored pictures."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vcage.base.errors import AnswerNeeded
from vcage.base.files import RunFolder
from vcage.base.pictures import read_picture
from vcage.base.progress import Progress
from vcage.episodes.question import Asking, verdict
from vcage.episodes.store import background_name
from vcage.episodes.stored_pictures import by_moment
from vcage.episodes.worlds import other_phrases, reworded
from vcage.runs.context import StageContext
from vcage.schema.episodes import Episodes, Verdict
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask, Subtasks
from vcage.tasks.setting import Seen


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
    """Judges again what a run collected.

    Args:
        run: the run folder.
        context: with the critic.
        take_over: keep an earlier verdict if the question is the same.
    """

    def __init__(self, run: RunFolder, context: StageContext, *, take_over: bool):
        self._run, self._context, self._take_over = run, context, take_over
        self._scene = Scene.read(run.layout)
        self._episodes = {episode.index: episode for episode in Episodes.read(run.episodes).episodes}
        self._subtasks = {s.id: s for s in Subtasks.read(run.subtasks).kept}
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
        return by_moment([self._picture(name) for name in step.pictures], self._scene)

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
