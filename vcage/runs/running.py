"""Run a stage: hold the run folder, check edits, execute, and record the time it took."""

from __future__ import annotations

import contextlib
import importlib
import logging
import shutil
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Protocol, cast

from vcage.base.errors import FolderInUse, MissingStage
from vcage.base.files import OWN, PRODUCERS, RunFolder, atomic_folder, cache_path, link_or_copy
from vcage.base.hold import held
from vcage.base.leftovers import recover, sweep_cache, sweep_folder
from vcage.base.progress import Progress, silent
from vcage.runs.by_products import interrupted, note_seconds, noting_progress, unfinished
from vcage.runs.context import StageContext
from vcage.runs.edits import Editable, edited_scripts, edits, seal
from vcage.runs.stage import Job, StageOptions, StageResult

logger = logging.getLogger(__name__)

SWEPT = OWN | {"episodes.collecting", "compress.working"}
"""Folders of a run, and files without their suffix, in which calls write."""


class Stage(Protocol):
    """The names that the module of a stage offers."""

    __name__: str

    @property
    def Options(self) -> type[Any]: ...

    def job(self, run: RunFolder, options: Any, context: StageContext, /) -> Job:
        """Return the work of the stage: its inputs, its output, and the options that change it."""
        ...

    def execute(self, run: RunFolder, options: Any, context: StageContext, progress: Progress, /) -> StageResult[Any]:
        """Do the work, unless it is done."""
        ...

    def summary(self, record: Any, /) -> dict[str, Any]:
        """Return a few facts for the caller."""
        ...

    EDITABLE: Editable[Any]
    """The part of its files that a person may edit."""


def stage_of(name: str) -> Stage:
    """Import the module of one stage: all nine would double the time that a command takes to start."""
    return cast(Stage, importlib.import_module(f"vcage.stages.{name}"))


def run_stage(
    stage: Stage,
    run: RunFolder,
    options: StageOptions | None = None,
    context: StageContext | None = None,
    progress: Progress = silent,
) -> StageResult[Any]:
    """Run one stage, unless it is finished, and note how long it took.

    Example:
        >>> from vcage.stages import match
        >>> run_stage(match, RunFolder("runs/blocks"), match.Options(threshold=0.7, force=True))

    Args:
        stage: a module of :mod:`vcage.stages`.
        run: the run folder, with the output of earlier stages.
        options: the stage's ``Options``; None for the defaults.
        context: shared by stages; None to follow the options.
        progress: called at every step.

    Raises:
        FolderInUse: another process works on the run.
        StageInterrupted: a stage that comes before it was interrupted.
        VcageError: raised by the stage.
    """
    options = options or stage.Options()
    with at_work(run):
        try:
            return timed(stage, run, options, context or options.context(run), progress)
        except MissingStage as error:
            begun = interrupted(run, error.maker)
            if begun is None:
                raise
            raise begun from error


def timed(
    stage: Stage, run: RunFolder, options: StageOptions, context: StageContext, progress: Progress
) -> StageResult[Any]:
    """Execute a stage, and note its duration if there was work to do.

    Args:
        stage: a module of :mod:`vcage.stages`.
        run: the run folder, which this process holds.
        options: the stage's.
        context: what stages share.
        progress: called at every step.

    Raises:
        VcageError: raised by the stage.
    """
    accept_edits(stage.job(run, options, context), context, force=options.force)
    start, name = time.perf_counter(), stage.__name__.rpartition(".")[2]
    with noting_progress(run, name, progress) as show:
        done = stage.execute(run, options, context, show)
    if done.fresh:
        note_seconds(run, name, time.perf_counter() - start, grown=done.grown)
    return done


def accept_edits(job: Job, context: StageContext, *, force: bool) -> None:
    """Check edits of all inputs and of the output of a stage; from then on they count as written.

    Args:
        job: of the stage.
        context: what stages share.
        force: the stage will make its own files again, whatever they are.

    Raises:
        InputFileError: an edit is impossible: names the file, the field, and the expected value.
    """
    recover(job.output.parent)
    for path in job.run.documents:
        if path == job.output and force:
            _warn_of_loss(job)
        elif path.is_file() and (path == job.output or path in job.inputs):
            _accept_edits_of(path, job.run, context)


def _warn_of_loss(job: Job) -> None:
    """Name the edits that a repeated stage replaces."""
    if job.output.is_file() and (gone := [*edits(job.output), *edited_scripts(job.output)]):
        logger.warning("%s: files edited by hand are made again: %s", job.stage, ", ".join(gone))


def _accept_edits_of(path: Path, run: RunFolder, context: StageContext) -> None:
    files = edits(path)
    if not files:
        return
    stage = PRODUCERS[path.parent.name]
    logger.warning("%s of %s was edited by hand: checking it", ", ".join(files), stage)
    with atomic_folder(path.parent) as folder:
        shutil.copytree(path.parent, folder, copy_function=link_or_copy, dirs_exist_ok=True)
        record = stage_of(stage).EDITABLE.accepted(run, path, files, folder, context)
        seal(record, folder / path.name, edited_scripts(path))


@contextlib.contextmanager
def at_work(run: RunFolder) -> Iterator[None]:
    """Hold the run folder for this process while it works there; remove a new folder that stays empty.

    Raises:
        FolderInUse: another process works there; names it, and how far it is.
        OutputFolderError: the folder cannot be written.
        InputFileError: something in it is a link.
    """
    run.require_no_links()
    begun = run.root.exists()
    run.make()
    try:
        with held(run.root):
            sweep_folder(run.root, SWEPT)
            sweep_cache(cache_path())
            yield
    except FolderInUse as error:
        error.details["done_so_far"] = {name: note.model_dump() for name, note in unfinished(run).items()}
        raise
    finally:
        if not begun:
            with contextlib.suppress(OSError):  # not empty: something came to be
                run.root.rmdir()
