"""Stage 7: judge finished episodes again, or any pair of pictures of a run's table (paper, section III-C)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vcage.base.errors import InputFileError, MissingStage, UnknownName
from vcage.base.files import RunFolder
from vcage.base.pictures import read_picture
from vcage.base.progress import Progress, silent
from vcage.schema.base import Provenance
from vcage.schema.episodes import Episode, Episodes, SingleVerdict, Verdict, Verdicts
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtasks
from vcage.stages.context import StageContext
from vcage.stages.episode_store import background_name
from vcage.stages.question import TOP, Asking, verdict
from vcage.stages.stage import Job, ModelOptions, StageResult, stage_seed

_NAMED = re.compile(r"-(before|after|moment|start)-(\w+)\.png$")
"""How collect names what a verdict looked at: when, and by which camera."""

Options = ModelOptions
"""The stage has no options of its own."""


def job(run: RunFolder, options: Options, context: StageContext) -> Job:
    """What the stage has to do."""
    return Job(
        run=run,
        output=run.verdicts,
        inputs=[run.layout, run.subtasks, run.episodes],
        seed=stage_seed(run, options.seed),
        providers=context.models.providers("critic"),
    )


def summary(record: Verdicts) -> dict[str, Any]:
    """A few facts for whoever ran the stage."""
    verified = sum(all(v.accepted for v in verdicts) for verdicts in record.episodes.values())
    return {"episodes": len(record.episodes), "verified": verified, "taken_over": record.taken_over}


def execute(
    run: RunFolder, options: Options, context: StageContext, progress: Progress = silent
) -> StageResult[Verdicts]:
    """Write ``verify/verdicts.json``: one verdict per sub-task of every accepted episode, from the pictures kept.

    What the same critic said of the same pictures while they were collected is taken over, unless ``force`` asks for it
    to look again.
    """
    stage = job(run, options, context)

    def make(_folder: Path, provenance: Provenance) -> Verdicts:
        collected = Episodes.read(run.episodes)
        now, then = provenance, collected.provenance
        same_critic = (now.version, now.providers["critic"]) == (then.version, then.providers.get("critic"))
        judge = _Judge(run, context, take_over=same_critic and not options.force)
        accepted = [e for e in collected.episodes if e.accepted]
        judged, known = {}, 0
        for number, episode in enumerate(accepted):
            progress(f"episode {episode.index}", number, len(accepted))
            verdicts = judge.episode(episode)
            judged[episode.file or f"episode {episode.index}"] = [verdict for verdict, _ in verdicts]
            known += sum(taken_over for _, taken_over in verdicts)
        return Verdicts(provenance=provenance, episodes=judged, taken_over=known)

    return stage.do(Verdicts, make, force=options.force)


class _Judge:
    """Judges the episodes of a run.

    Args:
        run: the run folder.
        context: with the critic.
        take_over: whether an earlier verdict stands where the question is the same.
    """

    def __init__(self, run: RunFolder, context: StageContext, *, take_over: bool):
        self._folder, self._context, self._take_over = run.episodes.parent, context, take_over
        self._scene = Scene.read(run.layout)
        self._subtasks = {s.id: s for s in Subtasks.read(run.subtasks).kept}

    def episode(self, episode: Episode) -> list[tuple[Verdict, bool]]:
        """A verdict for each sub-task, and whether it was taken over."""
        empty = read_picture(self._folder / background_name(episode.index))
        told = []
        for name, earlier in zip(episode.subtasks, episode.verdicts, strict=True):
            seen = _seen([self._folder / picture for picture in earlier.pictures], self._scene)
            subtask = self._subtasks[name]
            asking = Asking.of(subtask, seen, empty)
            known = self._take_over and earlier.question == asking.hash
            said = earlier if known else verdict(self._context, self._scene, asking)
            pictures = [f"../{self._folder.name}/{picture}" for picture in earlier.pictures]
            told.append((said.model_copy(update={"pictures": pictures}), known))
        return told


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
    subtask, scene = kept[subtask_id], Scene.read(run.layout)
    seen = _seen(_beside(after), scene)
    seen |= {when: seen.get(when, {}) | {TOP: _view(p, scene)} for when, p in (("before", before), ("after", after))}
    said = verdict(context, scene, Asking.of(subtask, seen, _empty_beside(before, scene)))
    pictures = [str(before), str(after)]
    return SingleVerdict(text=subtask.text, verdict=said.model_copy(update={"pictures": pictures}))


def _seen(pictures: Sequence[Path], scene: Scene) -> dict[str, dict[str, np.ndarray]]:
    """Pictures by what their names say that they show, and by camera."""
    found: dict[str, dict[str, np.ndarray]] = {}
    for path in pictures:
        when, camera = _NAMED.search(path.name).groups()  # pyrefly: ignore
        found.setdefault(when, {})[camera] = _view(path, scene) if camera == TOP else read_picture(path)
    return found


def _beside(picture: Path) -> list[Path]:
    """All pictures of the same attempt, where one lies as collect keeps it."""
    named = _NAMED.search(picture.name)
    return sorted(picture.parent.glob(f"{picture.name[: named.start()]}-*.png")) if named else []


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
