"""The demo from the sentence to the export, beside ManiSkill's runner recording as many pick-and-places."""

from __future__ import annotations

import json
import logging
import subprocess
import sys
import tempfile
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np

from benchmarks._process_times import Timed, timed
from vcage.base.errors import VcageError
from vcage.base.files import RunFolder
from vcage.objects.library import Library
from vcage.runs.by_products import read_timings
from vcage.schema.episodes import Episodes

logger = logging.getLogger(__name__)

INSTRUCTION = "Pack the marker pens and the eraser into the box"
"""The instruction of ``make demo``."""

SHADERS = ("default", "minimal")
"""Shaders of ManiSkill's runner: its default, and the fastest."""


@dataclass(frozen=True)
class Recorded:
    """Cost of a successful trajectory of ManiSkill's runner: wall seconds, CPU seconds, frames."""

    wall_s: float
    cpu_s: float
    frames: float


def run(quick: bool) -> dict[str, object]:
    """Wall and CPU seconds per pick-and-place. Ours works in several processes, theirs in one, so both times count.

    - ``vcage_seconds``, ``vcage_cpu_seconds``: ``vcage run`` in a process of its own, from its start to its end
      (objects chosen, placed, drawn, matched and optimised, sub-tasks searched, episodes collected, verified,
      compressed, exported, and the report), divided by the pick-and-places in the episodes that were accepted. CPU
      seconds are those of all its processes. The models of the objects are built before.
    - ``maniskill_seconds``, ``maniskill_cpu_seconds``: ManiSkill's motion-planning runner on StackCube in one process,
      divided by the trajectories that succeeded: its solver, its ``RecordEpisode`` (actions, states, pictures in HDF5
      with gzip) and the shaders that it takes by default, with three cameras of the size and frame rate of ours. Half
      of them before ours and half after, each without the start of its process and its first trajectory. Nobody looks
      at what it wrote.
    - ``maniskill_seconds_minimal``, ``maniskill_cpu_seconds_minimal``: the same with its fastest shaders, which its
      runner offers on demand.
    - ``ratio``, ``cpu_ratio``: ours divided by theirs. ``stages``: our wall seconds by stage, of the same unit.
    - ``frames``: per pick-and-place, ours and theirs.

    Args:
        quick: one episode instead of three.
    """
    Library.load().entries()
    half = 3 if quick else 7
    before = [_maniskill(half, shaders) for shaders in SHADERS]
    with tempfile.TemporaryDirectory() as folder:
        ours, run_folder = _vcage(Path(folder) / "run", episodes=1 if quick else 3)
        accepted = [e for e in Episodes.read(run_folder.episodes).episodes if e.accepted]
        timings = read_timings(run_folder)
    after = [_maniskill(half, shaders) for shaders in SHADERS]
    placed = sum(len(episode.subtasks) for episode in accepted)
    theirs, fastest = map(_mean, before, after)
    return {
        "vcage_seconds": round(ours.wall_s / placed, 2),
        "vcage_cpu_seconds": round(ours.cpu_s / placed, 2),
        "maniskill_seconds": round(theirs.wall_s, 2),
        "maniskill_cpu_seconds": round(theirs.cpu_s, 2),
        "maniskill_seconds_minimal": round(fastest.wall_s, 2),
        "maniskill_cpu_seconds_minimal": round(fastest.cpu_s, 2),
        "ratio": round(ours.wall_s / placed / theirs.wall_s, 3),
        "cpu_ratio": round(ours.cpu_s / placed / theirs.cpu_s, 3),
        "stages": {stage: round(seconds / placed, 3) for stage, seconds in timings.items()},
        "frames": {
            "vcage": round(sum(episode.frames for episode in accepted) / placed, 1),
            "maniskill": round(theirs.frames, 1),
        },
        "pick_and_places": placed,
    }


def _mean(one: Recorded, other: Recorded) -> Recorded:
    """The mean of two measurements of the same number of trajectories."""
    return Recorded(*np.mean([astuple(one), astuple(other)], axis=0).tolist())


def _vcage(folder: Path, episodes: int) -> tuple[Timed, RunFolder]:
    """Time ``vcage run``; return it with its folder."""
    command = [sys.executable, "-m", "vcage.cli.main", "run", INSTRUCTION, "--out", str(folder)]
    done = timed([*command, "--episodes", str(episodes), "--models", "offline"])
    if done.code != 0:
        raise VcageError(f"vcage run ended with {done.code}: {done.stdout[-500:]}", hint="run: vcage doctor")
    summary = json.loads(done.stdout.splitlines()[-1])["summary"]
    logger.info("vcage run: %.1f s, %.1f CPU s, %s", done.wall_s, done.cpu_s, summary)
    return done, RunFolder(folder)


def _maniskill(count: int, shaders: str) -> Recorded:
    """Measure successful trajectories, without the first.

    Args:
        count: how many trajectories.
        shaders: ManiSkill's name of them.
    """
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "benchmarks._maniskill_recording", str(count + 1), folder, shaders]
        done = subprocess.run(command, capture_output=True, text=True)
    lines = [line.split() for line in done.stdout.splitlines() if line[:1].isdigit()]
    if done.returncode != 0 or len(lines) != count + 1:
        raise VcageError(f"ManiSkill's runner ended with {done.returncode}: {done.stderr[-500:]}")
    wall, cpu = ((float(lines[-1][field]) - float(lines[0][field])) / count for field in (1, 3))
    logger.info("ManiSkill, shaders %s: %.2f s, %.2f CPU s for each of %d trajectories", shaders, wall, cpu, count)
    return Recorded(wall, cpu, sum(int(line[2]) for line in lines[1:]) / count)
