"""A campaign whose processes are killed: its commands, its victims, and the jobs at work."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import subprocess
import sys
import tempfile
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import psutil
import yaml

from benchmarks._ray_nodes import RayNodes
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.record import read_tries

PLAN = {
    "name": "kills",
    "tasks": [{"id": "block", "goals": ["block on plate"], "objects": "block, plate"}],
    "episodes_per_job": 1,
    "limits": {"tries": 1000},
    "options": {
        "models": "offline",
        "fps": 5,
        "crf": 20,
        "effort": "fast",
        "keyframes": 1,
        "restarts": 1,
        "guard": False,
    },
}
"""Jobs of one episode with a block and a plate, by every stage of the chain."""

PROGRAM = (sys.executable, "-m", "vcage.cli.main")

STUBBED = (sys.executable, "-m", "tests.campaigns.stubbed_command")
"""The same with jobs that only wait, and write their counts."""

WORKER, DRIVER, NODE, HEAD = "worker", "driver", "node", "head"
"""Victims: a process that runs a job, one that shares jobs out, all processes of a Ray node, and the head's server."""


class _Command:
    """A command and its stderr, which lies in a file: a pipe that nobody reads would stop it when it is full."""

    def __init__(self, words: Sequence[str], environment: Mapping[str, str]):
        self._stderr = tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace")  # noqa: SIM115  read at the end
        self.process = subprocess.Popen(
            words, stdout=subprocess.DEVNULL, stderr=self._stderr, cwd=Path(__file__).parents[1], env=environment
        )

    def last_line(self) -> str:
        """The last line of stderr."""
        self._stderr.seek(0)
        return " ".join(deque(self._stderr, maxlen=1)).strip()


@dataclass
class KilledCampaign:
    """The commands of one driver on one campaign, and its processes.

    Args:
        plan: its file.
        out: the folder of the campaign.
        options: of each command; two commands are two shards.
        nodes: of a Ray cluster, for that driver.
        program: whose command ``campaign`` it is.
    """

    plan: Path
    out: Path
    options: Sequence[Sequence[str]]
    nodes: RayNodes | None = None
    program: Sequence[str] = PROGRAM
    complaints: list[str] = field(default_factory=list)
    """The last lines of commands that ended by themselves with an error,"""
    unexpected: list[str] = field(default_factory=list)
    """and of those that no kill explains."""
    _head_lost: bool = False
    _running: dict[int, _Command] = field(default_factory=dict)

    @property
    def victims(self) -> dict[str, float]:
        """Victim → its share of kills."""
        return {WORKER: 0.7, DRIVER: 0.3} if self.nodes is None else {WORKER: 0.5, DRIVER: 0.25, NODE: 0.2, HEAD: 0.05}

    def start(self) -> None:
        """Start those commands that do not run."""
        if self.nodes is not None:
            self.nodes.start()
        address = () if self.nodes is None else ("--ray", self.nodes.address)
        for index, options in enumerate(self.options):
            if index not in self._running:
                self._running[index] = _Command(
                    [*self.program, "campaign", str(self.plan), "--out", str(self.out), *options, *address],
                    os.environ | (self.nodes.environment if self.nodes else {}),
                )

    def look(self) -> bool:
        """Note which commands have ended; True while any runs."""
        for index, command in list(self._running.items()):
            if (code := command.process.poll()) is not None:
                del self._running[index]
                if code:
                    self.complaints.append(f"exit {code}: {command.last_line()}")
                if code not in (0, 7, 6 if self._head_lost else 0):
                    self.unexpected += self.complaints[-1:]
        return bool(self._running)

    def drawn(self, rng: np.random.Generator) -> str:
        """The next victim."""
        return str(rng.choice([*self.victims], p=[*self.victims.values()]))

    def kill(self, victim: str, rng: np.random.Generator) -> list[str] | None:
        """Kill a victim by SIGKILL, and start another where it does not end the command.

        Returns:
            The jobs that it had at work; None if there is no such process now.
        """
        found = self._killed(victim, at_work(self.out), rng)
        if found is not None and victim in (DRIVER, NODE):
            self.start()
        return found

    def _killed(self, victim: str, jobs: dict[str, int], rng: np.random.Generator) -> list[str] | None:
        if victim == WORKER:
            return self._kill_worker(jobs, rng)
        if victim == DRIVER:
            return self._kill_driver(jobs, rng)
        assert self.nodes is not None
        if victim == HEAD:
            self._head_lost = self._head_lost or self.nodes.kill_head()
            return [*jobs] if self._head_lost else None
        killed = self.nodes.kill_node(rng)
        return None if killed is None else [job for job, process in jobs.items() if process in killed]

    def end(self) -> None:
        """Kill the remaining processes."""
        for process in (command.process for command in self._running.values()):
            for one in (*_below(process.pid), process):
                with contextlib.suppress(psutil.NoSuchProcess):
                    one.kill()
            process.wait()
        self._running.clear()

    @staticmethod
    def _kill_worker(jobs: dict[str, int], rng: np.random.Generator) -> list[str] | None:
        if not jobs:
            return None
        job = rng.choice(sorted(jobs))
        with contextlib.suppress(ProcessLookupError):  # it has ended since
            os.kill(jobs[job], signal.SIGKILL)
            return [job]
        return None

    def _kill_driver(self, jobs: dict[str, int], rng: np.random.Generator) -> list[str] | None:
        if not self._running:
            return None
        process = self._running.pop(int(rng.choice(sorted(self._running)))).process
        below = {one.pid for one in _below(process.pid)}
        process.kill()
        process.wait()
        # Actors of a driver that is gone are no processes below it: their jobs are all that are at work.
        return sorted(job for job, number in jobs.items() if self.nodes is not None or number in below)


def at_work(out: Path) -> dict[str, int]:
    """Jobs of a campaign at work → the processes below this one that run them."""
    found = {}
    ours = {one.pid for one in psutil.Process().children(recursive=True)}
    for path in CampaignFolder(out).begun():
        with contextlib.suppress(OSError):
            holder = re.match(r"process (\d+) on ", path.read_text(encoding="utf-8"))
            # A driver that notes the loss of a job holds it for a moment, and leaves its own number there.
            if read_tries(path.with_suffix(".tries.json")).open and holder and int(holder[1]) in ours:
                found[path.relative_to(out / "jobs").with_suffix("").as_posix()] = int(holder[1])
    return found


def _below(number: int) -> list[psutil.Process]:
    try:
        return psutil.Process(number).children(recursive=True)
    except psutil.NoSuchProcess:
        return []


class Settled:
    """Watches the records of jobs for those that are settled more than once.

    Args:
        out: the folder of the campaign.
    """

    def __init__(self, out: Path):
        self._folder = CampaignFolder(out)
        self._seen: dict[str, tuple[int, int]] = {}
        self.twice: set[str] = set()

    def look(self) -> None:
        """Look at all records: one that was replaced was settled twice."""
        for path in self._folder.root.glob("jobs/*/*.job.json"):
            found, job = path.stat(), f"{path.parent.name}/{path.name.removesuffix('.job.json')}"
            mark = found.st_ino, found.st_mtime_ns
            if self._seen.setdefault(job, mark) != mark:
                self._seen[job] = mark
                self.twice.add(job)

    def states(self) -> dict[str, str]:
        """Job → the state in its record."""
        return {record.job_id: record.state for record in self._folder.records()}


def write_plan(folder: Path, jobs: int) -> Path:
    """Write a plan of so many jobs; 8 in a cell, or fewer."""
    cells = next(count for count in range(-(-jobs // 8), jobs + 1) if jobs % count == 0)
    path = folder / "PLAN.yml"
    path.write_text(yaml.safe_dump(PLAN | {"seeds": cells, "episodes": jobs // cells}), encoding="utf-8")
    return path
