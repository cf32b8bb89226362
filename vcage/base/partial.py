"""Names of partial work, and its repair after a killed process."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

PARTIAL = ".partial-"
"""Marks partial work; it may be deleted when nothing runs."""

REPLACED = ".replaced-"
"""Marks a finished folder under replacement; it is restored if the replacement failed."""


def is_written(part: Path) -> bool:
    """Check whether the process whose number is in the name still runs on this machine, and is not this one."""
    number = part.name.partition(PARTIAL)[2].partition(".")[0]
    if not number.isdecimal() or int(number) == os.getpid():
        return False
    try:
        os.kill(int(number), 0)
    except ProcessLookupError:
        return False
    except PermissionError:  # another user's
        return True
    return True


def recover(path: Path) -> None:
    """Mend what a killed ``atomic_folder`` or ``atomic_path`` left beside ``path``.

    A folder that was moved away for a replacement that never came is moved back; partial work is deleted, but for that
    of a process that is still there.
    """
    path = Path(path)
    if not path.parent.is_dir():
        return
    for old in sorted(path.parent.glob(f"{path.name}{REPLACED}*")):
        if path.exists():
            shutil.rmtree(old, ignore_errors=True)
        else:
            os.replace(old, path)
    leftovers = set(path.parent.glob(f"{path.name}{PARTIAL}*")) | set(
        path.parent.glob(f"{path.stem}{PARTIAL}*{path.suffix}")
    )
    for part in leftovers:
        if is_written(part):
            continue
        if part.is_dir():
            shutil.rmtree(part, ignore_errors=True)
        else:
            part.unlink(missing_ok=True)
