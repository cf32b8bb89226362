"""Files of ranges: a campaign keeps those with which it began."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.campaigns.stubbed import plan
from vcage.base.errors import InputFileError
from vcage.base.files import resource
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.plan import Plan


@pytest.fixture
def folder(tmp_path: Path) -> CampaignFolder:
    """A campaign with ranges of the user's own."""
    shutil.copy(resource("assets", "randomisation", "light.yml"), tmp_path / "mine.yml")
    found = CampaignFolder(tmp_path / "campaign")
    found.begin(plan(tmp_path, looks=["none", "mine.yml"]))
    return found


def test_a_campaign_goes_on_wherever_its_folder_lies_and_without_the_file_of_the_user(
    folder: CampaignFolder, tmp_path: Path
):
    copy = folder.root / "looks" / "mine.yml"
    assert [cell.look for cell in folder.plan.cells] == ["none", str(copy)]
    (tmp_path / "mine.yml").unlink()
    moved = CampaignFolder(folder.root.rename(tmp_path / "moved"))
    moved.begin(Plan.load(moved.plan_file))
    assert moved.plan.cells[1].look == str(moved.root / "looks" / "mine.yml")
    assert moved.plan.options_of(moved.plan.jobs()[1]).ranges().name


def test_the_same_plan_goes_on_and_may_grow(folder: CampaignFolder, tmp_path: Path):
    before = folder.plan_file.read_bytes()
    folder.begin(plan(tmp_path, looks=["none", "mine.yml"]))
    assert folder.plan_file.read_bytes() == before
    shutil.copy(tmp_path / "mine.yml", tmp_path / "more.yml")
    folder.begin(plan(tmp_path, looks=["none", "mine.yml", "more.yml"]))
    assert (folder.root / "looks" / "more.yml").is_file()


def test_ranges_that_were_edited_since_are_refused(folder: CampaignFolder, tmp_path: Path):
    (tmp_path / "mine.yml").write_text((tmp_path / "mine.yml").read_text() + "\n# edited\n")
    with pytest.raises(InputFileError, match=r"mine\.yml is not what it was when the campaign"):
        folder.begin(plan(tmp_path, looks=["none", "mine.yml"]))


def test_a_copy_that_was_not_made_before_the_end_is_made_later(folder: CampaignFolder, tmp_path: Path):
    shutil.rmtree(folder.root / "looks")
    folder.begin(plan(tmp_path, looks=["none", "mine.yml"]))
    assert (folder.root / "looks" / "mine.yml").is_file()
