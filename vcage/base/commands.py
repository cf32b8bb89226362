"""Commands that are told to whoever reads: as they stand they run in any shell, from any folder, with any PATH."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterable
from contextvars import ContextVar
from pathlib import Path

CALLED: ContextVar[str] = ContextVar("called", default="")
"""The command that this process carries out, as it can be given again; empty in programs of others."""


def vcage_command(*words: object) -> str:
    """A command of ours, by the path of this environment's program: agents' shells rarely have it on their PATH.

    Args:
        words: of the command; paths must be absolute.

    Example:
        >>> vcage_command("setup", "vulkan")
        '/home/me/vcage/.venv/bin/vcage setup vulkan'
    """
    beside = Path(sys.executable).with_name("vcage")
    program = [beside] if beside.exists() else [sys.executable, "-m", "vcage.cli.main"]
    return joined([*program, *words])


def joined(words: Iterable[object]) -> str:
    """Words as a shell takes them; what is no text, as a file's name may be, cannot be told."""
    return shlex.join(map(str, words)).encode(errors="replace").decode()


def pip_command(*words: str) -> str:
    """The command with which pip installs something into this environment."""
    return shlex.join([sys.executable, "-m", "pip", "install", *words])
