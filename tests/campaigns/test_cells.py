"""Jobs of a cell that may begin: gates, limits, and jobs that make up for episodes that were not verified."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.campaigns.stubbed import plan
from vcage.campaigns.cells import Standing, by_cell, standing
from vcage.campaigns.plan import Plan
from vcage.campaigns.record import JobRecord, State


def settled(found: Plan, number: int, verified: int, tried: int, state: State = "done", asked: int = 0) -> JobRecord:
    job = found.job(found.cells[0], number, asked or found.asked_of(number) or None)
    return JobRecord(
        cell=job.cell.id,
        number=number,
        seed=job.seed,
        state=state,
        episodes=job.episodes,
        asked=job.episodes,
        verified=verified,
        tried=tried,
        tries=1,
        host="here",
        ended="2026-01-01T00:00:00+00:00",
    )


def look(found: Plan, *records: JobRecord) -> Standing:
    return standing(found, found.cells[0], {record.number: record for record in records})


def numbers(seen: Standing) -> list[int]:
    return [job.number for job in seen.ready]


def test_without_gates_all_jobs_may_begin_at_once(tmp_path: Path):
    seen = look(plan(tmp_path, episodes=20, episodes_per_job=5))
    assert (numbers(seen), seen.waits, seen.asked) == ([0, 1, 2, 3], False, 20)


@pytest.mark.parametrize("state", ["done", "failed", "given_up"])
def test_the_first_job_goes_ahead_where_crfs_are_searched_and_the_others_follow_however_it_ends(
    tmp_path: Path, state: State
):
    found = plan(tmp_path, episodes=20, episodes_per_job=5, options={})
    assert (numbers(look(found)), look(found).waits) == ([0], True)
    late = settled(found, 2, 5, 5)
    assert (numbers(look(found, late)), look(found, late).waits) == ([0], True)
    seen = look(found, settled(found, 0, 0, 0, state), late)
    assert (numbers(seen), seen.waits) == ([1, 3], False)


def test_a_gate_is_decided_by_the_jobs_after_the_first_too(tmp_path: Path):
    found = plan(tmp_path, episodes=20, episodes_per_job=5, options={}, gates={"acceptance": 0.5, "after": 8})
    assert (numbers(look(found)), look(found).waits) == ([0], True)
    seen = look(found, settled(found, 0, 5, 5))
    assert (numbers(seen), seen.waits) == ([1], True)
    assert numbers(look(found, settled(found, 0, 5, 5), settled(found, 1, 5, 5))) == [2, 3]


def test_a_cell_of_one_job_waits_for_nothing(tmp_path: Path):
    seen = look(plan(tmp_path, episodes=5, episodes_per_job=5, options={}))
    assert (numbers(seen), seen.waits) == ([0], False)


def test_a_gate_lets_the_first_jobs_begin_and_the_others_wait(tmp_path: Path):
    found = plan(tmp_path, episodes=20, episodes_per_job=5, gates={"acceptance": 0.5, "after": 8})
    assert (numbers(look(found)), look(found).waits) == ([0, 1], True)
    seen = look(found, settled(found, 1, 5, 5))
    assert (numbers(seen), seen.waits) == ([0], True)


def test_a_gate_that_is_passed_lets_the_others_begin(tmp_path: Path):
    found = plan(tmp_path, episodes=20, episodes_per_job=5, gates={"acceptance": 0.5, "after": 8})
    seen = look(found, settled(found, 0, 5, 10), settled(found, 1, 5, 10))
    assert (numbers(seen), seen.closed) == ([2, 3], "")


def test_a_cell_below_its_gate_ends_and_says_why(tmp_path: Path):
    found = plan(tmp_path, episodes=20, episodes_per_job=5, gates={"acceptance": 0.5, "after": 8})
    seen = look(found, settled(found, 0, 5, 12), settled(found, 1, 2, 15))
    assert (numbers(seen), seen.ended) == ([], True)
    assert seen.closed == "7 of the first 27 episodes accepted, below the gate of 0.5"


def test_jobs_that_end_in_another_order_change_nothing(tmp_path: Path):
    found = plan(tmp_path, episodes=20, episodes_per_job=5, gates={"acceptance": 0.5, "after": 3})
    late = settled(found, 2, 0, 15)  # of a driver that knew of more than this one
    seen = look(found, settled(found, 0, 5, 6), late)
    assert numbers(seen) == [1, 3]


def test_jobs_follow_until_enough_episodes_are_verified(tmp_path: Path):
    found = plan(tmp_path, episodes=10, episodes_per_job=5, limits={"attempts": 100})
    records = [settled(found, 0, 2, 11), settled(found, 1, 1, 12)]
    assert [(job.number, job.episodes) for job in look(found, *records).ready] == [(2, 5), (3, 2)]
    records += [settled(found, 2, 4, 5), settled(found, 3, 2, 2)]
    assert [(job.number, job.episodes) for job in look(found, *records).ready] == [(4, 1)]
    assert look(found, *records, settled(found, 4, 1, 1)).ended


def test_the_episodes_of_a_following_job_do_not_depend_on_which_of_them_ends_first(tmp_path: Path):
    found = plan(tmp_path, episodes=10, episodes_per_job=5, limits={"attempts": 100})
    records = [settled(found, 0, 2, 11), settled(found, 1, 1, 12)]
    seen = look(found, *records, settled(found, 2, 1, 15))
    assert [(job.number, job.episodes) for job in seen.ready] == [(3, 2)]


def test_no_job_follows_once_the_limit_of_attempts_is_reached(tmp_path: Path):
    found = plan(tmp_path, episodes=10, episodes_per_job=5)
    seen = look(found, settled(found, 0, 0, 15), settled(found, 1, 1, 15))
    assert (numbers(seen), seen.closed) == ([], "30 episodes were run, the most allowed")


def test_a_smaller_limit_lets_jobs_begin_only_where_it_is_sure_to_hold(tmp_path: Path):
    found = plan(tmp_path, episodes=20, episodes_per_job=5, limits={"attempts": 20})
    assert (numbers(look(found)), look(found).waits) == ([0, 1], True)
    seen = look(found, settled(found, 0, 5, 5))
    assert (numbers(seen), seen.waits) == ([1], True)
    seen = look(found, settled(found, 0, 5, 5), settled(found, 1, 5, 5))
    assert (numbers(seen), seen.waits) == ([2], True)
    ended = look(found, settled(found, 0, 5, 5), settled(found, 1, 5, 15))
    assert (numbers(ended), ended.closed) == ([], "20 episodes were run, the most allowed")


def test_jobs_that_run_no_episode_are_not_followed_by_others_for_ever(tmp_path: Path):
    found = plan(tmp_path, episodes=2, episodes_per_job=2)
    records = [settled(found, number, 0, 0, asked=2) for number in range(3)]
    assert look(found, *records).closed == "6 episodes were run, the most allowed"


@pytest.mark.parametrize("state", ["failed", "given_up"])
def test_a_cell_all_of_whose_jobs_fail_ends(tmp_path: Path, state: State):
    found = plan(tmp_path, episodes=10, episodes_per_job=5)
    seen = look(found, settled(found, 0, 0, 0, state), settled(found, 1, 0, 0, state))
    assert (seen.ended, seen.closed) == (True, "all of its 2 jobs failed")


def test_failed_jobs_count_against_a_gate(tmp_path: Path):
    found = plan(tmp_path, episodes=20, episodes_per_job=5, gates={"acceptance": 0.5, "after": 10})
    seen = look(found, settled(found, 0, 0, 0, "failed"), settled(found, 1, 4, 5))
    assert seen.closed.startswith("4 of the first 10 episodes accepted")


def test_a_scene_with_all_its_sub_tasks_gets_no_further_jobs(tmp_path: Path):
    tasks = [{"scene": "office_desk", "all_subtasks": True}]
    found = plan(tmp_path, tasks=tasks, episodes=2, episodes_per_job=1)
    done = settled(found, 0, 4, 9).model_copy(update={"asked": 6})
    seen = look(found, done)
    assert (numbers(seen), seen.asked) == ([1], 7)
    assert look(found, done, settled(found, 1, 0, 3)).ended


def test_a_plan_that_asks_for_more_reopens_jobs_that_collected_fewer(tmp_path: Path):
    small = plan(tmp_path, episodes=7, episodes_per_job=5)
    records = [settled(small, 0, 5, 5), settled(small, 1, 2, 2)]
    grown = plan(tmp_path, episodes=10, episodes_per_job=5)
    known = by_cell(grown, records)[grown.cells[0].id]
    assert list(known) == [0]
    assert [(job.number, job.episodes) for job in standing(grown, grown.cells[0], known).ready] == [(1, 5)]
