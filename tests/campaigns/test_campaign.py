"""A real campaign of two jobs through the command, undisturbed and killed at a random moment: the same files.

``python -m benchmarks campaign_kills`` and ``make test-ray`` kill more often.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

from benchmarks._campaign_kills import STUBBED, Settled, write_plan
from benchmarks._campaign_outputs import outputs
from benchmarks.campaign_kills import Series, Undisturbed, begun
from tests.run_folders import REPOSITORY, command, process
from vcage.schema.compression import Compression

PROGRAM: list[str | Path] = [sys.executable, "-m", "vcage.cli.main"]

TASKS = [{"id": "apple", "instruction": "Put the apple into the bowl"}]
QUICK = {"models": "offline", "fps": 5, "effort": "fast", "keyframes": 2}


def campaign(plan: Path, out: Path) -> list[str | Path]:
    return [*PROGRAM, "campaign", plan, "--out", out, "--workers", "2"]


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("plan") / "PLAN.yml"
    keys = {"name": "two-jobs", "tasks": TASKS, "episodes": 2, "episodes_per_job": 1}
    path.write_text(yaml.safe_dump(keys | {"limits": {"tries": 20}, "options": QUICK}))
    return path


@pytest.fixture(scope="module")
def undisturbed(plan: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("undisturbed") / "campaign"
    done = process(campaign(plan, out), REPOSITORY)
    assert done.code == 0, done.record
    assert (done.record["summary"]["verified"], done.record["summary"]["jobs"]) == (2, {"done": 2})
    assert (out / "status.html").exists()
    return out


@pytest.mark.slow
def test_a_campaign_that_has_ended_does_nothing_when_it_is_started_again(plan: Path, undisturbed: Path, capsys):
    before = {path: path.stat().st_mtime_ns for path in undisturbed.glob("jobs/**/*")}
    done = command(capsys, "campaign", plan, "--out", undisturbed, "--workers", "2")
    assert (done.code, done.record["summary"]["verified"]) == (0, 2)
    assert {path: path.stat().st_mtime_ns for path in undisturbed.glob("jobs/**/*")} == before


@pytest.mark.slow
def test_jobs_begin_at_the_crfs_of_the_first_one_and_their_records_say_so(undisturbed: Path):
    first, *others = [Compression.read(path) for path in sorted(undisturbed.glob("jobs/*/*/compress/compression.json"))]
    found = {camera.camera: camera.crf for camera in first.cameras}
    assert first.taken_crfs == [] and len(others) == 1
    for record in others:
        assert {one.camera: one.crf for one in record.taken_crfs} == found
        assert {one.run for one in record.taken_crfs} == {"../0000"}
        assert [one.passed for one in record.taken_crfs] == [one.crf == found[one.camera] for one in record.cameras]


@pytest.mark.slow
def test_a_real_campaign_that_is_killed_at_a_random_moment_ends_with_the_same_files(
    plan: Path, undisturbed: Path, tmp_path: Path
):
    states = Settled(undisturbed).states()
    series = Series("processes", plan, begun(tmp_path / "series"), Undisturbed(outputs(undisturbed), states, 0.0))
    series.make(1, 6.0, np.random.default_rng(7))
    require_unharmed(series, kills=1)


@pytest.mark.slow
def test_shards_that_are_killed_at_random_moments_lose_nothing_and_make_nothing_twice(tmp_path: Path):
    plan = write_plan(tmp_path, jobs=3)
    undisturbed = Undisturbed.made(plan, begun(tmp_path / "undisturbed"), STUBBED)
    series = Series("shards", plan, begun(tmp_path / "series"), undisturbed, STUBBED)
    series.make(2, 1.0, np.random.default_rng(3))
    require_unharmed(series, kills=2)


def require_unharmed(series: Series, kills: int) -> None:
    found = next(row for row in series.rows() if row["victim"] == "all")
    assert (found["kills"], found["lost"], found["twice"], found["differing"], found["left"]) == (kills, 0, 0, 0, 0)
    assert series.errors == []
