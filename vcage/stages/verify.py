"""Stage 7: judge finished episodes again, or any pair of pictures of a run's table (paper, section III-C)."""

from __future__ import annotations

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
from vcage.schema.subtasks import Subtask, Subtasks
from vcage.stages.context import StageContext
from vcage.stages.episode_store import background_name
from vcage.stages.stage import Job, ModelOptions, StageResult, stage_seed

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
    return {"episodes": len(record.episodes), "verified": verified}


def execute(
    run: RunFolder, options: Options, context: StageContext, progress: Progress = silent
) -> StageResult[Verdicts]:
    """Write ``verify/verdicts.json``: one verdict per sub-task of every accepted episode, from the pictures kept."""
    stage = job(run, options, context)

    def make(_folder: Path, provenance: Provenance) -> Verdicts:
        scene = Scene.read(run.layout)
        subtasks = {s.id: s for s in Subtasks.read(run.subtasks).kept}
        accepted = [e for e in Episodes.read(run.episodes).episodes if e.accepted]
        judged = {}
        for number, episode in enumerate(accepted):
            progress(f"episode {episode.index}", number, len(accepted))
            judged[episode.file or f"episode {episode.index}"] = _judge_episode(run, scene, context, episode, subtasks)
        return Verdicts(provenance=provenance, episodes=judged)

    return stage.do(Verdicts, make, force=options.force)


def _judge_episode(
    run: RunFolder, scene: Scene, context: StageContext, episode: Episode, subtasks: dict[str, Subtask]
) -> list[Verdict]:
    verdicts = []
    for name, earlier in zip(episode.subtasks, episode.verdicts, strict=True):
        before, after = (run.episodes.parent / picture for picture in earlier.pictures[:2])
        empty = read_picture(run.episodes.parent / background_name(episode.index))
        verdict = _judge(scene, context, subtasks[name], before, after, empty)
        pictures = [f"../{run.episodes.parent.name}/{picture}" for picture in earlier.pictures]
        verdicts.append(verdict.model_copy(update={"pictures": pictures}))
    return verdicts


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
    subtask = kept[subtask_id]
    verdict = _judge(Scene.read(run.layout), context, subtask, before, after)
    pictures = [str(before), str(after)]
    return SingleVerdict(text=subtask.text, verdict=verdict.model_copy(update={"pictures": pictures}))


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


def _judge(
    scene: Scene,
    context: StageContext,
    subtask: Subtask,
    before: Path,
    after: Path,
    background: np.ndarray | None = None,
) -> Verdict:
    views = (_view(path, scene) for path in (before, after))
    return context.models.critic.judge(
        context.critic_question(scene, subtask.text, subtask.goals, *views, background=background)
    )
