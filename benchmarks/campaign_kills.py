"""Kill processes of campaigns of each driver at random moments; count jobs lost or run twice, and differing files."""

from __future__ import annotations

import argparse
import importlib.util
import logging
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks._campaign_kills import PROGRAM, STUBBED, KilledCampaign, Settled, write_plan
from benchmarks._campaign_outputs import differing, left_over, outputs
from benchmarks._ray_nodes import RayNodes
from vcage.base.errors import VcageError

logger = logging.getLogger(__name__)

DRIVERS: dict[str, list[list[str]]] = {
    "processes": [["--workers", "2"]],
    "shards": [["--workers", "1", "--shard", "0/2"], ["--workers", "1", "--shard", "1/2"]],
    "ray": [[]],
}
"""Driver → the options of its commands."""


@dataclass(frozen=True)
class Settings:
    """Settings of the kills.

    Args:
        look_every_s: between two looks at processes and records.
        most_calls: of a driver's command in one campaign; with more, it makes no progress.
        longest_s: of one campaign; one that takes longer hangs.
    """

    look_every_s: float = 0.1
    most_calls: int = 60
    longest_s: float = 3000.0


SETTINGS = Settings()

COUNTS = ("kills", "hit", "resumed", "lost", "twice", "differing", "left")
"""Columns of the table."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of this benchmark."""
    parser.add_argument("--jobs", type=int, default=40, help="jobs of a campaign (default: %(default)s; quick: 4)")
    parser.add_argument("--kills", type=int, default=34, help="of each driver (default: %(default)s; quick: 3)")
    parser.add_argument("--seed", type=int, default=0, help="of the moments and victims (default: %(default)s)")
    parser.add_argument(
        "--gap",
        type=float,
        help="mean seconds between two kills (default: those of the campaign without any, shared out among kills)",
    )
    parser.add_argument(
        "--stubbed", action="store_true", help="jobs that wait for 2 s and write counts, in place of the chain"
    )
    parser.add_argument(
        "--drivers", nargs="+", choices=DRIVERS, default=[*DRIVERS], help="which (default: all that are installed)"
    )


def run(
    quick: bool, jobs: int, kills: int, seed: int, drivers: list[str], gap: float | None, stubbed: bool
) -> dict[str, Any]:
    """Kill processes of campaigns by SIGKILL, and go on by the same commands until the campaign has ended.

    Victims are drawn:

    - ``worker``: a process that runs a job, of the driver or an actor of Ray;
    - ``driver``: a process that shares jobs out;
    - ``node``: with Ray, all processes of a node at once;
    - ``head``: with Ray, the server of its head.

    A campaign that ends before all kills were made is followed by another one of the same plan. Figures of each row, by
    driver and victim:

    - ``kills``; ``hit``, jobs that ran in the killed processes;
    - ``resumed``, those of them that were done in the end, and ``lost``, the others;
    - ``twice``, those that were settled more than once;
    - ``differing``, their files that differ from those of an undisturbed campaign of the same plan, except for times.

    The row ``all`` of a driver counts all jobs of its campaigns; ``left`` are files of partial work that stayed.

    Args:
        quick: few jobs and kills.
        jobs: of a campaign.
        kills: of each driver.
        seed: of moments and victims.
        drivers: which of :data:`DRIVERS`.
        gap: mean seconds between two kills; by default those of an undisturbed campaign, shared out among kills.
        stubbed: run the stub of the tests in place of the chain.
    """
    if quick:
        jobs, kills = 4, 3
    left_out = [name for name in drivers if name == "ray" and importlib.util.find_spec("ray") is None]
    rng, start, done = np.random.default_rng(seed), time.monotonic(), list[Series]()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so that processes and folders are cleaned up
    program = STUBBED if stubbed else PROGRAM
    with tempfile.TemporaryDirectory(prefix="kills-") as folder:
        plan = write_plan(Path(folder), jobs)
        undisturbed = Undisturbed.made(plan, begun(Path(folder) / "undisturbed"), program)
        logger.info("undisturbed: %d jobs in %.0f s", jobs, undisturbed.seconds)
        for driver in drivers:
            if driver not in left_out:
                series = Series(driver, plan, begun(Path(folder) / driver), undisturbed, program)
                series.make(kills, gap or undisturbed.seconds / kills, rng)
                done.append(series)
                for row in series.rows():
                    logger.info("%s", row)
                shutil.rmtree(Path(folder) / driver)
    return {
        **_figures(done),
        "jobs": jobs,
        "stubbed": stubbed,
        "seconds_undisturbed": round(undisturbed.seconds, 1),
        "seconds": round(time.monotonic() - start, 1),
        "left_out": left_out,
    }


def _figures(done: Sequence[Series]) -> dict[str, Any]:
    """The table of all drivers, and its sums."""
    rows = [row for series in done for row in series.rows()]
    whole = [row for row in rows if row["victim"] == "all"]
    return {
        **{key: sum(row[key] for row in whole) for key in ("kills", "lost", "twice", "differing")},
        "rows": rows,
        "campaigns": {series.driver: series.campaigns for series in done},
        "files": sorted({name for series in done for name in series.files}),
        "left": [name for series in done for name in series.left],
        "errors": [error for series in done for error in series.errors],
    }


def begun(folder: Path) -> Path:
    """A new folder, in which stubbed jobs are slow."""
    folder.mkdir(parents=True)
    (folder / "behaviour.json").write_text('{"all": "slow"}', encoding="utf-8")
    return folder


@dataclass(frozen=True)
class Undisturbed:
    """A campaign without kills: its files, the states of its jobs, and its duration."""

    outputs: dict[str, Any]
    states: dict[str, str]
    seconds: float

    @classmethod
    def made(cls, plan: Path, folder: Path, program: Sequence[str] = PROGRAM) -> Undisturbed:
        """Run a campaign to its end.

        Raises:
            VcageError: it failed.
        """
        out, start = folder / "campaign", time.monotonic()
        campaign = KilledCampaign(plan, out, DRIVERS["processes"], program=program)
        campaign.start()
        while campaign.look():
            time.sleep(SETTINGS.look_every_s)
        if campaign.complaints:
            raise VcageError(f"the undisturbed campaign failed: {campaign.complaints}")
        return cls(outputs(out), Settled(out).states(), time.monotonic() - start)


@dataclass(frozen=True)
class Kill:
    """A kill: its victim, and the jobs that ran there."""

    victim: str
    jobs: list[str]


@dataclass
class Series:
    """Kills of one driver, in as many campaigns as it takes.

    Args:
        driver: of :data:`DRIVERS`.
        plan: its file.
        folder: in which the campaigns lie.
        undisturbed: the campaign to compare with.
        program: whose command ``campaign`` is run.
    """

    driver: str
    plan: Path
    folder: Path
    undisturbed: Undisturbed
    program: Sequence[str] = PROGRAM
    campaigns: int = 0
    files: set[str] = field(default_factory=set)
    """Files that differed from those of the undisturbed campaign."""
    left: list[str] = field(default_factory=list)
    """Files of partial work that stayed."""
    errors: list[str] = field(default_factory=list)
    """The last lines of commands that ended unexpectedly."""
    _rows: dict[str, dict[str, int]] = field(default_factory=dict)

    def make(self, kills: int, gap_s: float, rng: np.random.Generator) -> None:
        """Make a number of kills, with a mean time between two of them."""
        with ExitStack() as stack:
            nodes = stack.enter_context(RayNodes()) if self.driver == "ray" else None
            made = 0
            while made < kills:
                out = self.folder / f"campaign-{self.campaigns}"
                self.campaigns += 1
                campaign = KilledCampaign(self.plan, out, DRIVERS[self.driver], nodes, self.program)
                settled = Settled(out)
                stack.callback(campaign.end)
                found = []
                for kill in self._kills(campaign, settled, kills - made, gap_s, rng):
                    found.append(kill)
                    made += 1
                    logger.info("%s: kill %d of %d: %s, %s", self.driver, made, kills, kill.victim, kill.jobs)
                self._count(out, found, settled)

    def rows(self) -> list[dict[str, Any]]:
        """The table of this driver."""
        return [{"driver": self.driver, "victim": victim, **row} for victim, row in self._rows.items()]

    def _kills(
        self, campaign: KilledCampaign, settled: Settled, most: int, gap_s: float, rng: np.random.Generator
    ) -> Iterator[Kill]:
        """Run a campaign to its end, and kill meanwhile; yields each kill."""
        start, calls, made = time.monotonic(), 1, 0
        due, victim = start + rng.uniform(0, 2 * gap_s), campaign.drawn(rng)
        campaign.start()
        while calls <= SETTINGS.most_calls and time.monotonic() - start < SETTINGS.longest_s:
            time.sleep(SETTINGS.look_every_s)
            settled.look()
            if made < most and time.monotonic() >= due and (jobs := campaign.kill(victim, rng)) is not None:
                made += 1
                yield Kill(victim, jobs)
                due, victim = time.monotonic() + rng.uniform(0, 2 * gap_s), campaign.drawn(rng)
            if not campaign.look():
                if settled.states().keys() >= self.undisturbed.states.keys():
                    break
                calls += 1
                campaign.start()
        else:
            self.errors.append(f"campaign {self.campaigns} did not end in {calls} calls: {campaign.complaints[-3:]}")
        self.errors += campaign.unexpected
        campaign.end()

    def _count(self, out: Path, kills: list[Kill], settled: Settled) -> None:
        """Compare a campaign with the undisturbed one."""
        settled.look()
        done = {job for job, state in settled.states().items() if state == "done"}
        files = differing(self.undisturbed.outputs, outputs(out))
        self.files |= set(files)
        for kill in kills:
            self._add(kill.victim, 1, kill.jobs, done, settled.twice, files)
        self._add("all", len(kills), [*self.undisturbed.states], done, settled.twice, files)
        left = left_over(out)
        self._rows["all"]["left"] += len(left)
        self.left += left

    def _add(self, victim: str, kills: int, jobs: list[str], done: set[str], twice: set[str], files: list[str]) -> None:
        row = self._rows.setdefault(victim, dict.fromkeys(COUNTS, 0))
        row["kills"] += kills
        row["hit"] += len(jobs)
        row["resumed"] += sum(job in done for job in jobs)
        row["lost"] += sum(job not in done for job in jobs)
        row["twice"] += sum(job in twice for job in jobs)
        row["differing"] += sum(name.startswith(tuple(f"{job}/" for job in jobs)) for name in files)
