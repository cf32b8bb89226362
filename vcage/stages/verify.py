"""Stage 7: judge what was collected again, or any pair of pictures of a run's table (paper, section III-C)."""

from __future__ import annotations

import logging
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vcage.base.errors import AnswerNeeded, InputFileError, MissingStage, StaleStage, UnknownName
from vcage.base.files import RunFolder
from vcage.base.options import Flag
from vcage.base.pictures import read_picture, write_picture
from vcage.base.progress import Progress, silent
from vcage.schema.base import Provenance
from vcage.schema.episodes import BY_HAND, Attempt, Difference, Episode, Episodes, SingleVerdict, Verdict, Verdicts
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask, Subtasks
from vcage.stages.accepted import judged_steps
from vcage.stages.context import StageContext
from vcage.stages.differences import draw_difference
from vcage.stages.edits import by_hand, require_evidence, require_only, written_record
from vcage.stages.episode_store import background_name, confusion, log_path, read_log
from vcage.stages.question import TOP, Asking, verdict
from vcage.stages.stage import Job, ModelOptions, StageResult, stage_seed
from vcage.stages.worlds import other_phrases, reworded
from vcage.tasks.setting import Seen

logger = logging.getLogger(__name__)

_NAMED = re.compile(r"-(before|after|moment|start)-(\w+)\.png$")
"""How collect names what a verdict looked at: when, and by which camera."""

DECIDED = tuple(("episodes", "*", "*", said) for said in ("accepted", "reason", "confidence"))
"""What a hand may say of verdicts; all else was seen, or counted."""


@dataclass(frozen=True, kw_only=True)
class Options(ModelOptions):
    """Who judges, and what."""

    refused: Flag = False
    """judge the attempts that were not accepted, too, of which pictures are kept: to compare two critics"""


def job(run: RunFolder, options: Options, context: StageContext) -> Job:
    """What the stage has to do."""
    return Job(
        run=run,
        output=run.verdicts,
        inputs=[run.layout, run.subtasks, run.episodes, log_path(run.episodes.parent)],
        seed=stage_seed(run, options.seed),
        options={"refused": True} if options.refused else {},
        providers=context.models.providers("critic"),
    )


def summary(record: Verdicts) -> dict[str, Any]:
    """A few facts for whoever ran the stage."""
    return {
        "episodes": len(record.episodes),
        "verified": len(record.episodes) - len(record.refused),
        "refused": record.refused,
        "taken_over": record.taken_over,
        "critic": record.critic.model_dump(mode="json"),
        "earlier_critic": record.earlier_critic.model_dump(mode="json"),
        "not_kept": record.not_kept,
        "differ": len(record.differences),
    }


def execute(
    run: RunFolder, options: Options, context: StageContext, progress: Progress = silent
) -> StageResult[Verdicts]:
    """Write ``verify/verdicts.json``: a verdict on every sub-task of the accepted episodes, and both critics counted.

    With ``refused`` also on every other attempt of which pictures and truth are kept; else these are not asked about.
    What the same critic said of the same pictures while they were collected is taken over, unless ``force`` asks for it
    to look again; and what was decided by hand stays decided where there are other episodes by now. Where the two
    critics differ, a picture in ``verify/differences`` shows what they looked at.
    """
    stage = job(run, options, context)
    earlier = None if options.force else _of_other_episodes(stage)

    def make(folder: Path, provenance: Provenance) -> Verdicts:
        then = Episodes.read(run.episodes).provenance
        same_critic = (provenance.version, provenance.providers["critic"]) == (
            then.version,
            then.providers.get("critic"),
        )
        judge = _Judge(run, context, take_over=same_critic and not options.force)
        return _decided(earlier, _judged(run, judge, folder, provenance, progress, refused=options.refused))

    return stage.do(Verdicts, make, force=options.force or earlier is not None)


def _of_other_episodes(stage: Job) -> Verdicts | None:
    """Earlier verdicts that nothing is wrong with but that there are other episodes by now, more or fewer."""
    try:
        stage.finished(Verdicts, force=False)
    except StaleStage as error:
        run = stage.run
        grown = {f"input {run.relative(path)}" for path in (run.episodes, log_path(run.episodes.parent))}
        if {*error.details["changed"]} <= grown:
            return Verdicts.read(run.verdicts)
        raise
    return None


def _decided(earlier: Verdicts | None, record: Verdicts) -> Verdicts:
    """Verdicts with what was decided by hand of the same episodes before."""
    if earlier is None:
        return record
    known = {v.question: v for said in earlier.episodes.values() for v in said if v.provider == BY_HAND}
    episodes = {name: [known.get(v.question, v) for v in said] for name, said in record.episodes.items()}
    return record.model_copy(update={"episodes": episodes, "edited": earlier.edited})


def take_over(run: RunFolder, folder: Path, edited: Collection[str], context: StageContext) -> Verdicts:
    """The verdicts as they were edited by hand.

    Raises:
        InputFileError: something was changed that is no decision.
    """
    require_evidence(run.verdicts, edited)
    record, was = Verdicts.read(run.verdicts), written_record(run.verdicts, Verdicts)
    require_only(run.verdicts, *DECIDED)
    episodes = {
        name: [by_hand(*pair) for pair in zip(was.episodes[name], said, strict=True)]
        for name, said in record.episodes.items()
    }
    return record.model_copy(update={"episodes": episodes})


def _named(episode: Episode) -> str:
    """What the verdicts call an episode."""
    return episode.file or f"episode {episode.index}"


def _judged(
    run: RunFolder, judge: _Judge, folder: Path, provenance: Provenance, progress: Progress, *, refused: bool
) -> Verdicts:
    """Judge every sub-task of the accepted episodes, without whose pictures there is an error; with ``refused`` also
    every other attempt that can be judged."""
    collected = Episodes.read(run.episodes)
    accepted = [episode for episode in collected.episodes if episode.accepted]
    steps = [_Question(e.index, *step) for e in accepted for step in judged_steps(run, e)]
    verified = {question.pictures for question in steps}
    judged = [(a, _Question(a.episode, a.subtask, a.verdict)) for a in read_log(run.episodes.parent) if a.verdict]
    tried = [(attempt, question) for attempt, question in judged if refused or question.pictures in verified]
    kept = [(attempt, question) for attempt, question in tried if attempt.truth and judge.sees(question)]
    if tried and not kept:
        logger.warning(
            "verify: of none of %d judged attempts are pictures and truth kept: nothing to count", len(tried)
        )
    questions = {q.pictures: q for q in [*steps, *(question for _, question in kept)]}  # a verified step is both
    said: dict[tuple[str, ...], Verdict] = {}
    asked: list[dict[str, Any]] = []
    for number, (pictures, question) in enumerate(questions.items()):
        progress(f"episode {question.episode}", number, len(questions))
        try:
            said[pictures] = judge.again(question)
        except AnswerNeeded as error:  # all are asked at once
            asked += error.details["asked"]
    if asked:
        raise AnswerNeeded.all_of(asked)
    again = [attempt.model_copy(update={"verdict": said[question.pictures]}) for attempt, question in kept]
    return Verdicts(
        provenance=provenance,
        accept=collected.accept,
        episodes={_named(e): [said[tuple(v.pictures)] for v in e.verdicts] for e in accepted},
        taken_over=judge.taken_over,
        critic=confusion(again),
        earlier_critic=confusion([attempt for attempt, _ in kept]),
        not_kept=len(tried) - len(kept),
        differences=[
            _difference(judge, question, attempt, folder)
            for attempt, (_, question) in zip(again, kept, strict=True)
            if attempt.verdict.accepted != question.earlier.accepted  # pyrefly: ignore
        ],
    )


def _difference(judge: _Judge, question: _Question, attempt: Attempt, folder: Path) -> Difference:
    """Record where the verdict on an attempt is not the earlier one, and draw it."""
    found = Difference(
        episode=attempt.episode,
        step=attempt.step,
        attempt=attempt.attempt,
        subtask=attempt.subtask,
        text=judge.subtask(question).text,
        earlier_verdict=question.earlier.model_copy(update={"pictures": judge.from_verify(question)}),
        verdict=attempt.verdict,  # pyrefly: ignore
        truth=attempt.truth,  # pyrefly: ignore
        picture=f"differences/e{attempt.episode:06d}-s{attempt.step}-a{attempt.attempt}.png",
    )
    write_picture(folder / found.picture, draw_difference(found, judge.seen(question)))
    return found


@dataclass(frozen=True)
class _Question:
    """A sub-task that was judged while it was collected.

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


class _Judge:
    """Judges again what a run collected.

    Args:
        run: the run folder.
        context: with the critic.
        take_over: whether an earlier verdict stands where the question is the same.
    """

    def __init__(self, run: RunFolder, context: StageContext, *, take_over: bool):
        self._run, self._context, self._take_over = run, context, take_over
        self._scene = Scene.read(run.layout)
        self._episodes = {episode.index: episode for episode in Episodes.read(run.episodes).episodes}
        self._subtasks = {s.id: s for s in Subtasks.read(run.subtasks).kept}
        self.taken_over = 0

    def subtask(self, question: _Question) -> Subtask:
        """What was to be done, in the words of its episode."""
        phrases = other_phrases(self._scene, self._episodes[question.episode].objects)
        return reworded(self._subtasks[question.subtask], phrases)

    def sees(self, question: _Question) -> bool:
        """Whether all that was looked at is kept."""
        pictures = (*question.pictures, background_name(question.episode))
        return bool(question.pictures) and all(self._picture(name).is_file() for name in pictures)

    def seen(self, question: _Question) -> Seen:
        """The pictures that were looked at."""
        return _seen([self._picture(name) for name in question.pictures], self._scene)

    def _picture(self, name: str) -> Path:
        """A picture by its path from the folder of the episodes."""
        return self._run.file(name, self._run.episodes.parent.name)

    def from_verify(self, question: _Question) -> list[str]:
        """Their paths, relative to the folder of the verdicts."""
        return [f"../{self._run.episodes.parent.name}/{name}" for name in question.pictures]

    def again(self, question: _Question) -> Verdict:
        """A verdict on it, or the earlier one where that stands."""
        empty = read_picture(self._picture(background_name(question.episode)))
        asking = Asking.of(self.subtask(question), self.seen(question), empty)
        known = self._take_over and question.earlier.question == asking.hash
        self.taken_over += known
        scene = self._episodes[question.episode].scene(self._scene)
        said = question.earlier if known else verdict(self._context, scene, asking)
        return said.model_copy(update={"pictures": self.from_verify(question)})


def judge_pair(run: RunFolder, context: StageContext, subtask_id: str, before: Path, after: Path) -> SingleVerdict:
    """A verdict about two pictures from the run's top camera.

    Example:
        >>> judge_pair(RunFolder("runs/blocks"), StageContext(), "block_red-onto-plate_white", before, after).verdict

    Raises:
        MissingStage: the run has no layout or sub-tasks yet, or a picture is missing.
        DamagedFile, InputFileError: a picture cannot be read, or is of another size than the camera's.
        UnknownName: the run has no such sub-task.
    """
    for path, stage in ((run.layout, "optimize"), (run.subtasks, "search_subtasks")):
        if not path.exists():
            raise MissingStage(f"verify needs {path}, which does not exist", hint=f"run {stage} first")
    kept = {s.id: s for s in Subtasks.read(run.subtasks).kept}
    if subtask_id not in kept:
        raise UnknownName("sub-task", subtask_id, kept)
    scene = _scene_of(before, run)
    subtask = reworded(kept[subtask_id], other_phrases(Scene.read(run.layout), scene.objects))
    seen = _seen(_beside(after), scene)
    seen |= {when: seen.get(when, {}) | {TOP: _view(p, scene)} for when, p in (("before", before), ("after", after))}
    said = verdict(context, scene, Asking.of(subtask, seen, _empty_beside(before, scene)))
    pictures = [str(before), str(after)]
    return SingleVerdict(text=subtask.text, verdict=said.model_copy(update={"pictures": pictures}))


def _seen(pictures: Sequence[Path], scene: Scene) -> dict[str, dict[str, np.ndarray]]:
    """Pictures by what their names say that they show, and by camera."""
    found: dict[str, dict[str, np.ndarray]] = {}
    for path in pictures:
        named = _NAMED.search(path.name)
        if named is None:
            raise InputFileError(
                f"{path} is not named as collect names the pictures of a verdict: field pictures",
                hint="put back what was written",
                maker="collect",
            )
        when, camera = named.groups()
        found.setdefault(when, {})[camera] = _view(path, scene) if camera == TOP else read_picture(path)
    return found


def _beside(picture: Path) -> list[Path]:
    """All pictures of the same attempt, where one lies as collect keeps it."""
    named = _NAMED.search(picture.name)
    return sorted(picture.parent.glob(f"{picture.name[: named.start()]}-*.png")) if named else []


def _scene_of(picture: Path, run: RunFolder) -> Scene:
    """Where things stood in the episode of a picture that lies as collect keeps it (``e000002-s0-…``), or the run's."""
    scene, named = Scene.read(run.layout), re.match(r"e(\d+)-", picture.name)
    if named is None or not run.episodes.exists():
        return scene
    return next((e.scene(scene) for e in Episodes.read(run.episodes).episodes if e.index == int(named[1])), scene)


def _empty_beside(picture: Path, scene: Scene) -> np.ndarray | None:
    """The empty table in the same light, where the picture lies as collect keeps it (``e000002-s0-…``)."""
    episode = re.match(r"e(\d+)-", picture.name)
    empty = picture.parent.parent / background_name(int(episode[1])) if episode else picture
    return _view(empty, scene) if episode and empty.exists() else None


def _view(path: Path, scene: Scene) -> np.ndarray:
    """A picture of the scene's top camera: (H, W, 3) uint8 RGB."""
    picture, camera = read_picture(path), scene.top_camera
    height, width = picture.shape[:2]
    if (width, height) != (camera.width, camera.height):
        raise InputFileError(
            f"{path} is {width} x {height}, the run's top camera takes {camera.width} x {camera.height}",
            hint="give pictures as collect keeps them in episodes/critic",
        )
    return picture
