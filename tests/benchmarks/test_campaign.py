"""The memory of a worker as a line over the episodes that it has run, and what Ray takes beside the jobs."""

from __future__ import annotations

import pytest

from benchmarks._campaign_memory import growth
from benchmarks.campaign import ray_overheads
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
