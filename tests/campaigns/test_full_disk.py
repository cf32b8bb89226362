"""Campaigns and merges on a disk that is really full."""

from __future__ import annotations

import contextlib
import time
from pathlib import Path

import pytest

from tests.campaigns.mounts import elsewhere, grow, needs_mounts
from tests.campaigns.stubbed import begun, behave
from tests.campaigns.test_driver import driven, states
from vcage.base.files import RunFolder
from vcage.campaigns import job as job_module
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.job_errors import Meaning, meaning_of
from vcage.campaigns.schedule import left_over
from vcage.campaigns.status import status_of, table

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
