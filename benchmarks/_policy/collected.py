"""Runs for the policy benchmark: the project's own stages on one instruction, and an export without videos."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from benchmarks._policy.demonstrations import Demonstrations
from benchmarks._policy.policy import Meaning
from vcage.base.errors import TooFewVerified, UsageError
from vcage.base.files import RunFolder
from vcage.base.progress import Progress
from vcage.runs.accepted import accepted_episodes
from vcage.runs.context import StageContext
from vcage.runs.running import at_work
from vcage.schema.subtasks import Subtasks
from vcage.stages import compress, export
from vcage.stages.chain import STAGES, ChainOptions, up_to_date

logger = logging.getLogger(__name__)

FORMAT = "lerobot-v3.0"

Layout = Literal["varied", "fixed"]

PLANNING = ("select_place", "inpaint_plan", "match", "optimize", "search_subtasks")
"""The stages up to the sub-tasks."""

COLLECTING = ("collect", "verify")
"""The stages up to the verdicts: states are exported without compression."""


@dataclass(frozen=True)
class Task:
    """The content of the episodes.

    Args:
        instruction: in plain language.
        robot: name of the robot.
        data: folder with the runs, which a second benchmark reuses.
        workers: processes that collect, compress and evaluate.
    """

    instruction: str
    robot: str
    data: Path
    workers: int

    def planned(self, episodes: int, layout: Layout) -> tuple[RunFolder, ChainOptions]:
        """A run with sub-tasks, and its options."""
        run = RunFolder(self.data / layout)
        options = ChainOptions(
            instruction=self.instruction,
            robot=self.robot,
            episodes=episodes,
            layout=layout,
            models="offline",
            workers=self.workers,
        )
        with at_work(run):
            _done(PLANNING, run, options)
        return run, options

    def collected(self, episodes: int, layout: Layout) -> RunFolder:
        """The run with that many episodes, and its export of states; what exists is not made again.

        Raises:
            TooFewVerified: fewer episodes are accepted.
        """
        run, options = self.planned(episodes, layout)
        with at_work(run):
            _done(COLLECTING, run, options)
            if (found := len(accepted_episodes(run))) < episodes:
                raise TooFewVerified(f"{run.root} has {found} episodes, {episodes} are wanted")
            asked = export.Options(formats=(FORMAT,), no_videos=True, environment_state=True)
            up_to_date("export", export, run, asked, options.context(run), _said(f"{layout}: export"))
        return run

    def compressed(self, run: RunFolder) -> None:
        """Compress the videos of a run, and keep the raw pictures."""
        options = compress.Options(keep_raw=True, workers=self.workers)
        with at_work(run):
            up_to_date("compress", compress, run, options, StageContext("offline"), _said("compress"))


def exported(run: RunFolder) -> Path:
    """Folder of the exported data set."""
    return run.export.parent / FORMAT


def meaning_of(run: RunFolder, demonstrations: Demonstrations, robot: str, turned: bool) -> Meaning:
    """Meaning of the numbers of a run's demonstrations.

    A sub-task is about what it moves, opens or presses, what it puts something on, and what the hand takes for it.

    Raises:
        UsageError: these are none of the objects of the demonstrations.
    """
    read = Subtasks.read(run.subtasks)
    kept = {subtask.id: subtask for subtask in read.kept}
    steps = []
    for subtask in (kept[name] for name in read.chains[0].subtasks):
        named = dict.fromkeys([subtask.object, subtask.receptacle, subtask.grasped])
        steps.append(tuple(name for name in named if name and f"{name}.x" in demonstrations.object_names))
    if not all(steps):
        raise UsageError(f"a sub-task of {run.root} is about no object", hint="give another --instruction")
    return Meaning(robot, demonstrations.names, demonstrations.object_names, tuple(steps), turned)


def _done(stages: Sequence[str], run: RunFolder, options: ChainOptions) -> None:
    """Run the stages that are not finished."""
    context = options.context(run)
    for name in stages:
        up_to_date(name, STAGES[name], run, options, context, _said(f"{run.root.name}: {name}"))


def _said(what: str) -> Progress:
    """Progress as lines of the log."""
    return lambda step, number, total: logger.info("%s: %d of %d, %s", what, number, total, step)
