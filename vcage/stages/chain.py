"""The whole chain in one process: every stage with its share of the same options, on the files of the one before."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from typing import Any

from vcage.base.errors import StaleStage, UsageError
from vcage.base.files import RunFolder
from vcage.base.options import Flag
from vcage.base.progress import Progress, silent
from vcage.base.workers import preload_module
from vcage.runs.context import StageContext
from vcage.runs.running import Stage, at_work, timed
from vcage.runs.stage import StageOptions, StageResult
from vcage.runs.taken_crfs import crfs_of
from vcage.stages import collect, compress, export, inpaint_plan, match, optimize, search_subtasks, select_place, verify

logger = logging.getLogger(__name__)


STAGES: dict[str, Stage] = {
    "select_place": select_place,
    "inpaint_plan": inpaint_plan,
    "match": match,
    "optimize": optimize,
    "search_subtasks": search_subtasks,
    "collect": collect,
    "verify": verify,
    "compress": compress,
    "export": export,
}
"""The nine stages, in the order in which they run."""


@dataclass(frozen=True, kw_only=True)
class ChainOptions(
    select_place.Options,
    inpaint_plan.Options,
    match.Options,
    optimize.Options,
    collect.Options,
    verify.Options,
    compress.Options,
):
    """Options of every stage together except export, whose codec would have the name of the compression's.

    Example:
        >>> ChainOptions(instruction="Put the blocks on the plate", models="offline", episodes=10)
        >>> ChainOptions(goals=("marker inside packaging_box", "then rubber_eraser inside packaging_box"))
        >>> ChainOptions(template="office_desk", all_subtasks=True)
    """

    all_subtasks: Flag = False
    """build the scene of its template, without an instruction, and run every sub-task that it has, each by itself"""

    def require_possible(self) -> None:
        """Check that there is a task (an instruction or goals) or ``all_subtasks``, and that ranges exist.

        Raises:
            UsageError: there is neither, or both; says the way out.
            UnknownName, MissingStage, InputFileError: such ranges do not exist, or are impossible; or there is no
                compression in the run of ``crf_of``, or one with other options.
        """
        self.ranges()
        if self.crf_of is not None:
            crfs_of(self.crf_of, self.compression)
        has_task = self.instruction is not None or bool(self.goals)
        if not has_task and not self.all_subtasks:
            raise UsageError(
                "there is no instruction",
                hint='give one in quotes: "Put the blocks on the plate", or --scene office_desk --all-subtasks',
            )
        if has_task and self.all_subtasks:
            raise UsageError(
                "--all-subtasks runs every sub-task of a scene, so it takes no instruction and no goals",
                hint="leave out the instruction and --goal, or --all-subtasks",
            )


def run_chain(
    run: RunFolder,
    options: ChainOptions,
    context: StageContext | None = None,
    show: Callable[[str], AbstractContextManager[Progress]] = lambda _: contextlib.nullcontext(silent),
) -> dict[str, StageResult[Any]]:
    """Run all stages; finished ones are left alone.

    Example:
        >>> run_chain(RunFolder("runs/blocks"), ChainOptions(instruction="Put the blocks on the plate"))

    Args:
        run: the run folder.
        options: of all stages.
        context: shared by the stages; None to follow the options.
        show: entered with the name of each stage while it runs.

    Returns:
        Stage → its result, in order.

    Raises:
        UsageError: there is no instruction and not every sub-task is wanted, or both.
        FolderInUse: another process works on the run.
        VcageError: raised by a stage; those before it are finished.
    """
    options.require_possible()
    context = context or options.context(run)
    done = {}
    with at_work(run):
        if options.workers != 1 and not run.compression.exists():  # else no process may be begun
            preload_module(__name__, "vcage.episodes.preload")
        for name, stage in STAGES.items():
            with show(name) as progress:
                own = export.Options(seed=options.seed, force=options.force) if name == "export" else options
                done[name] = up_to_date(name, stage, run, own, context, progress)
    return done


def up_to_date(
    name: str,
    stage: Stage,
    run: RunFolder,
    options: StageOptions,
    context: StageContext,
    progress: Progress,
) -> StageResult[Any]:
    """Run a stage, and make it again where it was made from other files than there are now.

    Episodes and edited files are never lost that way, only by --force of the stage itself.

    Args:
        name: of the stage.
        stage: its module.
        run: the run folder, which this process holds.
        options: the stage's.
        context: shared by the stages.
        progress: called at every step.

    Raises:
        StaleStage: it was made with other options, or to make it again would lose episodes or edits.
        VcageError: raised by the stage.
    """
    try:
        return timed(stage, run, options, context, progress)
    except StaleStage as error:
        changed = error.details.get("changed", ())
        if not changed or not all(what.startswith("input ") for what in changed):
            raise
        if name == "collect" or error.details.get("edited"):
            error.maker = name
            error.hint = "make it again by itself, as --force of the whole run loses what was edited"
            raise
        logger.info("%s: made again, from another %s", name, ", ".join(changed))
        return timed(stage, run, replace(options, force=True), context, progress)
