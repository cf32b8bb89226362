"""Prepare the process of a command: its streams, its folder, its open files."""

from __future__ import annotations

import contextlib
import os
import resource
import sys
from dataclasses import dataclass
from pathlib import Path

from vcage.base.errors import ConfigurationError, UsageError

STREAMS = ("stdin", "stdout", "stderr")


@dataclass(frozen=True)
class FileLimits:
    """Limits of open files; a run with two workers has up to a hundred.

    Args:
        required: with fewer, no command begins.
        wanted: the limit is raised to this where the system allows it.
    """

    required: int = 256
    wanted: int = 4096


LIMITS = FileLimits()


def prepare() -> None:
    """Prepare this process for a command; call it first."""
    _open_closed_streams()
    with contextlib.suppress(OSError, ValueError):
        most = resource.getrlimit(resource.RLIMIT_NOFILE)
        wanted = LIMITS.wanted if most[1] == resource.RLIM_INFINITY else min(LIMITS.wanted, most[1])
        if most[0] != resource.RLIM_INFINITY and most[0] < wanted:
            resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, most[1]))


def require_fit() -> None:
    """Check that a command can work in this process.

    Raises:
        UsageError: the current folder was removed.
        ConfigurationError: too few files may be open at a time.
    """
    if folder_is_gone():
        raise removed_folder()
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    if most != resource.RLIM_INFINITY and most < LIMITS.required:
        raise ConfigurationError(
            f"only {most} files may be open at a time; at least {LIMITS.required} are needed",
            hint=f"raise the limit, in a new shell if need be: ulimit -n {LIMITS.wanted}",
        )


def folder_is_gone() -> bool:
    """True if the current folder was removed."""
    try:
        Path.cwd()
    except FileNotFoundError:
        return True
    return False


def removed_folder() -> UsageError:
    """Return the error for :func:`folder_is_gone`."""
    return UsageError("the current folder was removed", hint="go to one that exists: cd")


def _open_closed_streams() -> None:
    """Let stdin, stdout and stderr lead nowhere where the caller closed them, or the next file that is opened would
    take their place and get what libraries print. What stdout cannot show of a name is written with escapes."""
    for number, name in enumerate(STREAMS):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free
            setattr(sys, name, os.fdopen(number, "r" if number == 0 else "w", encoding="utf-8", closefd=False))
            setattr(sys, f"__{name}__", getattr(sys, name))
            if name == "stdout":
                with contextlib.suppress(OSError):
                    os.write(2, b"vcage: stdout is closed, so the result is not printed\n")
    with contextlib.suppress(AttributeError):  # something else stands in its place
        sys.stdout.reconfigure(errors="backslashreplace")  # pyrefly: ignore
