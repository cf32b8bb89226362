"""The demo from the sentence to the export, beside ManiSkill's runner recording as many pick-and-places."""

from __future__ import annotations

import compileall
import json
import logging
import re
import subprocess
import sys
import tempfile
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np

import vcage
from benchmarks._process_times import Timed, timed
from vcage.base.errors import VcageError
from vcage.base.files import RunFolder
from vcage.campaigns.folder import CampaignFolder
from vcage.objects.library import Library
from vcage.schema.episodes import Episodes

logger = logging.getLogger(__name__)

INSTRUCTION = "Pack the marker pens and the eraser into the box"
"""The instruction of ``make demo``."""

ROBOT = "dual_panda"
"""With the arm that ManiSkill's runner has."""

SHADERS = ("default", "minimal")
"""Shaders of ManiSkill's runner: its default, and the fastest."""

LONG = 10
"""Episodes of the longer run."""

STAGE = re.compile(r"\[\d+/\d+\] (\w+)")
"""A line on stderr when a stage begins."""


@dataclass(frozen=True)
class Chain:
    """Cost of a run of ours, and of its floor, for each pick-and-place.

    Args:
        wall_s, cpu_s: of the run.
        stages: part of the run → (2,) its wall and CPU seconds.
        floor: part of the floor → the same.
        frames: of the accepted episodes.
        placed: pick-and-places in these.
    """

    wall_s: float
    cpu_s: float
    stages: dict[str, np.ndarray]
    floor: dict[str, np.ndarray]
    frames: float
    placed: int

    def figures(self) -> dict[str, object]:
        """Return the figures of the table."""
        floor_wall, floor_cpu = self.floor["draw"] + self.floor["encode"]
        return {
            "vcage_seconds": round(self.wall_s, 2),
            "vcage_cpu_seconds": round(self.cpu_s, 2),
            "floor_seconds": round(float(floor_wall), 2),
            "floor_cpu_seconds": round(float(floor_cpu), 2),
            "floor_parts_cpu": {part: round(float(cpu), 2) for part, (_, cpu) in self.floor.items()},
            "floor_ratio": round(self.cpu_s / float(floor_cpu), 3),
            "stages": {stage: round(float(wall), 3) for stage, (wall, _) in self.stages.items()},
            "stages_cpu": {stage: round(float(cpu), 3) for stage, (_, cpu) in self.stages.items()},
        }


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
      seconds are those of all its processes. The models of the objects are built before, and our modules are compiled,
      as an installation leaves them. ``…_long`` are those of a run of more episodes, which share its fixed cost.
    - ``…_job``: those of the second job of a campaign, of as many episodes as the longer run, in a process that ran the
      first job before: it begins at the CRFs of that one, and writes no report. What a process does once is left out:
      all jobs of a worker share it.
    - ``floor_seconds``, ``floor_cpu_seconds``: the accepted frames drawn once, in worlds built from the recorded starts
      and looks, and encoded once at the CRF that the run chose, to the same bytes, in a process of its own
      (:mod:`benchmarks._floor`). Without what a process does once, Python's start, imports and its first picture, and
      without reading and writing files; ``floor_parts_cpu`` names the parts, and that start.
    - ``maniskill_seconds``, ``maniskill_cpu_seconds``: ManiSkill's motion-planning runner on StackCube in one process,
      divided by the trajectories that succeeded: its solver, its ``RecordEpisode`` (actions, states, pictures in HDF5
      with gzip) and the shaders that it takes by default, with three cameras of the size and frame rate of ours. Half
      of them before ours and half after, each without the start of its process and its first trajectory. Nobody looks
      at what it wrote.
    - ``maniskill_seconds_minimal``, ``maniskill_cpu_seconds_minimal``: the same with its fastest shaders, which its
      runner offers on demand.
    - ``ratio``, ``cpu_ratio``: ours divided by theirs. ``floor_ratio``: our CPU seconds divided by those of the floor.
    - ``stages``, ``stages_cpu``: our wall and CPU seconds by stage, of the same unit, and before the first (``start``,
      most of it imports). The last one has the report and the end. A job of a campaign does not tell its stages.
    - ``frames``: per pick-and-place, ours and theirs.

    Args:
        quick: one episode instead of three, no long run and no campaign.
    """
    Library.load().entries()
    compileall.compile_dir(Path(vcage.__file__).parent, quiet=1)  # also where PYTHONDONTWRITEBYTECODE is set
    half = 3 if quick else 7
    before = [_maniskill(half, shaders) for shaders in SHADERS]
    with tempfile.TemporaryDirectory() as folder:
        ours = {"": _vcage(Path(folder) / "short", 1 if quick else 3)}
        if not quick:
            ours |= {"_long": _vcage(Path(folder) / "long", LONG), "_job": _job(Path(folder) / "campaign", LONG)}
    after = [_maniskill(half, shaders) for shaders in SHADERS]
    theirs, fastest = map(_mean, before, after)
    short = ours[""]
    return {
        **{f"{name}{row}": value for row, chain in ours.items() for name, value in chain.figures().items()},
        "maniskill_seconds": round(theirs.wall_s, 2),
        "maniskill_cpu_seconds": round(theirs.cpu_s, 2),
        "maniskill_seconds_minimal": round(fastest.wall_s, 2),
        "maniskill_cpu_seconds_minimal": round(fastest.cpu_s, 2),
        "ratio": round(short.wall_s / theirs.wall_s, 3),
        **{f"cpu_ratio{row}": round(chain.cpu_s / theirs.cpu_s, 3) for row, chain in ours.items()},
        "frames": {"vcage": round(short.frames, 1), "maniskill": round(theirs.frames, 1)},
        "pick_and_places": short.placed,
    }


def _mean(one: Recorded, other: Recorded) -> Recorded:
    """The mean of two measurements of the same number of trajectories."""
    return Recorded(*np.mean([astuple(one), astuple(other)], axis=0).tolist())


def _vcage(folder: Path, episodes: int) -> Chain:
    """Time ``vcage run``, and then its floor."""
    command = [sys.executable, "-m", "vcage.cli.main", "run", INSTRUCTION, "--robot", ROBOT, "--out", str(folder)]
    done = timed([*command, "--episodes", str(episodes), "--models", "offline"])
    if done.code != 0:
        raise VcageError(f"vcage run ended with {done.code}: {done.stdout[-500:]}", hint="run: vcage doctor")
    summary = json.loads(done.stdout.splitlines()[-1])["summary"]
    logger.info("vcage run: %.1f s, %.1f CPU s, %s", done.wall_s, done.cpu_s, summary)
    return _chain(folder, done.wall_s, done.cpu_s, _stages(done))


def _job(folder: Path, episodes: int) -> Chain:
    """Time the second job of a campaign of the same instruction, and then its floor."""
    told = {"tasks": [{"instruction": INSTRUCTION}], "robots": [ROBOT], "options": {"models": "offline"}}
    plan = folder.with_suffix(".yml")
    plan.write_text(json.dumps({"name": "chain", "episodes": 2 * episodes, "episodes_per_job": episodes, **told}))
    command = [sys.executable, "-m", "vcage.cli.main", "campaign", str(plan), "--out", str(folder), "--workers", "1"]
    done = timed(command)
    if done.code != 0:
        raise VcageError(f"vcage campaign ended with {done.code}: {done.stdout[-500:]}", hint="run: vcage doctor")
    campaign = CampaignFolder(folder)
    second = campaign.plan.job(campaign.plan.cells[0], 1)
    record = campaign.record(second)
    assert record is not None, "a campaign that ended well settled all of its jobs"
    logger.info("second job: %.1f s, %.1f CPU s, %d verified", record.seconds, record.cpu_seconds, record.verified)
    return _chain(campaign.run(second).root, record.seconds, record.cpu_seconds, {})


def _chain(folder: Path, wall_s: float, cpu_s: float, stages: dict[str, np.ndarray]) -> Chain:
    """The cost of a run for each pick-and-place of its accepted episodes, and that of its floor."""
    accepted = [e for e in Episodes.read(RunFolder(folder).episodes).episodes if e.accepted]
    placed = sum(len(episode.subtasks) for episode in accepted)
    return Chain(
        wall_s=wall_s / placed,
        cpu_s=cpu_s / placed,
        stages={stage: spent / placed for stage, spent in stages.items()},
        floor={part: spent / placed for part, spent in _floor(folder).items()},
        frames=sum(episode.frames for episode in accepted) / placed,
        placed=placed,
    )


def _stages(done: Timed) -> dict[str, np.ndarray]:
    """Return (2,) wall and CPU seconds of each stage of a run, and of its start."""
    begun = [(match[1], mark) for mark in done.marks if (match := STAGE.fullmatch(mark.line))]
    moments = [(0.0, 0.0), *((mark.wall_s, mark.cpu_s) for _, mark in begun), (done.wall_s, done.cpu_s)]
    names = ["start", *(name for name, _ in begun)]
    return dict(zip(names, np.diff(moments, axis=0), strict=True))


def _floor(folder: Path) -> dict[str, np.ndarray]:
    """Return (2,) wall and CPU seconds of drawing and of encoding the run's videos once, and of their process's start.

    Raises:
        VcageError: the process ended with an error.
    """
    done = timed([sys.executable, "-m", "benchmarks._floor", str(folder)])
    if done.code != 0:
        raise VcageError(f"drawing and encoding again ended with {done.code}: {done.stdout[-500:]}")
    spent = {part: np.array(seconds) for part, seconds in json.loads(done.stdout.splitlines()[-1]).items()}
    return spent | {"start": np.array([done.wall_s, done.cpu_s]) - sum(spent.values())}


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
