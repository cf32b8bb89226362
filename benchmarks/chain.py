"""The demo from the sentence to the export, beside ManiSkill's runner recording as many pick-and-places."""

from __future__ import annotations

import json
import logging
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from vcage.base.errors import VcageError
from vcage.base.files import RunFolder
from vcage.objects.library import Library
from vcage.runs.by_products import read_timings
from vcage.schema.episodes import Episodes

logger = logging.getLogger(__name__)

INSTRUCTION = "Pack the marker pens and the eraser into the box"
"""That of ``make demo``."""

SHADERS = ("default", "minimal")
"""Of ManiSkill's runner: those that it takes by default, and the fastest."""


def run(quick: bool) -> dict[str, object]:
    """Wall seconds per pick-and-place.

    - ``vcage_seconds``: ``vcage run`` in a process of its own, from its start to its end (objects chosen, placed,
      drawn, matched and optimised, sub-tasks searched, episodes collected, verified, compressed, exported, and the
      report), divided by the pick-and-places in the episodes that were accepted. The models of the objects are built
      before.
    - ``maniskill_seconds``: ManiSkill's motion-planning runner on StackCube in one process, divided by the trajectories
      that succeeded: its solver, its ``RecordEpisode`` (actions, states, pictures in HDF5 with gzip) and the shaders
      that it takes by default, with three cameras of the size and frame rate of ours. Half of them before ours and half
      after, each without the start of its process and its first trajectory. Nobody looks at what it wrote.
    - ``maniskill_seconds_minimal``: the same with its fastest shaders, which its runner offers on demand.
    - ``ratio``: ours divided by ``maniskill_seconds``. ``stages``: ours by stage, of the same unit.
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
    (theirs, frames), (fastest, _) = np.mean([before, after], axis=0)
    return {
        "vcage_seconds": round(ours / placed, 2),
        "maniskill_seconds": round(theirs, 2),
        "maniskill_seconds_minimal": round(fastest, 2),
        "ratio": round(ours / placed / theirs, 3),
        "stages": {stage: round(seconds / placed, 3) for stage, seconds in timings.items()},
        "frames": {
            "vcage": round(sum(episode.frames for episode in accepted) / placed, 1),
            "maniskill": round(frames, 1),
        },
        "pick_and_places": placed,
    }


def _vcage(folder: Path, episodes: int) -> tuple[float, RunFolder]:
    """Seconds of ``vcage run``, and its folder."""
    command = [sys.executable, "-m", "vcage.cli.main", "run", INSTRUCTION, "--out", str(folder)]
    start = time.perf_counter()
    done = subprocess.run(
        [*command, "--episodes", str(episodes), "--models", "offline"], stdout=subprocess.PIPE, text=True
    )
    elapsed = time.perf_counter() - start
    if done.returncode != 0:
        raise VcageError(f"vcage run ended with {done.returncode}: {done.stdout[-500:]}", hint="run: vcage doctor")
    logger.info("vcage run: %.1f s, %s", elapsed, json.loads(done.stdout.splitlines()[-1])["summary"])
    return elapsed, RunFolder(folder)


def _maniskill(count: int, shaders: str) -> tuple[float, float]:
    """Seconds and frames of a successful trajectory, without the first.

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
    seconds = (float(lines[-1][1]) - float(lines[0][1])) / count
    logger.info("ManiSkill, shaders %s: %.2f s for each of %d trajectories", shaders, seconds, count)
    return seconds, sum(int(line[2]) for line in lines[1:]) / count
