"""The loop of all drivers, and the driver in processes of this machine."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections import Counter
from contextlib import ExitStack
from functools import partial
from pathlib import Path

import pytest

from benchmarks._campaign_outputs import outputs
from tests.campaigns.stubbed import began, begun, behave, plan, run_stubbed
from tests.run_folders import REPOSITORY
from vcage.base.errors import (
    ConfigurationError,
    DiskFull,
    FolderInUse,
    InputFileError,
    MissingKey,
    PartlyDone,
    SchemaMismatch,
)
from vcage.base.workers import Processes, SameProcess
from vcage.campaigns.driver import run_here, work_through
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.job import Outcome, lost_job
from vcage.campaigns.plan import Job
from vcage.campaigns.record import JobRecord, Tries
from vcage.campaigns.schedule import LoopSettings, Schedule, left_over
from vcage.campaigns.shard import Shard

ALL = Shard()
QUICK = LoopSettings(machine_tries=2, machine_faults=4, pause_s=0.01)


def driven(folder: CampaignFolder, shard: Shard = ALL) -> Schedule:
    """Run what is left, one job after the other in this process."""
    schedule = Schedule(folder, shard, QUICK)
    work_through(schedule, SameProcess(partial(run_stubbed, folder.root)), 1)
    return schedule


def states(folder: CampaignFolder) -> Counter[str]:
    return Counter(record.state for record in folder.records())


def test_all_jobs_are_run_in_the_order_of_the_plan(tmp_path: Path):
    folder = begun(tmp_path, seeds=2, episodes=3)
    assert left_over(driven(folder)) is None
    assert began(tmp_path) == [job.id for job in folder.plan.jobs()]
    driven(folder)
    assert len(began(tmp_path)) == 6


def test_shards_share_all_jobs_and_no_job_is_run_by_two(tmp_path: Path):
    folder = begun(tmp_path, seeds=3, episodes=4)
    for index in range(4):
        driven(folder, Shard(index, 4))
    assert sorted(began(tmp_path)) == sorted(job.id for job in folder.plan.jobs())


def test_a_shard_says_that_jobs_of_others_are_left(tmp_path: Path):
    folder = begun(tmp_path, seeds=2, episodes=2)
    error = left_over(driven(folder, Shard(0, 2)))
    assert isinstance(error, PartlyDone) and error.retryable
    assert error.message.startswith(f"1 of 2 cells are not finished ({folder.plan.cells[1].id}): ")
    assert error.message.endswith("their jobs are those of other shards, or wait for these")


def test_the_first_jobs_of_all_cells_come_first_and_let_the_others_begin(tmp_path: Path):
    folder = begun(tmp_path, seeds=2, episodes=3, options={})
    assert left_over(driven(folder)) is None
    assert began(tmp_path) == [job.id for job in folder.plan.jobs()]


def test_progress_counts_jobs_that_wait_and_none_of_cells_that_ended(tmp_path: Path):
    folder = begun(tmp_path, episodes=3, options={}, gates={"acceptance": 0.5, "after": 1})
    behave(tmp_path, all="reject")
    schedule = Schedule(folder, settings=QUICK)
    before = schedule.known
    work_through(schedule, SameProcess(partial(run_stubbed, folder.root)), 1)
    assert (before, schedule.known, schedule.settled) == (3, 1, 1)


def test_jobs_begin_where_the_first_of_their_cell_failed(tmp_path: Path):
    folder = begun(tmp_path, episodes=3, options={})
    behave(tmp_path, n0="fail")
    driven(folder)
    assert states(folder) == {"failed": 1, "done": 3}


def test_a_shard_runs_the_first_job_of_another_that_its_own_jobs_wait_for_after_its_own(tmp_path: Path):
    folder = begun(tmp_path, seeds=3, episodes=3, options={})
    driven(folder, Shard(1, 2))
    jobs = [job.id for job in folder.plan.jobs()]
    assert began(tmp_path) == [jobs[place] for place in (1, 7, 0, 3, 2, 5)]


@pytest.mark.parametrize("lost", [False, True])
def test_a_shard_waits_for_a_first_job_that_another_runs_and_takes_it_over_where_that_one_is_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lost: bool
):
    folder = begun(tmp_path, episodes=2, options={})
    first, looks = folder.plan.jobs()[0], []
    holding = ExitStack()
    holding.enter_context(CampaignFolder(folder.root).held(first))

    def sleep(_seconds: float) -> None:
        looks.append(began(tmp_path))
        if len(looks) == 5:
            holding.close()
            if not lost:
                run_stubbed(folder.root, first)

    monkeypatch.setattr("vcage.campaigns.schedule.time.sleep", sleep)
    assert left_over(driven(folder, Shard(1, 2))) is None
    assert looks == [[]] * 5
    assert began(tmp_path) == [job.id for job in folder.plan.jobs()]


def test_a_shard_finds_its_jobs_in_a_large_cell_in_seconds(tmp_path: Path):
    folder = begun(tmp_path, episodes=10_000, limits={"attempts": 15_000})
    start = time.process_time()
    schedule = Schedule(folder, Shard(1, 16), QUICK)
    assert time.process_time() - start < 5  # comparing each job with all later ones took 20
    assert (job := schedule.next()) is not None and job.number == 1


def test_a_gate_stops_a_cell_and_no_other(tmp_path: Path):
    folder = begun(tmp_path, seeds=2, episodes=6, gates={"acceptance": 0.5, "after": 2})
    behave(tmp_path, all="half", n1="reject")
    assert left_over(driven(folder)) is None
    assert {Path(name).name for name in began(tmp_path)} == {"0000", "0001"}


def test_jobs_follow_where_too_few_episodes_were_verified(tmp_path: Path):
    folder = begun(tmp_path, episodes=2)
    behave(tmp_path, n1="reject")
    assert left_over(driven(folder)) is None
    assert [Path(name).name for name in began(tmp_path)] == ["0000", "0001", "0002"]
    assert sum(record.verified for record in folder.records()) == 2


def test_a_full_disk_of_one_job_does_not_stop_the_others(tmp_path: Path):
    folder = begun(tmp_path, episodes=4)
    behave(tmp_path, n1="full")
    error = left_over(driven(folder))
    assert isinstance(error, PartlyDone) and "no space left" in error.message
    assert error.details["open"] == {f"{folder.plan.cells[0].id}/0001": "disk_full"}
    assert states(folder) == {"done": 3}
    behave(tmp_path)
    assert left_over(driven(folder)) is None


def test_a_disk_that_is_full_for_all_ends_the_driver_soon(tmp_path: Path):
    folder = begun(tmp_path, episodes=50)
    behave(tmp_path, all="full")
    assert isinstance(left_over(driven(folder)), DiskFull)
    assert len(began(tmp_path)) == QUICK.machine_faults


def test_a_missing_key_ends_the_driver_at_once(tmp_path: Path):
    folder = begun(tmp_path, episodes=50)
    schedule, asked = Schedule(folder, settings=QUICK), []

    def work(job: Job) -> Outcome:
        asked.append(job)
        return Outcome(job, error=MissingKey("no key"))

    work_through(schedule, SameProcess(work), 1)
    assert isinstance(left_over(schedule), MissingKey)
    assert len(asked) == 1


def test_a_request_that_an_endpoint_refuses_stops_no_other_job(tmp_path: Path):
    folder = begun(tmp_path, episodes=3)
    schedule = Schedule(folder, settings=QUICK)

    def work(job: Job) -> Outcome:
        refused = ConfigurationError("the endpoint does not accept the request")
        return Outcome(job, error=refused) if job.number == 1 else run_stubbed(folder.root, job)

    work_through(schedule, SameProcess(work), 1)
    assert list(schedule.open) == [f"{folder.plan.cells[0].id}/0001"]
    assert states(folder) == {"done": 2}


def test_a_job_that_another_process_holds_is_looked_at_again(tmp_path: Path):
    folder = begun(tmp_path, episodes=2)
    first = folder.plan.jobs()[0]
    with CampaignFolder(folder.root).held(first):
        error = left_over(driven(folder))
    assert isinstance(error, PartlyDone) and first.id in error.message
    assert [Path(name).name for name in began(tmp_path)] == ["0001"]


def test_records_of_another_driver_let_jobs_begin(tmp_path: Path):
    folder = begun(tmp_path, episodes=4, gates={"acceptance": 0.5, "after": 1})
    schedule = Schedule(folder, settings=QUICK)

    def work(job: Job) -> Outcome:
        done = run_stubbed(folder.root, job)
        return Outcome(job, error=FolderInUse("held by another driver")) if job.number == 0 else done

    work_through(schedule, SameProcess(work), 1)
    assert left_over(schedule) is None
    assert states(folder) == {"done": 4}


def test_a_driver_that_is_interrupted_takes_back_the_tries_of_its_jobs(tmp_path: Path):
    folder = begun(tmp_path, limits={"tries": 1})
    first = folder.plan.jobs()[0]

    def work(job: Job) -> Outcome:
        folder.record_file(job).parent.mkdir(parents=True)
        folder.note_tries(job, Tries(count=1, total=1, open=True))
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        work_through(Schedule(folder, settings=QUICK), SameProcess(work), 1)
    assert folder.tries(first) == Tries(count=0, total=1)
    assert left_over(driven(folder)) is None
    assert states(folder) == {"done": 2}


def damage(folder: CampaignFolder, text: str) -> Path:
    """Write something in place of the record of the first job."""
    path = folder.record_file(folder.plan.jobs()[0])
    path.write_text(text)
    return path


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", "null", '{"schema": "vcage.job/1"}', "\0\0\0"])
def test_a_damaged_record_is_named_and_made_again(tmp_path: Path, caplog: pytest.LogCaptureFixture, text: str):
    folder = begun(tmp_path, episodes=3)
    driven(folder)
    before = outputs(folder.root)
    path = damage(folder, text)
    assert left_over(driven(CampaignFolder(folder.root))) is None
    (said,) = [line for line in caplog.messages if str(path) in line]
    assert "settles its job again" in said
    assert outputs(folder.root) == before


def test_a_record_of_another_version_ends_the_driver_with_its_name_and_stays(tmp_path: Path):
    folder = begun(tmp_path)
    driven(folder)
    path = damage(folder, '{"schema": "vcage.job/2"}')
    with pytest.raises(SchemaMismatch, match=path.name) as caught:
        Schedule(CampaignFolder(folder.root))
    assert "go on with that one" in caught.value.hint
    assert path.read_text() == '{"schema": "vcage.job/2"}'


def test_a_plan_may_grow_and_asks_only_for_what_is_missing(tmp_path: Path):
    folder = begun(tmp_path, episodes=3, episodes_per_job=2)
    driven(folder)
    folder.begin(plan(tmp_path, episodes=4, episodes_per_job=2, seeds=2, limits={"tries": 9}))
    driven(folder)
    ran = Counter(Path(name).name for name in began(tmp_path))
    assert ran == {"0000": 2, "0001": 3}
    assert sum(record.verified for record in folder.records()) == 8


@pytest.mark.parametrize(
    "keys", [{"episodes": 1}, {"seed": 5}, {"looks": ["none"]}, {"options": {"fps": 5}}, {"episodes_per_job": 2}]
)
def test_a_plan_of_other_episodes_is_refused(tmp_path: Path, keys: dict):
    folder = begun(tmp_path)
    with pytest.raises(InputFileError, match="holds a campaign of another plan"):
        folder.begin(plan(tmp_path, **keys))


# --- processes ---------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_job_that_crashes_each_time_is_given_up_by_name_and_one_that_gets_on_is_not(tmp_path: Path):
    folder = begun(tmp_path, episodes=4, limits={"tries": 2})
    behave(tmp_path, n0="crash", n1="get_further")
    assert left_over(run_here(folder, 2, work=run_stubbed)) is None
    found = {record.number: record for record in folder.records()}
    assert [found[number].state for number in range(4)] == ["given_up", "done", "done", "done"]
    assert said(found[0]).startswith("given up after 2 tries that got no further; the last: its process was ended")
    assert found[1].tries == 4
    ran = Counter(Path(name).name for name in began(tmp_path))
    assert (ran["0000"], ran["0002"]) == (2, 1)


@pytest.mark.slow
def test_a_job_that_hangs_is_ended_and_given_up_by_name(tmp_path: Path):
    folder = begun(tmp_path, episodes=2, limits={"tries": 2})
    behave(tmp_path, n0="hang")

    def seconds_left(job: Job, _elapsed: float) -> float:
        """None as soon as the chain of the first job is at work."""
        tries = folder.tries(job)
        return 0.0 if job.number == 0 and tries.open and began(tmp_path).count(job.id) == tries.count else 0.1

    work, lost = partial(run_stubbed, folder.root), partial(lost_job, folder.root)
    crew: Processes[Job, Outcome] = Processes(work, 1, seconds_left, lost=lost)
    schedule = Schedule(folder, settings=QUICK)
    work_through(schedule, crew, 1)
    assert left_over(schedule) is None
    found = {record.number: record for record in folder.records()}
    assert (found[0].state, found[1].state, found[2].state) == ("given_up", "done", "done")
    assert "its process gave no answer and was ended after" in said(found[0])
    assert Counter(began(tmp_path))[folder.plan.jobs()[0].id] == 2


@pytest.mark.slow
def test_clocks_that_jump_by_a_day_while_jobs_run_change_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("vcage.campaigns.hanging.silence_limit", lambda plan: 60.0)
    folders = []
    for name, ways in (("jumps", {"n0": "jump_ahead", "n1": "jump_back"}), ("undisturbed", {})):
        (tmp_path / name).mkdir()
        folders.append(begun(tmp_path / name, episodes=3))
        behave(tmp_path / name, **ways)
        assert left_over(run_here(folders[-1], 2, work=run_stubbed)) is None
    assert [record.tries for record in folders[0].records()] == [1, 1, 1]
    assert outputs(folders[0].root) == outputs(folders[1].root)


def said(record: JobRecord) -> str:
    assert record.error is not None
    return record.error.message


DRIVER = """
import sys
from pathlib import Path
from tests.campaigns.stubbed import run_stubbed
from vcage.campaigns import driver
from vcage.campaigns.driver import run_here
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.schedule import left_over
from vcage.campaigns.shard import Shard
driver.preload_module = lambda *_: None  # nothing is simulated
error = left_over(run_here(CampaignFolder(sys.argv[1]), 1, Shard(*map(int, sys.argv[2:])), work=run_stubbed))
print(error)
"""


@pytest.mark.slow
def test_two_drivers_at_once_run_each_job_once(tmp_path: Path):
    folder = begun(tmp_path, episodes=4)
    behave(tmp_path, all="slow")
    program = [sys.executable, "-c", DRIVER, str(folder.root)]
    with subprocess.Popen(program, cwd=REPOSITORY, stdout=subprocess.PIPE, text=True) as other:
        while not began(tmp_path):
            assert other.poll() is None
            time.sleep(0.05)
        ours = left_over(driven(folder))
        theirs = other.communicate(timeout=120)[0].strip()
    assert "None" in (str(ours), theirs)
    assert sorted(Counter(began(tmp_path)).values()) == [1] * 4
    assert states(folder) == {"done": 4}


@pytest.mark.slow
def test_shards_that_run_at_once_wait_for_a_first_job_that_was_killed_in_one_and_taken_by_another(tmp_path: Path):
    folder = begun(tmp_path, episodes=3, options={})
    behave(tmp_path, all="slow")
    first, program = folder.plan.jobs()[0], [sys.executable, "-c", DRIVER, str(folder.root)]
    killed, *others = (
        subprocess.Popen([*program, str(index), "3"], cwd=REPOSITORY, stdout=subprocess.PIPE, text=True)
        for index in range(3)
    )
    while not began(tmp_path):
        time.sleep(0.05)
    killed.kill()
    ends = [shard.communicate(timeout=120)[0].strip() for shard in (killed, *others)]
    assert "None" in ends
    ran = Counter(began(tmp_path))
    assert (ran.pop(first.id) <= 2, set(ran.values())) == (True, {1})
    assert states(folder) == {"done": 3}


def test_no_two_jobs_of_a_plan_share_a_file(tmp_path: Path):
    folder = begun(tmp_path, seeds=2, episodes=3)
    driven(folder)
    seeds = [json.loads(path.read_text())["seed"] for path in folder.root.glob("jobs/*/*.job.json")]
    assert len(set(seeds)) == 6
