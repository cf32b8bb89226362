"""Memory of a worker over its episodes, CPU seconds of Ray beside the jobs, and times of compression."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from benchmarks import campaign as campaign_benchmark
from benchmarks._campaign_memory import growth
from benchmarks.campaign import ray_overheads
from tests.campaigns.stubbed import begun
from vcage.campaigns.plan import Plan
from vcage.campaigns.record import JobRecord


def record(number: int, memory_mb: float, tried: int = 5) -> JobRecord:
    counts = {"episodes": 5, "asked": 5, "verified": 4, "tried": tried, "tries": 1}
    memory = round(memory_mb * 1e6)
    return JobRecord(cell="cell", number=number, seed=0, state="done", host="", ended="", memory_bytes=memory, **counts)


def test_memory_that_grows_with_each_episode_has_that_slope():
    found = growth([record(n, 400 + 5 * n * 0.5) for n in range(6)])
    assert found["mb_per_episode"] == pytest.approx(0.5, abs=0.001)
    assert (found["mb"][0], found["mb"][-1], found["verified"], found["tried"]) == (400, 412, 24, 30)


def test_what_a_process_loads_in_its_first_jobs_is_no_growth():
    found = growth([record(0, 100), record(1, 300), *(record(n, 400) for n in range(2, 8))])
    assert (found["mb_per_episode"], found["mb_per_episode_error"]) == pytest.approx((0, 0), abs=0.001)


def test_growth_is_that_of_an_episode_where_jobs_have_tried_different_numbers():
    tried = [5, 5, 5, 10, 5, 20]
    found = growth([record(n, 400 + sum(tried[:n]), one) for n, one in enumerate(tried)])
    assert found["mb_per_episode"] == pytest.approx(1.0, abs=0.001)


def test_jobs_that_took_longer_with_ray_do_not_count_as_its_own():
    processes = {"driver": "processes", "workers": 1, "cpu_seconds": 200.0, "other_cpu_s": 8.0}
    ray = {"driver": "ray", "workers": 1, "cpu_seconds": 230.0, "other_cpu_s": 18.0}
    assert ray_overheads([processes, ray, ray | {"workers": 2}]) == {1: (10.0, 0.05)}


def test_the_campaign_is_of_one_robot_whichever_is_the_default(tmp_path: Path):
    path = campaign_benchmark._plan(tmp_path, campaign_benchmark.SHORT, "dual_panda", 2, 5, {"models": "offline"})
    plan = Plan.load(path)
    assert [cell.robot for cell in plan.cells] == ["dual_panda"] and len(plan.jobs()) == 2


@pytest.mark.parametrize(
    ("compressed", "expected"),
    [((0, 1, 2), (1.0, 2.5)), ((0,), (1.0, None)), ((1, 2), (None, None)), ((), (None, None))],
)
def test_times_of_compression_are_known_where_the_first_job_compressed_something(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, compressed: tuple[int, ...], expected: Any
):
    folder = begun(tmp_path, episodes=3)
    for number in compressed:
        run = folder.run(folder.plan.jobs()[number])
        run.compression.parent.mkdir(parents=True)
        run.compression.touch()
        run.timings.write_text(json.dumps({"compress": 1.0 + number}))
    monkeypatch.setattr(campaign_benchmark.Compression, "read", lambda _path: SimpleNamespace(taken_crfs=[]))
    found = campaign_benchmark._compression(folder)
    assert (found["first_compress_s"], found["later_compress_s"]) == expected
