"""A real campaign of three jobs through the command, undisturbed and killed at a random moment: the same files.

``python -m benchmarks campaign_kills`` and ``make test-ray`` kill more often.
"""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import psutil
import pytest
import yaml

from tests.run_folders import REPOSITORY, clean_environment, command, digests, process
from vcage.base.leftovers import PARTIAL
from vcage.schema.compression import Compression

PROGRAM: list[str | Path] = [sys.executable, "-m", "vcage.cli.main"]

TASKS = [{"id": "apple", "instruction": "Put the apple into the bowl"}]
QUICK = {"models": "offline", "fps": 5, "effort": "fast", "keyframes": 2}

TIMES = ("seconds", "cpu_seconds", "memory_bytes", "tries", "ended")
"""Fields of a job's record that tell how long it took, and how often it was interrupted."""


def campaign(plan: Path, out: Path) -> list[str | Path]:
    return [*PROGRAM, "campaign", plan, "--out", out, "--workers", "2"]


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("plan") / "PLAN.yml"
    keys = {"name": "three-jobs", "tasks": TASKS, "episodes": 3, "episodes_per_job": 1}
    path.write_text(yaml.safe_dump(keys | {"limits": {"tries": 20}, "options": QUICK}))
    return path


@pytest.fixture(scope="module")
def undisturbed(plan: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("undisturbed") / "campaign"
    done = process(campaign(plan, out), REPOSITORY)
    assert done.code == 0, done.record
    assert (done.record["summary"]["verified"], done.record["summary"]["jobs"]) == (3, {"done": 3})
    assert (out / "status.html").exists()
    return out


def files_of(out: Path) -> dict[str, Any]:
    """The output of a campaign, without times: path → hash of each file of its runs, and the records of its jobs."""
    made: dict[str, Any] = {
        name: digest
        for name, digest in digests(out / "jobs").items()
        if not name.endswith((".beat", ".job.json")) and PARTIAL not in name
    }
    for path in out.glob("jobs/*/*.job.json"):
        record = {key: value for key, value in json.loads(path.read_text()).items() if key not in TIMES}
        record["bytes"] = None  # of by-products with times, too
        made[path.name + path.parent.name] = record
    return made


@pytest.mark.slow
def test_a_campaign_that_has_ended_does_nothing_when_it_is_started_again(plan: Path, undisturbed: Path, capsys):
    before = {path: path.stat().st_mtime_ns for path in undisturbed.glob("jobs/**/*")}
    done = command(capsys, "campaign", plan, "--out", undisturbed, "--workers", "2")
    assert (done.code, done.record["summary"]["verified"]) == (0, 3)
    assert {path: path.stat().st_mtime_ns for path in undisturbed.glob("jobs/**/*")} == before


@pytest.mark.slow
def test_jobs_begin_at_the_crfs_of_the_first_one_and_their_records_say_so(undisturbed: Path):
    first, *others = [Compression.read(path) for path in sorted(undisturbed.glob("jobs/*/*/compress/compression.json"))]
    found = {camera.camera: camera.crf for camera in first.cameras}
    assert first.taken_crfs == [] and len(others) == 2
    for record in others:
        assert {one.camera: one.crf for one in record.taken_crfs} == found
        assert {one.run for one in record.taken_crfs} == {"../0000"}
        assert [one.passed for one in record.taken_crfs] == [one.crf == found[one.camera] for one in record.cameras]


@pytest.mark.slow
def test_a_campaign_that_is_killed_at_a_random_moment_ends_with_the_same_files(
    plan: Path, undisturbed: Path, tmp_path: Path
):
    out, moments = tmp_path / "campaign", random.Random(7)
    running = subprocess.Popen(
        list(map(str, campaign(plan, out))),
        cwd=REPOSITORY,
        env=clean_environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    with pytest.raises(subprocess.TimeoutExpired):
        running.wait(moments.uniform(3.0, 8.0))
    _kill(running, moments)
    done = process(campaign(plan, out), REPOSITORY)
    assert done.code == 0, done.record
    assert files_of(out) == files_of(undisturbed)
    assert not [path for path in out.rglob(f"*{PARTIAL}*") if path.is_file()]


def _kill(running: subprocess.Popen[bytes], moments: random.Random) -> None:
    """Kill a worker, if there is one, and then the whole driver, by SIGKILL."""
    children = psutil.Process(running.pid).children(recursive=True)
    workers = [child for child in children if not child.children()]
    if workers:
        os.kill(moments.choice(workers).pid, signal.SIGKILL)
        time.sleep(0.5)
    running.kill()
    running.wait()
    psutil.wait_procs(workers, timeout=20)
