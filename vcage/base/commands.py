"""Commands for messages: they run as printed, in any shell, from any folder, with any PATH."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Collection, Iterable
from contextvars import ContextVar
from pathlib import Path

CALLED: ContextVar[str] = ContextVar("called", default="")
"""The command that this process runs, as a user can repeat it; empty in other programs."""


def vcage_command(*words: object) -> str:
    """Return a command of ours with the full path of the program: agents' shells rarely have it on their PATH.

    Args:
        words: of the command; paths must be absolute.

    Example:
        >>> vcage_command("setup", "vulkan")
        '/home/me/vcage/.venv/bin/vcage setup vulkan'
    """
    return joined([*_program(), *words])


def _program() -> list[str]:
    beside = Path(sys.executable).with_name("vcage")
    return [str(beside)] if beside.exists() else [sys.executable, "-m", "vcage.cli.main"]


def is_safe_continuation(command: str, run: Path, subcommands: Collection[str]) -> bool:
    """Check that a command from a file of a run folder is one of ours on that run, and names nothing to execute.

    The folder may come from someone else, and the reader of an error may run its command.
    """
    try:
        words = shlex.split(command)
    except ValueError:
        return False
    program = _program()
    named, options = words[: len(program)], words[len(program) :]
    ours = (
        joined(words) == command
        and named == program
        and bool(options)
        and options[0] in subcommands
        and str(run) in options
    )
    return ours and not any(word.startswith("--script") for word in options)


def joined(words: Iterable[object]) -> str:
    """Quote words for a shell; a part of a file name that is not text becomes a question mark."""
    return shlex.join(map(str, words)).encode(errors="replace").decode()


def pip_command(*words: str) -> str:
    """Return the command that installs something with pip into this environment."""
    return shlex.join([sys.executable, "-m", "pip", "install", *words])
