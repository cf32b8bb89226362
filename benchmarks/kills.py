"""``vcage run`` killed at random moments and given again: whether it ends with the same files, and leaves nothing."""

from __future__ import annotations

import argparse
import logging
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from vcage.base.errors import VcageError
from vcage.base.files import PRODUCERS, RunFolder, sha256_file
from vcage.runs.by_products import unfinished

logger = logging.getLogger(__name__)

COMMAND = [
    *("run", "Put the blocks on the plate", "--models", "offline", "--episodes", "3", "--workers", "2"),
    *("--fps", "5", "--crf", "20", "--effort", "fast", "--keyframes", "2"),
]
"""As quick as a run gets with every stage at work and more than one process."""

WITH_TIMES = ("timings.json", "report.html")
"""Files of a run that say how long something took."""

MOST_CALLS = 5
"""Calls after which a run that was killed should have ended."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of this benchmark."""
    parser.add_argument("--kills", type=int, default=30, help="runs that are killed once each (default: 30; quick: 3)")
    parser.add_argument("--seed", type=int, default=0, help="of the moments (default: 0)")


def run(quick: bool, kills: int, seed: int) -> dict[str, Any]:
    """Kill as many runs at moments that are drawn evenly over the time of an undisturbed one.

    All processes of the run get SIGKILL. Then the same command is given until it ends.

    Each row, by the stage that was killed: ``kills``; ``finished`` runs, with exit code 0; ``same``, those of them
    with all files equal to those of the undisturbed run, except recorded times; ``leftovers``, files that the
    undisturbed run has not, in the run folder, beside it and among temporary files. ``different`` and ``left`` name the
    files, ``errors`` what runs said that did not finish.

    Args:
        quick: three kills.
        kills: how many.
        seed: of the moments.
    """
    count, rng = 3 if quick else kills, np.random.default_rng(seed)
    rows: dict[str, _Row] = defaultdict(_Row)
    with tempfile.TemporaryDirectory() as folder:
        place = _Place(Path(folder))
        start = time.perf_counter()
        place.require_finished(_finished(place))
        length = time.perf_counter() - start
        undisturbed = place.taken()
        for number in range(count):
            stage = _killed(place, (number + rng.random()) / count * length)
            error = _finished(place)
            rows[stage].add(error, undisturbed, place.taken())
            logger.info("%d of %d, killed in %s: %s", number + 1, count, stage, error or "finished")
    stages = [stage for stage in (*PRODUCERS.values(), "(start or report)") if stage in rows]
    whole = sum(rows.values(), _Row())
    return {
        **whole.figures(),
        "seconds_undisturbed": round(length, 1),
        "rows": [{"stage": stage, **rows[stage].figures()} for stage in stages],
        "different": sorted({*whole.different}),
        "left": sorted({*whole.left}),
        "errors": whole.errors,
    }


@dataclass
class _Row:
    """The outcome of the runs that were killed in one stage, or in all."""

    kills: int = 0
    finished: int = 0
    same: int = 0
    different: list[str] = field(default_factory=list)
    left: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)

    def add(self, error: str, undisturbed: Mapping[str, str], files: Mapping[str, str]) -> None:
        """Count one run by its files, path → hash, beside those of the undisturbed one."""
        different, left = compared(undisturbed, files)
        self.kills += 1
        self.finished += not error
        self.same += not error and not different
        self.different += different
        self.left += left
        self.errors += [error] if error else []

    def __add__(self, other: _Row) -> _Row:
        return _Row(**{part.name: getattr(self, part.name) + getattr(other, part.name) for part in fields(self)})

    def figures(self) -> dict[str, int]:
        return {"kills": self.kills, "finished": self.finished, "same": self.same, "leftovers": len(self.left)}


def compared(undisturbed: Mapping[str, str], files: Mapping[str, str]) -> tuple[list[str], list[str]]:
    """Missing, changed and extra files; path → hash each."""
    return [path for path, digest in undisturbed.items() if files.get(path) != digest], sorted(
        set(files) - {*undisturbed}
    )


@dataclass(frozen=True)
class _Place:
    """Folder in which all runs take place, one after the other at the same path, with temporary files of their own."""

    folder: Path

    @property
    def run(self) -> RunFolder:
        return RunFolder(self.folder / "runs" / "run")

    def start(self) -> subprocess.Popen:
        """Start the run, or go on with it, in a process group of its own."""
        temporary = self.folder / "temporary"
        temporary.mkdir(exist_ok=True)
        return subprocess.Popen(
            [sys.executable, "-m", "vcage.cli.main", *COMMAND, "--out", str(self.run)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            env=os.environ | {"TMPDIR": str(temporary)},
        )

    def require_finished(self, error: str) -> None:
        if error:
            raise VcageError(f"the undisturbed run failed: {error}")

    def taken(self) -> dict[str, str]:
        """All files, path → hash, each then removed; files with times have no hash."""
        paths = [
            path for path in sorted(self.folder.rglob("*")) if not path.is_dir() and "__pycache__" not in path.parts
        ]
        names = {path.relative_to(self.folder).as_posix(): path for path in paths}
        files = {
            name: "" if path.name in WITH_TIMES or not path.is_file() else sha256_file(path)
            for name, path in names.items()
        }
        for child in self.folder.iterdir():
            shutil.rmtree(child)
        return files


def _killed(place: _Place, seconds: float) -> str:
    """Start a run and kill it after so long; the stage that was at work."""
    process = place.start()
    try:
        process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
    return next(iter(unfinished(place.run)), "(start or report)")


def _finished(place: _Place) -> str:
    """Give the command until the run ends; the last error where it does not."""
    error = ""
    for _ in range(MOST_CALLS):
        process = place.start()
        _, complaint = process.communicate()
        if process.returncode == 0:
            return ""
        error = f"exit {process.returncode}: {' '.join(complaint.splitlines()[-1:])}"
    return error
