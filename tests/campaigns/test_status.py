"""Progress of a campaign: figures per cell from the records alone, while others write them."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.campaigns.stubbed import began, begun, behave, run_stubbed
from tests.campaigns.test_driver import driven
from tests.run_folders import REPOSITORY
from vcage.base.errors import InputFileError, MissingStage, OutputFolderError
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.status import status_of, table, write_page
from vcage.models.shared import Shared


def test_a_campaign_that_has_not_begun_asks_for_all(tmp_path: Path):
    status = status_of(begun(tmp_path, seeds=2, episodes=3))
    assert [(cell.asked, cell.verified, cell.left, cell.state) for cell in status.cells] == [(3, 0, 3, "waiting")] * 2
    assert (status.total.acceptance, status.total.per_worker_hour, status.ended) == (None, None, False)


def test_counts_are_those_of_the_records(tmp_path: Path):
    folder = begun(tmp_path, episodes=4, episodes_per_job=2)
    behave(tmp_path, all="half")
    driven(folder)
    (cell,) = status_of(folder).cells
    assert (cell.asked, cell.verified, cell.tried, cell.left, cell.state) == (4, 4, 8, 0, "done")
    assert (cell.rejected, dict(cell.jobs), cell.acceptance) == ([("it fell", 4)], {"done": 2}, 0.5)
    assert cell.critic.judged == 8 and cell.critic.true_refused == 4
    assert cell.per_worker_hour is not None and cell.per_worker_hour > 0


def test_jobs_that_failed_are_named_with_their_reason(tmp_path: Path):
    folder = begun(tmp_path)
    behave(tmp_path, n0="fail")
    driven(folder)
    status = status_of(folder)
    assert [record.number for record in status.not_done] == [0]
    assert f"failed: {folder.plan.cells[0].id}/0000: no such thing" in table(status)


def test_records_that_cannot_be_read_are_named_and_counted_apart(tmp_path: Path):
    folder = begun(tmp_path, episodes=4)
    driven(folder)
    cut, other, *_ = map(folder.record_file, folder.plan.jobs())
    cut.write_text('{"schema": "vcage.jo')
    other.write_text('{"schema": "vcage.job/2"}')
    status = status_of(folder)
    assert (status.total.verified, status.facts()["unread"], status.facts()["jobs"]) == (2, 2, {"done": 2})
    text, page = table(status), write_page(folder, status).read_text()
    for said in (str(cut), str(other), "another version"):
        assert said in text and said in page
    assert "records that cannot be read, and count as missing: 2" in text


@pytest.mark.parametrize("odd", ["folder", "pipe", "circle", "device", "counts"])
def test_what_stands_in_place_of_a_record_is_named_and_stops_nothing(tmp_path: Path, odd: str):
    folder = begun(tmp_path, episodes=4)
    driven(folder)
    path = folder.record_file(folder.plan.jobs()[0])
    counts = path.read_text().replace('"verified": 1', '"verified": 1000000')
    path.unlink()
    make: dict[str, Callable[[], Any]] = {
        "folder": path.mkdir,
        "pipe": lambda: os.mkfifo(path),
        "circle": lambda: path.symlink_to(path.name),
        "device": lambda: path.symlink_to("/dev/zero"),
        "counts": lambda: path.write_text(counts),
    }
    make[odd]()
    status = status_of(CampaignFolder(folder.root))
    assert (status.total.verified, len(status.unread)) == (3, 1)
    assert str(path) in table(status)


def test_files_of_other_programs_beside_records_are_passed_over(tmp_path: Path):
    folder = begun(tmp_path, episodes=2)
    driven(folder)
    path = folder.record_file(folder.plan.jobs()[0])
    path.with_name(f"._{path.name}").write_bytes(b"\0\5Mac")
    (folder.root / "jobs" / "circle").symlink_to("circle")
    (folder.root / "jobs" / ".DS_Store").touch()
    status = status_of(CampaignFolder(folder.root))
    assert (status.total.verified, status.unread) == (2, [])


def test_a_file_in_place_of_the_folder_of_jobs_is_named(tmp_path: Path):
    folder = begun(tmp_path)
    (folder.root / "jobs").touch()
    with pytest.raises(InputFileError, match="jobs cannot be read: Not a directory"):
        status_of(folder)


def test_a_folder_of_jobs_that_a_lost_file_server_does_not_list_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    def lost(_path: Path) -> None:
        raise OSError(errno.ESTALE, os.strerror(errno.ESTALE))

    folder = begun(tmp_path)
    driven(folder)
    monkeypatch.setattr("vcage.campaigns.folder.os.scandir", lost)
    with pytest.raises(InputFileError, match=f"{folder.plan.cells[0].id} cannot be read: Stale file handle"):
        status_of(folder)


def test_a_cell_that_its_gate_stopped_says_so_and_nothing_of_it_is_left(tmp_path: Path):
    folder = begun(tmp_path, episodes=6, gates={"acceptance": 0.5, "after": 1})
    behave(tmp_path, all="reject")
    driven(folder)
    status = status_of(folder)
    assert (status.left, status.ended) == (0, True)
    assert status.cells[0].state == "0 of the first 3 episodes accepted, below the gate of 0.5"


def test_the_list_shows_cells_that_go_on_first_and_says_how_many_it_leaves_out(tmp_path: Path):
    folder = begun(tmp_path, seeds=3, episodes=1)
    run_stubbed(folder.root, folder.plan.jobs()[0])
    lines = table(status_of(folder), most=2).splitlines()
    assert "_1 " in lines[-3] and "_2 " in lines[-2]
    assert lines[-1] == "… and 1 more cells"


def test_the_bill_is_that_of_the_shared_exchanges(tmp_path: Path):
    folder = begun(tmp_path)
    bill = Shared(folder.exchanges).bill
    with bill.locked():
        bill.append("asked", "gemini:some", "1")
        bill.append("answered", "gemini:some", "1", usd=0.5, tokens_in=7)
    status = status_of(folder)
    assert (status.calls, status.usd) == (1, 0.5)
    assert "models: 1 answers, 0.5000 USD" in table(status)


def test_a_folder_without_a_campaign_is_named(tmp_path: Path):
    with pytest.raises(MissingStage, match="holds no campaign"):
        status_of(CampaignFolder(tmp_path))


def test_the_page_holds_every_figure_and_escapes_what_others_wrote(tmp_path: Path):
    folder = begun(tmp_path, seeds=2, episodes=2, tasks=[{"id": "b", "instruction": "<script>"}])
    behave(tmp_path, all="half", n1="fail")
    driven(folder)
    status = status_of(folder)
    text = write_page(folder, status, refresh_s=5).read_text()
    for said in ("b_aloha-agilex_varied_light_0", "it fell", "no such thing", "critic says yes", 'content="5"'):
        assert said in text
    assert "<script>" not in text


WORKER = """
import sys, time
from pathlib import Path
from tests.campaigns.stubbed import run_stubbed
from vcage.campaigns.folder import CampaignFolder
folder = CampaignFolder(sys.argv[1])
run_stubbed(folder.root, folder.plan.jobs()[0])
"""


@pytest.fixture
def working(tmp_path: Path):
    """A campaign one of whose jobs runs in another process."""
    folder = begun(tmp_path, seeds=2)
    behave(tmp_path, all="hang")
    program: list[Any] = [sys.executable, "-c", WORKER, folder.root]
    with subprocess.Popen(program, cwd=REPOSITORY) as process:
        while not began(tmp_path) and process.poll() is None:
            pass
        yield folder, process
        process.kill()


@pytest.mark.slow
def test_a_job_is_running_while_its_process_lives_and_no_longer(working):
    folder, process = working
    status = status_of(folder)
    assert [job.job for job in status.running] == [folder.plan.jobs()[0].id]
    assert status.running[0].holder.startswith(f"process {process.pid} on ")
    assert [cell.state for cell in status.cells] == ["running", "waiting"]
    process.kill()
    process.wait()
    assert status_of(folder).running == []


def test_a_folder_in_place_of_the_page_is_named(tmp_path: Path):
    folder = begun(tmp_path)
    folder.page.mkdir()
    with pytest.raises(OutputFolderError, match=r"status\.html"):
        write_page(folder, status_of(folder))
