"""One job: settled once, counted, and given up where no try gets further."""

from __future__ import annotations

import errno
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest

from benchmarks._campaign_outputs import left_over
from tests.campaigns.stubbed import began, begun, behave, run_stubbed
from vcage.base.errors import FolderInUse, OutputFolderError
from vcage.base.files import RunFolder
from vcage.base.reading import open_regular
from vcage.campaigns import job as job_module
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.job import Outcome, lost_job, run_job
from vcage.campaigns.record import JobRecord


def run(folder: CampaignFolder, number: int = 0) -> Outcome:
    return run_stubbed(folder.root, folder.plan.jobs_of(folder.plan.cells[0])[number])


def record(outcome: Outcome) -> JobRecord:
    assert outcome.record is not None, outcome.error
    return outcome.record


def test_a_job_is_run_once_and_its_record_has_the_result(tmp_path: Path):
    folder = begun(tmp_path, episodes=4, episodes_per_job=4)
    behave(tmp_path, all="half")
    first = record(run(folder))
    assert (first.state, first.asked, first.verified, first.tried) == ("done", 4, 4, 8)
    assert (first.rejected, first.attempts, first.tries) == ({"it fell": 4}, 8, 1)
    assert first.critic is not None and first.critic.judged == 8
    assert (first.bytes > 0, first.memory_bytes > 1e6, first.seconds > 0) == (True, True, True)
    assert record(run(folder)) == first
    assert began(tmp_path) == [f"{folder.plan.cells[0].id}/0000"]


@pytest.mark.parametrize(
    ("number", "options", "taken"),
    [(0, {}, False), (1, {}, True), (1, {"crf": 20}, False), (1, {"scope": "episode"}, False)],
)
def test_a_job_takes_over_the_crfs_of_the_first_one_of_its_cell(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int, options: dict[str, Any], taken: bool
):
    folder = begun(tmp_path, options=options)
    first, job = (folder.plan.job(folder.plan.cells[0], n) for n in (0, number))
    found: list[Any] = []
    monkeypatch.setattr(job_module, "run_chain", lambda _run, options, *_: found.append(options.crf_of))
    run_job(folder.root, job)
    folder.record_file(job).unlink(missing_ok=True)
    folder.run(first).compression.parent.mkdir(parents=True)
    folder.run(first).compression.touch()
    run_job(folder.root, job)
    assert found == [None, folder.run(first).root if taken else None]


def test_an_error_that_would_come_again_settles_a_job(tmp_path: Path):
    folder = begun(tmp_path)
    behave(tmp_path, all="fail")
    found = record(run(folder))
    assert (found.state, found.asked, found.verified) == ("failed", 1, 0)
    assert found.error is not None
    assert (found.error.code, found.error.message) == ("usage", "no such thing (name another)")


def test_a_job_without_any_verified_episode_is_done(tmp_path: Path):
    folder = begun(tmp_path)
    behave(tmp_path, all="reject")
    assert (record(run(folder)).state, record(run(folder)).verified, record(run(folder)).tried) == ("done", 0, 3)


def test_a_job_with_a_bug_is_tried_again_and_then_given_up_by_name(tmp_path: Path):
    folder = begun(tmp_path, limits={"tries": 2})
    behave(tmp_path, all="raise")
    first = run(folder)
    assert first.record is None and first.error is not None and "ZeroDivisionError" in first.error.message
    assert not first.of_the_machine
    found = record(run(folder))
    assert found.state == "given_up"
    assert found.error is not None
    said = "given up after 2 tries that got no further; the last: ZeroDivisionError: division by zero"
    assert (found.error.code, found.error.message, found.tries) == ("bug", said, 2)


def test_a_full_disk_is_not_counted_as_a_try(tmp_path: Path):
    folder = begun(tmp_path, limits={"tries": 1})
    behave(tmp_path, all="full")
    for _ in range(3):
        outcome = run(folder)
        assert outcome.record is None and outcome.of_the_machine
    behave(tmp_path, all="verify")
    assert (record(run(folder)).state, record(run(folder)).tries) == ("done", 1)


@pytest.mark.parametrize("number", [errno.EROFS, errno.EIO, errno.ENOSPC])
def test_an_error_of_the_disk_leaves_the_job_open(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int):
    folder = begun(tmp_path, limits={"tries": 1})

    def refuse(*_: Any) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(job_module, "_run", refuse)
    for _ in range(2):
        assert run(folder).of_the_machine
    monkeypatch.undo()
    assert record(run(folder)).state == "done"


def test_a_file_server_that_is_gone_while_a_file_is_read_leaves_the_job_open(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    folder = begun(tmp_path, limits={"tries": 1})
    path = tmp_path / "mesh.obj"
    path.touch()

    def lost(*_: Any) -> None:
        with monkeypatch.context() as patched:
            patched.setattr(Path, "open", refuse)
            open_regular(path, "a mesh", 100)

    def refuse(*_: Any) -> None:
        raise OSError(errno.ESTALE, os.strerror(errno.ESTALE))

    with monkeypatch.context() as patched:
        patched.setattr(job_module, "_run", lost)
        outcome = run(folder)
    assert outcome.record is None and outcome.of_the_machine
    assert outcome.error is not None and str(path) in outcome.error.message
    assert record(run(folder)).state == "done"


def test_a_job_without_enough_memory_is_tried_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    folder = begun(tmp_path)

    def refuse(*_: Any) -> None:
        raise MemoryError

    monkeypatch.setattr(job_module, "_run", refuse)
    assert run(folder).record is None
    monkeypatch.undo()
    assert record(run(folder)).tries == 2


def test_a_folder_that_cannot_be_written_leaves_the_job_open(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    folder = begun(tmp_path)

    def refuse(self: RunFolder) -> None:
        raise OutputFolderError(f"cannot write {self}: Read-only file system")

    monkeypatch.setattr(RunFolder, "make", refuse)
    outcome = run(folder)
    assert outcome.of_the_machine and isinstance(outcome.error, OutputFolderError)
    monkeypatch.undo()
    assert record(run(folder)).state == "done"


def test_a_file_in_place_of_a_run_folder_is_named(tmp_path: Path):
    folder = begun(tmp_path)
    job = folder.plan.jobs()[0]
    path = folder.root / "jobs" / job.id
    path.parent.mkdir(parents=True)
    path.write_text("not a folder")
    outcome = run(folder)
    assert outcome.of_the_machine and outcome.error is not None and str(path) in outcome.error.message


def test_a_job_that_another_process_holds_is_left_to_it(tmp_path: Path):
    folder = begun(tmp_path)
    job = folder.plan.jobs()[0]
    with CampaignFolder(folder.root).held(job):
        outcome = run(folder)
    assert isinstance(outcome.error, FolderInUse) and outcome.of_the_machine
    assert began(tmp_path) == []
    assert record(run(folder)).tries == 1


def test_what_a_killed_process_left_of_its_record_and_tries_is_removed(tmp_path: Path):
    folder = begun(tmp_path)
    job = folder.plan.jobs()[0]
    killed = subprocess.Popen(["true"])
    killed.wait()
    for path in (folder.record_file(job), folder.tries_file(job)):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.with_name(f"{path.stem}.partial-{killed.pid}{path.suffix}").touch()
    run(folder)
    assert left_over(folder.root) == []


def test_a_job_whose_process_was_lost_too_often_is_given_up_with_the_reason(tmp_path: Path):
    folder = begun(tmp_path, limits={"tries": 2})
    behave(tmp_path, all="raise")
    run(folder)
    job = folder.plan.jobs()[0]
    tries = folder.tries(job)
    folder.note_tries(job, tries.model_copy(update={"count": 2, "total": 2}))
    found = record(lost_job(folder.root, job, "was ended from outside"))
    assert found.error is not None
    assert (found.state, found.error.code) == ("given_up", "lost")
    assert found.error.message.endswith("the last: its process was ended from outside")


def test_a_job_that_ended_before_its_process_was_lost_stays_as_it_ended(tmp_path: Path):
    folder = begun(tmp_path)
    ended = record(run(folder))
    job = folder.plan.jobs()[0]
    assert record(lost_job(folder.root, job, "was lost")) == ended
    assert not folder.tries_file(job).exists()


def test_a_disk_that_fails_while_a_loss_is_noted_leaves_the_job_open(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    folder = begun(tmp_path)

    def refuse(*_: Any) -> None:
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    monkeypatch.setattr(CampaignFolder, "note_tries", refuse)
    assert lost_job(folder.root, folder.plan.jobs()[0], "was lost").of_the_machine
    monkeypatch.undo()
    assert record(run(folder)).state == "done"


def test_tries_that_were_begun_by_processes_that_are_gone_count(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    folder = begun(tmp_path, limits={"tries": 3})

    def killed(*_: Any) -> None:
        raise KeyboardInterrupt  # nothing after it runs, as if the process were gone

    monkeypatch.setattr(job_module, "_run", killed)
    for _ in range(3):
        with pytest.raises(KeyboardInterrupt):
            run(folder)
    found = record(run(folder))
    assert (found.state, found.tries) == ("given_up", 3)


def test_a_record_of_another_version_is_named_and_nothing_is_run(tmp_path: Path):
    folder = begun(tmp_path)
    record(run(folder))
    path = folder.record_file(folder.plan.jobs()[0])
    path.write_text('{"schema": "vcage.job/2"}')
    outcome = run(folder)
    assert outcome.error is not None and str(path) in outcome.error.message
    assert len(began(tmp_path)) == 1
