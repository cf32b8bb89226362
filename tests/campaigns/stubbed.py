"""A chain that only writes its counts, for tests of what drivers and jobs do around it."""

from __future__ import annotations

import importlib
import json
import os
import shutil
import signal
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any
from unittest import mock

import yaml

from tests.example_scenes import subtask
from vcage.base.errors import DiskFull, NoRenderer, UsageError
from vcage.base.files import RunFolder
from vcage.campaigns import job as job_module
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.job import Outcome, run_job
from vcage.campaigns.plan import Job, Plan
from vcage.runs.running import at_work
from vcage.schema.base import Provenance
from vcage.schema.episodes import CriticCounts, Episode, Episodes
from vcage.schema.subtasks import Chain, Subtasks

TASKS = [{"id": "blocks", "instruction": "Put two blocks on the plate"}]

GIVEN_CRF = {"crf": 20}
"""Options with which no job waits for the first one of its cell."""


def begun(root: Path, **keys: Any) -> CampaignFolder:
    """A campaign of one task in a new folder."""
    folder = CampaignFolder(root / "campaign")
    folder.begin(plan(root, **keys))
    return folder


def plan(root: Path, **keys: Any) -> Plan:
    """A plan as a user writes it."""
    path = root / "PLAN.yml"
    usual = {"name": "test", "tasks": TASKS, "episodes": 2, "episodes_per_job": 1, "options": GIVEN_CRF}
    path.write_text(yaml.safe_dump(usual | keys))
    return Plan.load(path)


def behave(root: Path, **modes: str) -> None:
    """Let the jobs of a campaign behave in some way: the job's number, or ``all`` → a word of :data:`WAYS`."""
    (root / "behaviour.json").write_text(json.dumps(modes))


def run_stubbed(root: Path, job: Job) -> Outcome:
    """:func:`run_job` with the stub in place of the chain."""
    modes = (
        json.loads((root.parent / "behaviour.json").read_text()) if (root.parent / "behaviour.json").exists() else {}
    )
    way = WAYS[modes.get(f"n{job.number}", modes.get("all", "verify"))]

    def chain(run: RunFolder, options: Any, _context: Any, show: Callable[[str], Any]) -> None:
        with at_work(run), show("collect") as progress:
            with open(root.parent / "began.log", "a") as log:
                log.write(f"{job.id} {options.seed}\n")
            way(run, options, progress)

    with mock.patch.object(job_module, "run_chain", chain):
        return run_job(root, job)


def began(root: Path) -> list[str]:
    """The jobs whose chain began, in order, by their ids."""
    path = root / "began.log"
    return [line.split()[0] for line in path.read_text().splitlines()] if path.exists() else []


def record_episodes(run: RunFolder, verified: int, rejected: int) -> None:
    """Write what collect leaves, as far as a job reads it."""
    provenance = Provenance(producer="collect", seed=0)
    step = subtask()
    chain = Chain(subtasks=[step.id], text=step.text)
    Subtasks(
        provenance=provenance, instruction="Place it.", candidates=1, kept=[step], refused=[], chains=[chain]
    ).write(run.subtasks)
    episodes = [
        Episode(index=n, seed=n, accepted=n < verified, reason="" if n < verified else "it fell", fps=10)
        for n in range(verified + rejected)
    ]
    pairs = [(True, True)] * verified + [(False, False)] * rejected
    Episodes(
        provenance=provenance,
        instruction="Place it.",
        chains=[chain],
        episodes=episodes,
        attempts=len(episodes),
        acceptance={},
        critic=CriticCounts.of(pairs),
    ).write(run.episodes)


def _verify(run: RunFolder, options: Any, _progress: Any) -> None:
    record_episodes(run, options.episodes, 0)


def _half(run: RunFolder, options: Any, _progress: Any) -> None:
    record_episodes(run, options.episodes, options.episodes)


def _reject(run: RunFolder, options: Any, _progress: Any) -> None:
    record_episodes(run, 0, 3 * options.episodes)


def _fail(*_: Any) -> None:
    raise UsageError("no such thing", hint="name another")


def _crash(*_: Any) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def _raise(*_: Any) -> None:
    raise ZeroDivisionError("division by zero")


def _full(*_: Any) -> None:
    raise DiskFull("no space left to write it", hint="free some")


def _fill(run: RunFolder, options: Any, _progress: Any, spare_bytes: int = 8_000_000) -> None:
    """Fill the disk to its last byte, unless it has room to spare."""
    (run.root / "place").mkdir(exist_ok=True)
    with open(run.root / "place" / "source.png", "wb") as picture:
        while shutil.disk_usage(run.root).free < spare_bytes:
            picture.write(b"a" * 65536)
            picture.flush()
        picture.truncate(0)
    record_episodes(run, options.episodes, 0)


def _lack(run: RunFolder, options: Any, progress: Any) -> None:
    """Lack a renderer on the node of a Ray cluster that a file beside the campaign names."""
    node = importlib.import_module("ray").get_runtime_context().get_node_id()
    if node == (run.root.parents[3] / "bare-node").read_text():
        raise NoRenderer("no Vulkan driver draws a picture")
    _slow(run, options, progress)


def _hang(*_: Any) -> None:
    time.sleep(600)


def _slow(run: RunFolder, options: Any, progress: Any) -> None:
    for step in range(8):
        time.sleep(0.25)
        progress("step", step, 8)
    record_episodes(run, options.episodes, 0)


def _jump(run: RunFolder, options: Any, progress: Any, by_s: float) -> None:
    """Take steps on a machine whose clock jumps meanwhile, and with it the times of its files."""
    clock, touch = time.time, os.utime
    for step in range(8):
        time.sleep(0.25)
        off = by_s if step >= 4 else 0.0
        with (
            mock.patch.object(time, "time", lambda off=off: clock() + off),
            mock.patch.object(os, "utime", lambda path, off=off: touch(path, (clock() + off, clock() + off))),
        ):
            progress("step", step, 8)
            if step == 7:
                record_episodes(run, options.episodes, 0)


def _get_further(run: RunFolder, options: Any, _progress: Any) -> None:
    """Leave a file, and end the process until there are three."""
    folder = run.root / "place"
    folder.mkdir(exist_ok=True)
    count = len(list(folder.iterdir()))
    if count == 3:
        record_episodes(run, options.episodes, 0)
        return
    (folder / f"{count}.png").touch()
    os.kill(os.getpid(), signal.SIGKILL)


WAYS: dict[str, Callable[..., None]] = {
    "verify": _verify,
    "half": _half,
    "reject": _reject,
    "fail": _fail,
    "crash": _crash,
    "raise": _raise,
    "full": _full,
    "fill": _fill,
    "lack": _lack,
    "hang": _hang,
    "slow": _slow,
    "get_further": _get_further,
    "jump_ahead": partial(_jump, by_s=86400.0),
    "jump_back": partial(_jump, by_s=-86400.0),
}
