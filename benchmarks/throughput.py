"""Verified episodes per hour of a two-step task, by one process and by two; memory and processor time beside.

Then the environment of the same run: steps per CPU second with and without pictures, and memory over resets.
"""

from __future__ import annotations

import argparse
import json
import logging
import re
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import psutil

from benchmarks._environment_steps import acted
from vcage.base.errors import VcageError
from vcage.base.files import RunFolder
from vcage.base.workers import cores
from vcage.schema.episodes import Episodes
from vcage.schema.subtasks import Subtasks

logger = logging.getLogger(__name__)

INSTRUCTION = "Put the red block and the blue block on the plate"

STAGES = ("inpaint-plan", "match", "optimize", "search-subtasks")

PICTURES = {"both": (False, True), "without": (False,), "with": (True,)}
"""Rows of the environment."""

WATCHED = 0.5
"""Seconds from one look at the processes to the next."""

WARM = 3
"""Episodes after which memory is expected to stay: by then all that episodes share is loaded."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of this benchmark."""
    parser.add_argument("--episodes", type=int, default=20, help="to collect each time (default: 20; quick: 4)")
    parser.add_argument(
        "--workers",
        type=int,
        nargs="*",
        default=[1, 2],
        help="numbers of processes; none: nothing is collected (default: 1 2)",
    )
    parser.add_argument("--steps", type=int, default=300, help="of the environment (default: 300; quick: 60)")
    parser.add_argument("--resets", type=int, default=100, help="of the environment (default: 100; quick: 12)")
    parser.add_argument("--pictures", choices=PICTURES, default="both", help="of the environment (default: both)")


def run(
    quick: bool, episodes: int, workers: list[int], steps: int, resets: int, pictures: str = "both"
) -> dict[str, Any]:
    """Collect the same episodes with each number of processes, and act in the environment of the run.

    Each row: ``episodes_per_hour`` that were verified, start of the processes included; ``peak_mb``, the most that the
    largest process held; ``mb_per_episode``, by how much the largest process grew with every episode after the first
    few (least squares); ``cpu_seconds`` as of the last look, one every :data:`WATCHED` s, and ``cpu_share`` of all
    cores. ``speedup`` is that of the last number over the first. ``environment`` has rows without and with pictures
    (:func:`~benchmarks._environment_steps.acted`).

    Args:
        quick: four episodes, 60 steps, 12 resets.
        episodes: to collect.
        workers: numbers of processes.
        steps: of the environment.
        resets: of the environment.
        pictures: one of :data:`PICTURES`.
    """
    rows, environment = [], []
    with tempfile.TemporaryDirectory() as folder:
        first = _begun(Path(folder) / "begun")
        subtasks = len(Subtasks.read(first.subtasks).chains[0].subtasks)
        for count in workers:
            rows.append(_collected(first, Path(folder) / f"with-{count}", count, 4 if quick else episodes))
            logger.info("%s", rows[-1])
        for drawn in PICTURES[pictures]:
            environment.append(acted(first, drawn, 60 if quick else steps, 12 if quick else resets))
            logger.info("%s", environment[-1])
    return {
        "rows": rows,
        "speedup": round(rows[-1]["episodes_per_hour"] / rows[0]["episodes_per_hour"], 2) if rows else None,
        "environment": environment,
        "steps": subtasks,
        "cores": cores(),
    }


def _begun(folder: Path) -> RunFolder:
    """A run up to the collection."""
    _vcage("select-place", INSTRUCTION, "--models", "offline", "--out", folder)
    for stage in STAGES:
        _vcage(stage, "--run", folder)
    return RunFolder(folder)


def _vcage(*arguments: str | Path) -> None:
    done = subprocess.run(_command(*arguments), capture_output=True, text=True)
    if done.returncode != 0:
        raise VcageError(f"vcage {arguments[0]} ended with {done.returncode}: {done.stderr[-500:]}")


def _command(*arguments: str | Path) -> list[str]:
    return [sys.executable, "-m", "vcage.cli.main", *map(str, arguments)]


@dataclass
class _Watch:
    """Memory and CPU time of a process and all below it, watched while they run.

    Args:
        peak: most bytes that each held, by process.
        used: seconds of all cores that each used, by process.
        samples: episodes that were finished, and bytes that the largest process held then.
    """

    peak: dict[int, int] = field(default_factory=dict)
    used: dict[int, float] = field(default_factory=dict)
    samples: list[tuple[int, int]] = field(default_factory=list)

    def look(self, process: int, episodes: int) -> None:
        held = [0]
        for one in _processes(process):
            self.peak[one.pid] = max(self.peak.get(one.pid, 0), _peak(one.pid))
            with suppress(psutil.NoSuchProcess):
                held.append(one.memory_info().rss)
                self.used[one.pid] = sum(one.cpu_times()[:2])
        self.samples.append((episodes, max(held)))

    def growth(self) -> float:
        """Bytes per episode after the first few; 0 when too few were seen."""
        warm = np.array([sample for sample in self.samples if sample[0] >= WARM], np.float64)
        if len(warm) < 2 or np.ptp(warm[:, 0]) == 0:
            return 0.0
        return float(np.polyfit(warm[:, 0], warm[:, 1], 1)[0])


def _collected(first: RunFolder, folder: Path, workers: int, episodes: int) -> dict[str, Any]:
    """Collect into a copy of a run, and measure it."""
    subprocess.run(["cp", "-r", str(first.root), str(folder)], check=True)
    run, watch, start = RunFolder(folder), _Watch(), time.perf_counter()
    command = _command("collect", "--run", folder, "--episodes", str(episodes), "--workers", str(workers))
    process = subprocess.Popen([*command, "--models", "offline"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    log = folder / "episodes.collecting" / "episodes.json"
    while process.poll() is None:
        watch.look(process.pid, len(json.loads(log.read_text())["episodes"]) if log.exists() else 0)
        time.sleep(WATCHED)
    elapsed, used = time.perf_counter() - start, sum(watch.used.values())
    if process.returncode != 0:
        raise VcageError(f"vcage collect ended with {process.returncode}")
    verified = sum(episode.accepted for episode in Episodes.read(run.episodes).episodes)
    return {
        "workers": workers,
        "verified": verified,
        "episodes_per_hour": round(3600 * verified / elapsed, 1),
        "seconds": round(elapsed, 1),
        "cpu_seconds": round(used, 1),
        "cpu_share": round(used / elapsed / cores(), 2),
        "peak_mb": round(max(watch.peak.values()) / 1e6),
        "mb_per_episode": round(watch.growth() / 1e6, 2),
    }


def _processes(process: int) -> list[psutil.Process]:
    """A process and all that it started, and these started, which still run."""
    try:
        first = psutil.Process(process)
        return [first, *first.children(recursive=True)]
    except psutil.NoSuchProcess:
        return []


def _peak(process: int) -> int:
    """Peak memory of a running process, bytes; 0 of one that has ended."""
    try:
        found = re.search(r"^VmHWM:\s+(\d+) kB$", Path(f"/proc/{process}/status").read_text(), re.MULTILINE)
    except OSError:
        return 0
    return int(found[1]) * 1024 if found else 0
