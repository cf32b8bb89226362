"""Jobs whose process was lost and goes on, or hangs where nobody can end it."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from benchmarks._campaign_outputs import outputs
from tests.campaigns.stubbed import began, begun, behave, run_stubbed
from tests.run_folders import REPOSITORY
from vcage.base.errors import PartlyDone
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.hanging import HangWatch
from vcage.campaigns.job import Outcome
from vcage.campaigns.stranded import Stranded

pytestmark = pytest.mark.slow

PROGRAM = """
import sys
from tests.campaigns.stubbed import run_stubbed
from vcage.campaigns.folder import CampaignFolder
folder = CampaignFolder(sys.argv[1])
run_stubbed(folder.root, folder.plan.jobs()[0])
"""


@pytest.fixture
def folder(tmp_path: Path) -> CampaignFolder:
    found = begun(tmp_path, episodes=1)
    behave(tmp_path, all="slow")
    return found


@pytest.fixture
def process(folder: CampaignFolder) -> Iterator[subprocess.Popen[bytes]]:
    """A process of which the driver knows nothing any more, at work on the only job."""
    with subprocess.Popen([sys.executable, "-c", PROGRAM, str(folder.root)], cwd=REPOSITORY) as running:
        while not began(folder.root.parent):
            time.sleep(0.05)
        yield running
        running.kill()


def outcome_of_lost(folder: CampaignFolder, within_s: float = 60.0) -> Outcome:
    stranded = Stranded(folder, HangWatch(folder.root), 0.2)
    stranded.add(folder.plan.jobs()[0], time.monotonic(), "was lost")
    end = time.monotonic() + within_s
    while stranded and time.monotonic() < end:
        if found := list(stranded.outcomes()):
            return found[0]
        time.sleep(0.05)
    raise AssertionError("the job is still held")


def test_a_job_that_its_lost_process_ends_after_all_is_not_done_again(
    folder: CampaignFolder, process: subprocess.Popen[bytes]
):
    outcome = outcome_of_lost(folder)
    assert outcome.record is not None and (outcome.record.state, outcome.record.tries) == ("done", 1)
    assert not folder.tries_file(outcome.job).exists()


def test_a_job_is_taken_from_a_process_that_hangs_which_ends_when_it_wakes(
    folder: CampaignFolder, process: subprocess.Popen[bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("vcage.campaigns.hanging.silence_limit", lambda plan: 1.0)
    process.send_signal(signal.SIGSTOP)
    outcome = outcome_of_lost(folder)
    assert isinstance(outcome.error, PartlyDone) and "its process was lost" in outcome.error.message
    behave(tmp_path)
    record = run_stubbed(folder.root, outcome.job).record
    assert record is not None and record.state == "done"
    before = outputs(folder.root), folder.record_file(outcome.job).stat()
    process.send_signal(signal.SIGCONT)
    assert process.wait(60) == 1
    assert (outputs(folder.root), folder.record_file(outcome.job).stat()) == before


def test_a_process_that_is_slow_keeps_its_job(folder: CampaignFolder, process: subprocess.Popen[bytes]):
    stranded = Stranded(folder, HangWatch(folder.root), 0.0)
    stranded.add(folder.plan.jobs()[0], time.monotonic(), "was lost")
    assert list(stranded.outcomes()) == [] and stranded
    assert process.wait(60) == 0
