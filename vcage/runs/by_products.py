"""By-products of a run: how far a stage is, and how long it took. A run does without them where they are damaged."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from vcage.base.commands import CALLED, is_safe_continuation
from vcage.base.errors import AnswerNeeded, DamagedFile, MissingStage, StageInterrupted, VcageError
from vcage.base.files import PRODUCERS, RunFolder, read_json, write_json
from vcage.base.leftovers import recover
from vcage.base.progress import Progress
from vcage.schema.base import Record

T = TypeVar("T")

_COMMANDS = {stage: stage.replace("_", "-") for stage in PRODUCERS.values()}
"""Stage → its command."""


class Unfinished(Record):
    """A started, unfinished stage: its command, and its steps."""

    command: str
    done: int = 0
    total: int = 0


def read_by_product(path: Path, kind: type[T]) -> dict[str, T]:
    """Return the entries of a JSON object; without entries of another kind, and none for an unreadable one."""
    found: Any = None
    with contextlib.suppress(DamagedFile, MissingStage):
        found = read_json(path)
    entries, adapter = dict[str, T](), TypeAdapter(kind)
    for key, value in found.items() if isinstance(found, dict) else ():
        with contextlib.suppress(ValidationError):
            entries[key] = adapter.validate_python(value, strict=True)
    return entries


# --- how far a stage is ----------------------------------------------------------------------------------


def unfinished(run: RunFolder) -> dict[str, Unfinished]:
    """Return the stages that were begun and not finished, by name."""
    return {stage: note for stage, note in read_by_product(run.unfinished, Unfinished).items() if stage in _COMMANDS}


@contextlib.contextmanager
def noting_progress(run: RunFolder, stage: str, progress: Progress) -> Iterator[Progress]:
    """Keep in ``unfinished.json``, by stage, which command makes it and how far it is, until it is made.

    Stages left there were interrupted: killed, or ended by an error after which the same command resumes.
    """
    command = CALLED.get()

    def report(step: str, done: int, total: int) -> None:
        _note(run, stage, Unfinished(command=command, done=done, total=total))
        progress(step, done, total)

    _note(run, stage, Unfinished(command=command))
    try:
        yield report
    except VcageError as error:
        if not error.retryable or isinstance(error, AnswerNeeded):  # that waits, and was not interrupted
            _note(run, stage, None)
        raise
    _note(run, stage, None)


def _note(run: RunFolder, stage: str, note: Unfinished | None) -> None:
    notes = {name: other for name, other in unfinished(run).items() if name != stage}
    notes |= {stage: note} if note is not None else {}
    if notes:
        write_json(run.unfinished, {name: one.model_dump() for name, one in notes.items()})
    else:
        run.unfinished.unlink(missing_ok=True)


def interrupted(run: RunFolder, stage: str) -> StageInterrupted | None:
    """Return the error of an interrupted stage, with the command that resumes it; None for another one."""
    note = unfinished(run).get(stage)
    if note is None:
        return None
    steps = "episodes" if stage == "collect" else "steps"
    message = f"{stage} was interrupted{f' after {note.done} of {note.total} {steps}' if note.total else ''}"
    details = {"stage": stage, "done": note.done, "total": note.total}
    ours = is_safe_continuation(note.command, run.root, ("run", *_COMMANDS.values()))
    if not ours and not run.scene.exists():  # a script was run alone
        return StageInterrupted(message, hint="start its script again", details=details)
    command = note.command if ours else ""
    return StageInterrupted(message, hint="go on with it", command=command, maker=stage, details=details)


# --- how long it took ------------------------------------------------------------------------------------


def note_seconds(run: RunFolder, stage: str, seconds: float, *, grown: bool = False) -> None:
    """Keep how long a stage took in ``timings.json``, apart from its own files, which are the same for the same seed.

    Args:
        run: the run folder.
        stage: its name.
        seconds: of the call that finished it.
        grown: that call extended the result of an earlier one, whose time counts as well.
    """
    recover(run.timings)
    timings = read_timings(run)
    before = timings.get(stage, 0.0) if grown else 0.0
    write_json(run.timings, {**timings, stage: round(before + seconds, 2)})


def read_timings(run: RunFolder) -> dict[str, float]:
    """Return the seconds by stage."""
    return read_by_product(run.timings, float)
