"""The memory of a worker as a line over the episodes that it has run."""

from __future__ import annotations

import pytest

from benchmarks._campaign_memory import growth
from vcage.campaigns.record import JobRecord


def record(number: int, memory_mb: float, tried: int = 5) -> JobRecord:
    counts = {"episodes": 5, "asked": 5, "verified": 4, "tried": tried, "tries": 1}
    memory = round(memory_mb * 1e6)
    return JobRecord(cell="cell", number=number, seed=0, state="done", host="", ended="", memory_bytes=memory, **counts)


def test_memory_that_grows_with_each_episode_has_that_slope():
    found = growth([record(n, 400 + 5 * n * 0.5) for n in range(6)])
    assert found["mb_per_episode"] == pytest.approx(0.5, abs=0.001)
    assert (found["first_mb"], found["last_mb"], found["verified"], found["tried"]) == (400, 412, 24, 30)


def test_the_first_job_of_a_process_does_not_count_as_growth():
    found = growth([record(0, 100), *(record(n, 400) for n in range(1, 6))])
    assert (found["mb_per_episode"], found["mb_per_episode_error"]) == pytest.approx((0, 0), abs=0.001)
    assert found["first_mb"] == 100


def test_growth_is_that_of_an_episode_where_jobs_have_tried_different_numbers():
    found = growth([record(0, 400, 5), record(1, 405, 10), record(2, 415, 5), record(3, 420, 20), record(4, 440, 5)])
    assert found["mb_per_episode"] == pytest.approx(1.0, abs=0.001)
