"""``vcage campaign`` and ``vcage status`` as commands: what they print, and what they refuse."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from tests.campaigns.stubbed import begun, behave, plan, run_stubbed
from tests.run_folders import command, digests
from vcage.campaigns.estimate import Estimate
from vcage.campaigns.folder import CampaignFolder


@pytest.fixture
def path(tmp_path: Path) -> Path:
    plan(tmp_path, seeds=2, episodes=3)
    return tmp_path / "PLAN.yml"


def test_a_dry_run_says_how_large_a_plan_is_and_writes_nothing(path: Path, tmp_path: Path, capsys):
    done = command(capsys, "campaign", path, "--out", tmp_path / "out", "--dry-run")
    size = {"cells": 2, "jobs": 6, "episodes": 6, "left": 6}
    assert (done.code, done.record["summary"] | size) == (0, done.record["summary"])
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("option", "name", "submit"), [("--slurm", "campaign.sbatch", "sbatch"), ("--k8s", "campaign.k8s.yml", "kubectl")]
)
def test_the_file_for_a_scheduler_is_written_and_nothing_is_run(
    path: Path, tmp_path: Path, capsys, option: str, name: str, submit: str
):
    out = tmp_path / "out"
    done = command(capsys, "campaign", path, "--out", out, option, "4", "--workers", "2")
    assert (done.code, done.record["output"]) == (0, str(out / name))
    assert done.record["next"].startswith(submit)
    assert str(out / "plan.yml") in (out / name).read_text()
    assert not (out / "jobs").exists()


@pytest.mark.parametrize("shard", ["4/4", "1", "-1/4", "a/b"])
def test_an_impossible_shard_is_refused(path: Path, tmp_path: Path, capsys, shard: str):
    done = command(capsys, "campaign", path, "--out", tmp_path / "out", "--shard", shard)
    assert (done.code, done.error["code"]) == (2, "usage")
    assert "--shard" in done.error["message"]


@pytest.mark.parametrize("options", [["--ray", "auto", "--shard", "0/2"], ["--slurm", "2", "--k8s", "2"]])
def test_two_drivers_at_once_are_refused(path: Path, tmp_path: Path, capsys, options: list[str]):
    done = command(capsys, "campaign", path, "--out", tmp_path / "out", *options)
    assert (done.code, done.error["code"]) == (2, "usage")
    assert f"{options[0]} and {options[2]}" in done.error["message"]
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("option", ["--slurm", "--k8s"])
def test_a_retry_is_refused_where_a_script_is_written_and_no_job_is_run(
    path: Path, tmp_path: Path, capsys, option: str
):
    done = command(capsys, "campaign", path, "--out", tmp_path / "out", option, "2", "--retry")
    assert (done.code, done.error["code"]) == (2, "usage")
    assert f"--retry and {option} cannot be given together" in done.error["message"]
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("dry", [[], ["--dry-run"]])
@pytest.mark.parametrize("out", ["", "PLAN.yml"])
def test_a_folder_with_something_else_in_it_or_a_file_is_refused(
    path: Path, tmp_path: Path, capsys, dry: list[str], out: str
):
    done = command(capsys, "campaign", path, "--out", tmp_path / out, *dry)
    assert (done.code, done.error["code"]) == (2, "output_not_writable")


@pytest.mark.parametrize("dry", [[], ["--dry-run"]])
def test_another_plan_in_the_same_folder_is_refused_with_the_way_out(
    path: Path, tmp_path: Path, capsys, dry: list[str]
):
    begun(tmp_path, seed=3)
    plan(tmp_path)
    done = command(capsys, "campaign", path, "--out", tmp_path / "campaign", *dry)
    assert (done.code, done.error["code"]) == (3, "bad_input_file")
    assert "another value of seed" in done.error["message"] and "may be added" in done.error["hint"]


def test_a_campaign_that_ends_with_too_few_episodes_says_so_and_is_not_to_be_repeated(tmp_path: Path, capsys):
    folder = ended(tmp_path)
    done = command(capsys, "campaign", tmp_path / "PLAN.yml", "--out", folder.root)
    assert (done.code, done.error["code"], done.error["retryable"]) == (7, "partly_done", False)
    assert "verified 0 of 1 episodes; 1 of 1 cells ended with too few" in done.error["message"]
    assert done.record["output"] == str(folder.page)


def test_a_report_that_cannot_be_written_hides_no_other_error(tmp_path: Path, capsys):
    folder = ended(tmp_path)
    folder.page.mkdir()
    done = command(capsys, "campaign", tmp_path / "PLAN.yml", "--out", folder.root)
    assert (done.code, done.error["code"], done.record["output"]) == (7, "partly_done", str(folder.root))
    assert "cannot write" in done.stderr and "status.html" in done.stderr


def test_a_report_that_cannot_be_written_is_the_error_where_there_is_no_other(tmp_path: Path, capsys):
    folder = begun(tmp_path, episodes=1)
    run_stubbed(folder.root, folder.plan.jobs()[0])
    folder.page.mkdir()
    done = command(capsys, "campaign", tmp_path / "PLAN.yml", "--out", folder.root)
    assert (done.code, done.error["code"]) == (2, "output_not_writable")


def test_a_dry_run_of_a_retry_counts_what_would_be_tried_again_and_changes_nothing(tmp_path: Path, capsys):
    folder = ended(tmp_path)
    before = digests(folder.root)
    done = command(capsys, "campaign", tmp_path / "PLAN.yml", "--out", folder.root, "--dry-run", "--retry")
    assert (done.record["summary"]["left"], done.record["summary"]["tried_again"]) == (1, 1)
    assert "1 left, jobs to be tried again: 1" in Estimate.of(folder.plan, folder, folder.failed(folder.plan)).text()
    assert digests(folder.root) == before


def test_the_status_is_a_table_for_people_and_figures_for_programs(tmp_path: Path, capsys):
    folder = ended(tmp_path)
    done = command(capsys, "status", folder.root, "--html", "--watch")
    assert done.code == 0
    assert (done.record["summary"]["asked"], done.record["summary"]["not_done"]) == (1, 1)
    (cell,) = done.record["summary"]["cells"].values()
    assert cell["state"] == "all of its 1 jobs failed"
    assert folder.page.exists()


def test_the_status_of_a_folder_without_a_campaign_names_it(tmp_path: Path, capsys):
    done = command(capsys, "status", tmp_path)
    assert (done.code, done.error["code"]) == (3, "missing_stage")


def ended(root: Path) -> CampaignFolder:
    """A campaign of one job, which failed."""
    folder = begun(root, episodes=1)
    behave(root, all="fail")
    run_stubbed(folder.root, folder.plan.jobs()[0])
    assert yaml.safe_load(folder.plan_file.read_text())["name"] == "test"
    return folder
