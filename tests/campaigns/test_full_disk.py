"""Campaigns and merges on a disk that is really full."""

from __future__ import annotations

import contextlib
import subprocess
import time
from pathlib import Path

import pytest

from benchmarks._merge_runs import RunSpec, make_run
from tests.campaigns.mounts import elsewhere, grow, needs_mounts
from tests.campaigns.stubbed import begun, behave, run_stubbed
from tests.campaigns.test_driver import driven, states
from tests.run_folders import digests
from vcage.base.errors import DiskFull, OutputFolderError
from vcage.base.files import RunFolder
from vcage.campaigns import job as job_module
from vcage.campaigns import merge as merging
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.job_errors import Meaning, meaning_of
from vcage.campaigns.merge import MergeSettings, Order, merge
from vcage.campaigns.schedule import left_over
from vcage.campaigns.status import status_of, table, write_page
from vcage.datasets.lerobot.formats import FORMATS
from vcage.datasets.lerobot.growing import COMMITTED
from vcage.datasets.lerobot.meta import INFO, data_set_info
from vcage.datasets.recordings.opening import open_recordings

pytestmark = needs_mounts


@pytest.fixture
def disk(tmp_path: Path) -> Path:
    """The place of a small disk."""
    place = tmp_path / "disk"
    place.mkdir()
    return place


def fill(disk: Path) -> None:
    """Write until there is no room for a single byte."""
    with contextlib.suppress(OSError), open(disk / f"ballast-{time.monotonic_ns()}", "wb", buffering=0) as ballast:
        while ballast.write(b"a" * 4096):
            pass


@pytest.mark.parametrize("others_write", [False, True])
def test_a_full_disk_uses_up_no_try_is_named_and_the_campaign_goes_on_when_there_is_room(
    disk: Path, monkeypatch: pytest.MonkeyPatch, others_write: bool
):
    def meaning(error: Exception, run: RunFolder) -> Meaning:
        """Take the room that the job left free when it ended, as other processes would."""
        if others_write:
            fill(disk)
        return meaning_of(error, run)

    def campaign() -> None:
        folder = begun(disk, episodes=2, limits={"tries": 1})
        behave(disk, all="fill")
        monkeypatch.setattr(job_module, "meaning_of", meaning)
        for _ in range(3):
            error = left_over(driven(CampaignFolder(folder.root)))
            assert error is not None and "no space left" in error.message
        assert (list(folder.records()), folder.tries(folder.plan.jobs()[0]).count) == ([], 0)
        assert "no space left" in table(status_of(folder))
        grow(disk, "64m")
        assert left_over(driven(folder)) is None
        assert states(folder) == {"done": 2}
        assert [record.tries for record in folder.records()] == [1, 1]
        assert "no space left" not in table(status_of(folder))

    elsewhere(campaign, mount_over=disk, size="4m")


def test_what_cannot_be_written_on_a_disk_that_became_read_only_is_named(disk: Path):
    def look() -> None:
        folder = begun(disk, episodes=2)
        run_stubbed(folder.root, folder.plan.jobs()[0])
        subprocess.run(["mount", "-o", "remount,ro", disk], check=True)
        status = status_of(folder)
        assert status.total.verified == 1
        with pytest.raises(OutputFolderError, match=r"status\.html: Read-only file system"):
            write_page(folder, status)
        outcome = run_stubbed(folder.root, folder.plan.jobs()[1])
        assert outcome.of_the_machine and isinstance(outcome.error, OutputFolderError)

    elsewhere(look, mount_over=disk, size="4m")


@pytest.mark.slow
def test_a_merge_that_fills_the_disk_again_and_again_ends_with_the_files_of_an_undisturbed_one(
    tmp_path: Path, disk: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(merging, "SETTINGS", MergeSettings(commit_episodes=2))
    runs, order, full = tmp_path / "runs", Order(formats=tuple(FORMATS), test=0.3), list[int]()
    for seed in range(4):
        make_run(runs / str(seed), RunSpec(seed=seed, episodes=2, frames=6))
    merge([runs], tmp_path / "whole", order)

    def merge_in_steps() -> None:
        for pages in range(1, 600, 11):
            grow(disk, f"{4 * pages}k")
            try:
                merge([runs], disk / "all", order)
                break
            except DiskFull:
                full.append(pages)
            for name in FORMATS:
                require_whole(disk / "all" / name)
        assert digests(disk / "all") == digests(tmp_path / "whole")

    elsewhere(merge_in_steps, mount_over=disk, size="4k")
    assert len(full) > 5, full


def require_whole(root: Path) -> None:
    """Check that a data set, if there is one, holds the episodes that it declares."""
    if (root / INFO).is_file() and not (root / COMMITTED).exists():
        assert len(open_recordings(root)) == data_set_info(root)["total_episodes"]
