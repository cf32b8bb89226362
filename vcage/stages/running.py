"""Around a call of a stage: the run folder is one process's at a time, and how long stages took is kept."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator
from typing import Any, Protocol

from vcage.base.errors import InputFileError
from vcage.base.files import RunFolder, read_json, recover, write_json
from vcage.base.hold import held
from vcage.base.progress import Progress, silent
from vcage.stages.context import StageContext
from vcage.stages.stage import Job, StageOptions, StageResult


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
        OutputFolderError: another process works on the run.
        VcageError: what the stage raises.
    """
    options = options or stage.Options()
    with at_work(run):
        return timed(stage, run, options, context or options.context(run), progress)


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
    start = time.perf_counter()
    done = stage.execute(run, options, context, progress)
    if done.fresh:
        note_seconds(run, stage.__name__.rpartition(".")[2], time.perf_counter() - start, grown=done.grown)
    return done


@contextlib.contextmanager
def at_work(run: RunFolder) -> Iterator[None]:
    """Keep the run folder for this process while it works there; a folder in which nothing came to be goes again.

    Raises:
        OutputFolderError: another process works there (says which), or the folder cannot be written.
    """
    begun = run.root.exists()
    run.make()
    try:
        with held(run.root):
            yield
    finally:
        if not begun:
            with contextlib.suppress(OSError):  # not empty: something came to be
                run.root.rmdir()


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
    except InputFileError:
        return {}
    return timings if isinstance(timings, dict) else {}
