"""Running the tools that fetch."""

from __future__ import annotations

import subprocess
from pathlib import Path

from vcage.base.errors import FetchFailed

CHECK_MIRROR = "check that the package mirror answers, then run the same command again"


def run(
    command: list[str],
    *,
    tool: str = "",
    cwd: Path | None = None,
    context: str = "",
    hint: str = CHECK_MIRROR,
) -> str:
    """Return the standard output of a command.

    Args:
        tool: name in the error; the program's name by default.
        context: stderr of an earlier command, which may hold the reason of a failure of this one.
        hint: the way out of a failure.

    Raises:
        FetchFailed: the command failed; the message is the line of its stderr that says why.
    """
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True)
    if done.returncode != 0:
        why = reason(f"{context}\n{done.stderr}")
        raise FetchFailed(f"{tool or Path(command[0]).name}: {why}", hint=hint)
    return done.stdout


def reason(complaint: str) -> str:
    """Return the line of stderr of apt, dpkg or pip that says why it failed."""
    lines = complaint.strip().splitlines() or ["no reason given"]
    telling = ("E: ", "W: Failed", "ERROR: ")
    line = next((line for line in lines if line.startswith(telling)), lines[-1])
    return line.removeprefix("E: ").removeprefix("ERROR: ").strip()
