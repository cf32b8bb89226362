"""Around a call of a stage: the run folder is one process's at a time, and how long stages took is kept."""

from __future__ import annotations

import contextlib
import importlib
import logging
import os
import shutil
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Protocol, cast

from vcage.base.commands import CALLED, goes_on_with
from vcage.base.errors import AnswerNeeded, DamagedFile, FolderInUse, MissingStage, StageInterrupted, VcageError
from vcage.base.files import OWN, RunFolder, atomic_folder, read_json, write_json
from vcage.base.hold import held
from vcage.base.leftovers import sweep_cache, sweep_folder
from vcage.base.partial import recover
from vcage.base.progress import Progress, silent
from vcage.runs.context import StageContext
from vcage.runs.edits import edited_scripts, edits, require_same, seal, written_record
from vcage.runs.stage import PRODUCERS, Job, StageOptions, StageResult
from vcage.schema.base import StageDocument

logger = logging.getLogger(__name__)

SWEPT = OWN | {"episodes.collecting", "compress.working"}
"""Folders of a run, and files without their suffix, in which calls write."""


class Stage(Protocol):
    """What a module of a stage offers."""

    __name__: str

    @property
    def Options(self) -> type[Any]: ...

    def job(self, run: RunFolder, options: Any, context: StageContext, /) -> Job:
        """What the stage has to do."""
        ...

    def execute(self, run: RunFolder, options: Any, context: StageContext, progress: Progress, /) -> StageResult[Any]:
        """Do it, unless it is done."""
        ...

    def summary(self, record: Any, /) -> dict[str, Any]:
        """A few facts for whoever ran the stage."""
        ...

    def take_over(self, run: RunFolder, folder: Path, edited: list[str], context: StageContext, /) -> StageDocument:
        """The record of a folder in which files were edited by hand, checked, with what follows from it made again in
        ``folder``, a copy."""
        ...


def stage_of(name: str) -> Stage:
    """The module of a stage, alone: the others would double the time that its command takes to start."""
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
        run: the run folder, with what the stages before it wrote.
        options: the stage's ``Options``; None for the defaults.
        context: what stages share; None for what the options choose.
        progress: told of every step.

    Raises:
        FolderInUse: another process works on the run.
        StageInterrupted: a stage that comes before it was interrupted.
        VcageError: what the stage raises.
    """
    options = options or stage.Options()
    with at_work(run):
        try:
            return timed(stage, run, options, context or options.context(run), progress)
        except MissingStage as error:
            note = unfinished(run).get(error.maker)
            if note is None:
                raise
            raise _interrupted(run, error.maker, note) from error


def timed(
    stage: Stage, run: RunFolder, options: StageOptions, context: StageContext, progress: Progress
) -> StageResult[Any]:
    """Execute a stage, and note how long it took if it had something to do.

    Args:
        stage: a module of :mod:`vcage.stages`.
        run: the run folder, which this process holds.
        options: the stage's.
        context: what stages share.
        progress: told of every step.

    Raises:
        VcageError: what the stage raises.
    """
    take_over_edits(stage.job(run, options, context), context, force=options.force)
    start, name = time.perf_counter(), stage.__name__.rpartition(".")[2]
    with _noted(run, name, progress) as told:
        done = stage.execute(run, options, context, told)
    if done.fresh:
        note_seconds(run, name, time.perf_counter() - start, grown=done.grown)
    return done


def take_over_edits(job: Job, context: StageContext, *, force: bool) -> None:
    """Check what was edited by hand of all that a stage reads, and of what it wrote; from then on it counts as written.

    Args:
        job: of the stage.
        context: what stages share.
        force: the stage will make its own files again, whatever they are.

    Raises:
        InputFileError: what was edited is not possible: names the file, the field, and what was expected.
    """
    recover(job.output.parent)
    for path in job.run.documents:
        own = path == job.output
        if not (path.is_file() and (own or path in job.inputs)):
            continue
        changed, scripts = edits(path), edited_scripts(path)
        if own and force and (changed or scripts):
            logger.warning("%s: what was edited by hand is made again: %s", job.stage, ", ".join([*changed, *scripts]))
        if not changed or (own and force):
            continue
        stage = PRODUCERS[path.parent.name]
        logger.warning("%s of %s was edited by hand: checking it", ", ".join(changed), stage)
        with atomic_folder(path.parent) as folder:
            shutil.copytree(path.parent, folder, copy_function=_link, dirs_exist_ok=True)
            require_same(path, "provenance")
            record = stage_of(stage).take_over(job.run, folder, changed, context)
            edited = sorted({*written_record(path, type(record)).edited, *changed})
            seal(record.model_copy(update={"edited": edited}), folder / path.name, by_hand=scripts)


def _link(source: str, target: str) -> None:
    """A second name for a file, of which nothing is written over; a copy where the file system has none."""
    try:
        os.link(source, target)
    except OSError:
        shutil.copy2(source, target)


@contextlib.contextmanager
def at_work(run: RunFolder) -> Iterator[None]:
    """Keep the run folder for this process while it works there; a folder in which nothing came to be goes again.

    Raises:
        FolderInUse: another process works there; says which, and how far it is.
        OutputFolderError: the folder cannot be written.
        InputFileError: something in it is a link.
    """
    run.require_no_links()
    begun = run.root.exists()
    run.make()
    try:
        with held(run.root):
            sweep_folder(run.root, SWEPT)
            sweep_cache()
            yield
    except FolderInUse as error:
        error.details["done_so_far"] = unfinished(run)
        raise
    finally:
        if not begun:
            with contextlib.suppress(OSError):  # not empty: something came to be
                run.root.rmdir()


@contextlib.contextmanager
def _noted(run: RunFolder, stage: str, progress: Progress) -> Iterator[Progress]:
    """Keep in ``unfinished.json``, by stage, which command makes it and how far it is, until it is made.

    What is left there was interrupted: killed, or ended by an error after which the same command goes on.
    """
    note: dict[str, Any] = {"command": CALLED.get(), "done": 0, "total": 0}

    def told(step: str, done: int, total: int) -> None:
        note.update(done=done, total=total)
        _note(run, stage, note)
        progress(step, done, total)

    _note(run, stage, note)
    try:
        yield told
    except VcageError as error:
        if not error.retryable or isinstance(error, AnswerNeeded):  # that waits, and was not interrupted
            _note(run, stage, None)
        raise
    _note(run, stage, None)


def _note(run: RunFolder, stage: str, note: dict[str, Any] | None) -> None:
    notes = {name: other for name, other in unfinished(run).items() if name != stage}
    if note is not None:
        write_json(run.unfinished, {**notes, stage: note})
    elif notes:
        write_json(run.unfinished, notes)
    else:
        run.unfinished.unlink(missing_ok=True)


def unfinished(run: RunFolder) -> dict[str, dict[str, Any]]:
    """Stages that were begun and not finished → the ``command`` that makes it, and how far it is: ``done`` of
    ``total``; none when the file is damaged (it is a by-product)."""
    notes: Any = None
    with contextlib.suppress(DamagedFile, MissingStage):
        notes = read_json(run.unfinished)
    found = notes.items() if isinstance(notes, dict) else ()
    return {stage: note for stage, note in found if stage in _COMMANDS and _is_note(note)}


_COMMANDS = {stage: stage.replace("_", "-") for stage in PRODUCERS.values()}
"""Stage → its command."""


def _is_note(note: Any) -> bool:
    kinds = {"command": str, "done": int, "total": int}
    return isinstance(note, dict) and all(type(note.get(key)) is kind for key, kind in kinds.items())


def _interrupted(run: RunFolder, stage: str, note: dict[str, Any]) -> StageInterrupted:
    steps = "episodes" if stage == "collect" else "steps"
    far = f" after {note['done']} of {note['total']} {steps}" if note["total"] else ""
    details = {"stage": stage, "done": note["done"], "total": note["total"]}
    message = f"{stage} was interrupted{far}"
    if goes_on_with(note["command"], run.root, ("run", *_COMMANDS.values())):
        return StageInterrupted(message, hint="go on with it", command=note["command"], maker=stage, details=details)
    if not run.scene.exists():  # a script was run by itself
        return StageInterrupted(message, hint="start its script again", details=details)
    return StageInterrupted(message, hint="go on with it", maker=stage, details=details)


def note_seconds(run: RunFolder, stage: str, seconds: float, *, grown: bool = False) -> None:
    """Keep how long a stage took in ``timings.json``, apart from its own files, which are the same for the same seed.

    Args:
        run: the run folder.
        stage: its name.
        seconds: of the call that finished it.
        grown: that call added to what an earlier one had made, whose time counts as well.
    """
    recover(run.timings)
    timings = read_timings(run)
    before = timings.get(stage, 0.0) if grown else 0.0
    write_json(run.timings, {**timings, stage: round(before + seconds, 2)})


def read_timings(run: RunFolder) -> dict[str, float]:
    """Seconds by stage; empty when nothing was timed or the file is damaged (it is a by-product)."""
    try:
        timings = read_json(run.timings)
    except (DamagedFile, MissingStage):
        return {}
    found = timings.items() if isinstance(timings, dict) else ()
    return {stage: seconds for stage, seconds in found if isinstance(seconds, int | float)}
