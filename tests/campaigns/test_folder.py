"""The folder of a campaign: jobs that failed are forgotten, so that they are tried again."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.campaigns.stubbed import TASKS, began, begun, behave, plan, run_stubbed
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.shard import Shard
from vcage.campaigns.status import status_of
from vcage.schema.robot import DEFAULT_ROBOT


def test_retry_tries_failed_jobs_again(tmp_path: Path):
    folder = begun(tmp_path, episodes=1)
    behave(tmp_path, all="fail")
    run_stubbed(folder.root, folder.plan.jobs()[0])
    assert folder.forget_failed() == 1
    behave(tmp_path)
    assert run_stubbed(folder.root, folder.plan.jobs()[0]).record is not None


def test_a_retry_of_shards_tries_each_job_again_once(tmp_path: Path):
    folder = begun(tmp_path, episodes=4)
    behave(tmp_path, all="fail")
    jobs = folder.plan.jobs()
    for job in jobs:
        run_stubbed(folder.root, job)
    for index in range(2):
        assert folder.forget_failed(Shard(index, 2)) == 2
        for job in jobs[index::2]:
            run_stubbed(folder.root, job)
    assert [began(tmp_path).count(job.id) for job in jobs] == [2] * 4


def test_a_retry_takes_nothing_from_a_process_that_has_begun_or_settled_a_job(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    folder = begun(tmp_path, episodes=2)
    behave(tmp_path, all="fail")
    first, second = folder.plan.jobs()
    for job in (first, second):
        run_stubbed(folder.root, job)
    known = list(folder.records())
    folder.record_file(first).unlink()
    behave(tmp_path)
    run_stubbed(folder.root, first)
    monkeypatch.setattr(folder, "records", lambda: iter(known))
    with CampaignFolder(folder.root).held(second):
        assert folder.forget_failed() == 0
    assert [path.exists() for path in map(folder.record_file, (first, second))] == [True, True]


def test_a_retry_forgets_tries_that_a_killed_process_left_beside_the_record(tmp_path: Path):
    folder = begun(tmp_path, episodes=1, limits={"tries": 2})
    behave(tmp_path, all="raise")
    (job,) = folder.plan.jobs()
    run_stubbed(folder.root, job)
    left = folder.tries(job)
    run_stubbed(folder.root, job)
    folder.note_tries(job, left.model_copy(update={"count": 2, "total": 2}))
    assert status_of(folder).open == []
    assert folder.forget_failed() == 1
    behave(tmp_path)
    record = run_stubbed(folder.root, job).record
    assert record is not None and (record.state, record.tries) == ("done", 1)


def test_what_a_process_left_that_was_killed_while_it_wrote_the_plan_is_removed(tmp_path: Path):
    folder = begun(tmp_path)
    (left := folder.root / "plan.partial-99999999.yml").write_text("name: half")
    folder.begin(folder.plan)
    assert not left.exists() and folder.plan_file.exists()


def test_a_campaign_names_its_robot_where_its_plan_does_not(tmp_path: Path):
    assert begun(tmp_path).plan.robots == (DEFAULT_ROBOT,)


def test_a_campaign_goes_on_with_its_robots_where_the_plan_names_none(tmp_path: Path):
    other = next(robot for robot in ("dual_panda", "aloha_agilex") if robot != DEFAULT_ROBOT)
    folder = begun(tmp_path, robots=[other])
    more = [*TASKS, {"id": "cup", "instruction": "Put the cup on the plate"}]
    folder.begin(plan(tmp_path, tasks=more))
    assert [cell.robot for cell in folder.plan.cells] == [other, other]
