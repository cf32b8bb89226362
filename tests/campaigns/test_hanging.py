"""A job hangs when it takes no step for too long, whatever the clocks say."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from tests.campaigns.stubbed import begun
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.hanging import HangWatch, silence_limit
from vcage.campaigns.plan import Job


class Clock:
    """A monotonic clock that a test sets."""

    def __init__(self) -> None:
        self.now = 1000.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    found = Clock()
    monkeypatch.setattr(time, "monotonic", found)
    return found


@pytest.fixture
def folder(tmp_path: Path) -> CampaignFolder:
    return begun(tmp_path, options={"episode_limit": 100})


@pytest.fixture
def job(folder: CampaignFolder) -> Job:
    found = folder.plan.jobs()[0]
    with folder.held(found):
        return found


def test_a_job_hangs_after_longer_than_its_longest_step(clock: Clock, folder: CampaignFolder, job: Job):
    limit = silence_limit(folder.plan)
    assert limit == 210.0
    watch = HangWatch(folder.root)
    assert watch.seconds_left(job, 0.0) == 10.0
    clock.now += limit - 4
    assert watch.seconds_left(job, limit - 4) == 4.0
    clock.now += 5
    assert watch.seconds_left(job, limit + 1) < 0


def test_each_step_gives_a_job_the_whole_time_again(clock: Clock, folder: CampaignFolder, job: Job):
    watch, elapsed = HangWatch(folder.root), 0.0
    for step in range(10):
        os.utime(folder.beat_file(job), ns=(step, step))
        assert watch.seconds_left(job, elapsed) > 0
        clock.now += 200.0
        elapsed += 200.0


@pytest.mark.parametrize("jump_s", [-86400.0, 86400.0])
def test_a_clock_that_jumps_ends_no_job(clock: Clock, folder: CampaignFolder, job: Job, jump_s: float):
    watch = HangWatch(folder.root)
    watch.seconds_left(job, 0.0)
    clock.now += 100.0
    beat = time.time() + jump_s
    os.utime(folder.beat_file(job), (beat, beat))
    assert watch.seconds_left(job, 100.0) > 0
    clock.now += 211.0
    assert watch.seconds_left(job, 311.0) < 0


def test_another_try_of_a_job_starts_with_the_whole_time(clock: Clock, folder: CampaignFolder, job: Job):
    watch = HangWatch(folder.root)
    watch.seconds_left(job, 0.0)
    clock.now += 211.0
    assert watch.seconds_left(job, 211.0) < 0
    assert watch.seconds_left(job, 0.0) > 0


def test_a_plan_may_limit_the_seconds_of_a_try(clock: Clock, tmp_path: Path):
    (tmp_path / "other").mkdir()
    folder = begun(tmp_path / "other", limits={"seconds": 30})
    found = folder.plan.jobs()[0]
    watch = HangWatch(folder.root)
    assert watch.seconds_left(found, 25.0) == 5.0
    assert watch.seconds_left(found, 31.0) < 0
