"""Edited scripts of a run: executed if an option names them, else mentioned in a note."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path

from vcage.base.commands import joined
from vcage.base.errors import InputFileError, UnknownName, UsageError
from vcage.base.files import RunFolder
from vcage.base.placeholders import require_fetched
from vcage.runs.edits import edited_scripts
from vcage.schema.subtasks import Subtasks


def named_scripts(run: RunFolder, paths: Sequence[Path]) -> dict[str, Path]:
    """Map sub-tasks to the scripts that are executed in place of the generated ones.

    Raises:
        InputFileError: there is no such file, or it is no regular file.
        UsageError: two are named for one sub-task.
        UnknownName: one is named after no sub-task of a chain.
    """
    found: dict[str, Path] = {}
    known = _chained(run) if paths else set()
    for path in paths:
        require_fetched(path)
        if not path.is_file():
            raise InputFileError(f"--script: there is no file {path}", hint="check the path")
        if path.stem not in known:
            raise UnknownName("sub-task with a script", path.stem, known)
        if path.stem in found:
            raise UsageError(f"--script: {found[path.stem]} and {path} are for the same sub-task", hint="name one")
        found[path.stem] = path
    return found


def _chained(run: RunFolder) -> set[str]:
    """Return the ids of the sub-tasks of all chains."""
    return {name for chain in Subtasks.read(run.subtasks).chains for name in chain.subtasks}


def unnamed_edits(run: RunFolder, scripts: Collection[str]) -> list[str]:
    """Return a sentence on each edited script of a chain that is not executed."""
    folder, of_chains = run.subtasks.parent, _chained(run)
    return [
        f"{folder.name}/{name} was edited by hand and is not executed: its sub-task is carried out as "
        f"{run.subtasks.name} says; to execute it, add {joined(['--script', folder / name])}"
        for name in edited_scripts(run.subtasks)
        if Path(name).stem in of_chains and Path(name).stem not in scripts
    ]
