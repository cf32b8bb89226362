"""Running the tools that fetch."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from vcage.base.errors import FetchFailed

CHECK_MIRROR = "check that the package mirror answers, then run the same command again"


def run(
    command: list[str],
    *,
    tool: str = "",
    cwd: Path | None = None,
    environment: dict[str, str] | None = None,
    context: str = "",
    hint: str = CHECK_MIRROR,
) -> str:
    """Standard output of a command.

    Args:
        tool: what a failure calls it; the program's name by default.
        environment: variables set beside the process's own.
        context: what an earlier command said that may be the reason for a failure of this one.
        hint: the way out of a failure.

    Raises:
        FetchFailed: it failed; the message is the line of its complaint that says why.
    """
    variables = {**os.environ, **(environment or {})}
    done = subprocess.run(command, cwd=cwd, env=variables, capture_output=True, text=True)
    if done.returncode != 0:
        why = reason(f"{context}\n{done.stderr}")
        raise FetchFailed(f"{tool or Path(command[0]).name}: {why}", hint=hint)
    return done.stdout


def reason(complaint: str) -> str:
    """The line of what apt, dpkg or pip wrote to stderr that says why it failed."""
    lines = complaint.strip().splitlines() or ["no reason given"]
    telling = ("E: ", "W: Failed", "ERROR: ")
    line = next((line for line in lines if line.startswith(telling)), lines[-1])
    return line.removeprefix("E: ").removeprefix("ERROR: ").strip()
