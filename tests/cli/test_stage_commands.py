"""The stage commands and ``vcage run`` on good and bad input: one line, a record, an exit code, nothing lost."""

from __future__ import annotations

import errno
import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.run_folders import FPS, INSTRUCTION, QUICK_VIDEOS, Finished, command, copied, digests
from vcage.base.errors import EndpointFailed, PartlyDone
from vcage.base.files import RunFolder, read_json, sha256_file, write_json
from vcage.scenes import feasible_layout
from vcage.schema.episodes import Episodes
from vcage.stages import collect, compress
from vcage.stages.chain import STAGES

RUN = ["run", INSTRUCTION, "--models", "offline", "--episodes", "1", "--fps", str(FPS), *QUICK_VIDEOS]
LATER = [name.replace("_", "-") for name in list(STAGES)[1:]]
DOCUMENTS = {
    "select-place": "place/scene.json",
    "inpaint-plan": "inpaint/plan.json",
    "match": "match/matches.json",
    "optimize": "optimize/scene.json",
    "search-subtasks": "subtasks/subtasks.json",
    "collect": "episodes/episodes.json",
    "verify": "verify/verdicts.json",
    "compress": "compress/compression.json",
    "export": "export/export.json",
}
READS = {
    "inpaint-plan": "place/scene.json",
    "match": "inpaint/plan.json",
    "optimize": "match/matches.json",
    "search-subtasks": "optimize/scene.json",
    "collect": "subtasks/subtasks.json",
    "verify": "episodes/episodes.json",
    "compress": "episodes/episodes.json",
    "export": "compress/compression.json",
}
"""Command → the file of the stage before it."""


def arguments(stage: str, run: RunFolder) -> list[str]:
    """The command line of a stage as the finished run was made."""
    extra = {"collect": ["--episodes", "1", "--fps", str(FPS)], "compress": QUICK_VIDEOS}.get(stage, [])
    if stage == "select-place":
        return [stage, INSTRUCTION, "--out", str(run)]
    return [stage, "--run", str(run), *extra]


def before(finished: Finished, command_name: str, folder: Path) -> RunFolder:
    return copied(finished.run, folder / "run", before=command_name.replace("-", "_"))


@pytest.fixture
def run(finished: Finished, tmp_path) -> RunFolder:
    return copied(finished.run, tmp_path / "run")


# --- good input ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("stage", DOCUMENTS)
def test_a_finished_stage_reports_its_result_and_changes_nothing(finished, stage, capsys):
    files = digests(finished.run.root)
    answer = command(capsys, *arguments(stage, finished.run))
    assert answer.code == 0, answer.stderr
    assert answer.record["output"] == str(finished.run.root / DOCUMENTS[stage])
    assert answer.record["summary"]["fresh"] is False
    assert answer.record["schema"] == read_json(Path(answer.record["output"]))["schema"]
    assert str(finished.run) in answer.record["next"]
    assert digests(finished.run.root) == files


def test_a_finished_run_is_left_alone(run, capsys):
    files = digests(run.root)
    answer = command(capsys, *RUN, "--out", run)
    assert answer.code == 0
    assert answer.record["output"] == str(run.report) and run.report.is_file()
    assert answer.record["summary"]["accepted"] == 1
    assert digests(run.root) == files


def test_a_dry_run_lists_its_outputs_and_writes_nothing(finished, tmp_path, capsys):
    run = before(finished, "match", tmp_path)
    files = digests(run.root)
    answer = command(capsys, "match", "--run", run, "--dry-run")
    assert answer.record["summary"]["would"] == "write"
    assert answer.record["summary"]["inputs"].keys() >= {"place/scene.json", "inpaint/target.png"}
    assert command(capsys, *RUN, "--out", tmp_path / "new", "--dry-run").record["summary"]["would_run"] == list(STAGES)
    assert digests(run.root) == files and not (tmp_path / "new").exists()


def test_a_pair_of_pictures_is_judged(finished, capsys):
    episode = Episodes.read(finished.run.episodes).episodes[0]
    before, after = (
        next(
            str(finished.run.episodes.parent / name) for name in episode.verdicts[0].pictures if f"-{when}-top" in name
        )
        for when in ("before", "after")
    )
    pair = ["--subtask", episode.subtasks[0], "--before", before, "--after", after]
    answer = command(capsys, "verify", "--run", finished.run, "--models", "offline", *pair)
    assert answer.record["schema"] == "vcage.verdict/1"
    assert answer.record["summary"]["verdict"]["accepted"] is True
    answer = command(capsys, "verify", "--run", finished.run, *pair[:2])
    assert (answer.code, answer.error["code"]) == (2, "usage")


def test_a_run_with_other_episodes_remakes_the_stages_after_it(run, capsys, monkeypatch):
    def stop(*_: object, **__: object) -> None:
        raise PartlyDone("far enough")

    monkeypatch.setattr(compress, "compression_record", stop)
    record = read_json(run.episodes)
    record["episodes"][0]["reason"] = "as I saw it"
    write_json(run.episodes, record)
    answer = command(capsys, *RUN, "--out", run)
    assert answer.error["message"] == "far enough"
    assert read_json(run.verdicts)["provenance"]["inputs"]["episodes/episodes.json"] == sha256_file(run.episodes)


# --- what a command line can get wrong -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        (["select-place", INSTRUCTION, "--out", "x", "--colour", "red"], "--colour"),
        (["select-place", "--out", "x"], "instruction"),
        (["run", INSTRUCTION], "--out"),
        (["collect", "--run", "x", "--episodes", "0"], "not a positive number"),
        (["collect", "--run", "x", "--episodes", "many"], "many"),
        (["collect", "--run", "x", "--fps", "7"], "--fps"),
        (["collect", "--run", "x", "--retries", "-1"], "negative"),
        (["match", "--run", "x", "--threshold", "nan"], "between 0 and 1"),
        (["match", "--run", "x", "--threshold", "high"], "not a number"),
        (["match", "--run", "x", "--detector", "yolo"], "no detector is called 'yolo'"),
        (["match", "--run", "x", "--embedder", "clip:large"], "there are: classical, efficientnet, dinov2"),
        (["optimize", "--run", "x", "--margin", "-0.1"], "between 0 and 0.5"),
        (["optimize", "--run", "x", "--weights", "beauty=1"], "no term is called 'beauty'"),
        (["optimize", "--run", "x", "--weights", "reach"], "not a number"),
        (["optimize", "--run", "x", "--weights", "reach=-1"], "between 0 and"),
        (["compress", "--run", "x", "--max-loss", "inf"], "between 0 and 10"),
        (["inpaint-plan", "--run", "x", "--models", "oracle"], "oracle"),
        (["match", "--run", "x", "--seed", "-3"], "negative"),
        (["match", "--run", "x", "--seed", "9" * 30], "too large"),
        (["match", "--run", "x", "--seed", "two"], "'two' is not a whole number"),
        (["match", "--run", ""], "the folder has no name"),
        (["select-place", "word " * 300, "--out", "x"], "at most 1000"),
        (["select-place", "the \udcff apple", "--out", "x"], "control characters"),
    ],
)
def test_errors_of_the_command_line_exit_with_2(line, complaint, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    answer = command(capsys, *line)
    assert (answer.code, answer.error["code"]) == (2, "usage")
    assert complaint in answer.error["message"] and answer.error["hint"]
    assert len(answer.complaints) == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("line", "code", "complaint"),
    [
        (["Put the submarine on the plate"], "no_asset_fits", "submarine"),
        ([""], "usage", "instruction is empty"),
        ([INSTRUCTION, "--scene", "nowhere"], "unknown_name", "'nowhere'; available: bathroom"),
    ],
)
@pytest.mark.parametrize("name", ["select-place", "run"])
def test_an_instruction_that_cannot_be_met_exits_with_2(name, line, code, complaint, capsys, tmp_path):
    answer = command(capsys, name, *line, "--models", "offline", "--out", tmp_path / "run")
    assert (answer.code, answer.error["code"]) == (2, code)
    assert complaint in answer.error["message"] and answer.error["hint"]
    assert len(answer.complaints) == 1 and complaint in answer.complaints[0]
    assert not digests(tmp_path)


# --- what an earlier stage may have left ---------------------------------------------------------------


@pytest.mark.parametrize("stage", LATER)
def test_without_any_stage_before_it_says_so(stage, capsys, tmp_path):
    answer = command(capsys, stage, "--run", tmp_path)
    assert (answer.code, answer.error["code"]) == (3, "missing_stage")
    assert "select_place" in answer.error["hint"] and len(answer.complaints) == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("stage", READS)
def test_without_the_stage_before_it_names_that_stage(finished, stage, capsys, tmp_path):
    run = before(finished, stage, tmp_path)
    shutil.rmtree((run.root / READS[stage]).parent)
    files = digests(run.root)
    answer = command(capsys, *arguments(stage, run))
    assert (answer.code, answer.error["code"]) == (3, "missing_stage")
    assert READS[stage] in answer.error["message"]
    assert answer.error["details"]["stage"] in answer.error["hint"]
    assert len(answer.complaints) == 1 and digests(run.root) == files


@pytest.mark.parametrize("stage", READS)
def test_damaged_json_of_the_stage_before_is_named(finished, stage, capsys, tmp_path):
    run = before(finished, stage, tmp_path)
    path = run.root / READS[stage]
    path.write_text(path.read_text()[:-40])
    files = digests(run.root)
    answer = command(capsys, *arguments(stage, run))
    assert (answer.code, answer.error["code"]) == (3, "damaged_file")
    assert READS[stage] in answer.error["message"] and "--force" in answer.error["hint"]
    assert len(answer.complaints) == 1 and digests(run.root) == files


@pytest.mark.parametrize("stage", READS)
def test_json_of_another_schema_version_is_named(finished, stage, capsys, tmp_path):
    run = before(finished, stage, tmp_path)
    path = run.root / READS[stage]
    found = read_json(path)["schema"].split("/")[0] + "/99"
    write_json(path, {**read_json(path), "schema": found})
    answer = command(capsys, *arguments(stage, run))
    assert (answer.code, answer.error["code"]) == (3, "schema_mismatch")
    assert READS[stage] in answer.error["message"] and found in answer.error["message"]
    assert len(answer.complaints) == 1


def test_an_asset_that_the_library_lost_is_named(finished, capsys, tmp_path):
    run = before(finished, "search-subtasks", tmp_path)
    scene = read_json(run.layout)
    scene["objects"][0]["asset"] = "amphora"
    write_json(run.layout, scene)
    answer = command(capsys, "search-subtasks", "--run", run)
    assert (answer.code, answer.error["code"]) == (3, "bad_input_file")
    assert str(run.layout) in answer.complaints[0] and "amphora" in answer.complaints[0]
    assert answer.error["details"]["field"] == "objects.0.asset"


@pytest.mark.parametrize("stage", ["compress", "export", "report"])
@pytest.mark.parametrize("damage", ["cut", "overwritten", "emptied"])
def test_a_damaged_episode_is_named(finished, stage, damage, capsys, tmp_path):
    run = copied(finished.run, tmp_path / "run", before=None if stage == "report" else stage)
    path = run.root / Episodes.read(run.episodes).episodes[0].file
    data = path.read_bytes()
    path.write_bytes({"cut": data[: len(data) // 2], "overwritten": b"x" * 100 + data[100:], "emptied": b""}[damage])
    answer = command(capsys, stage, "--run", run)
    assert (answer.code, answer.error["code"]) == (3, "damaged_file"), answer.stderr
    assert path.name in answer.error["message"] and answer.error["hint"]
    assert len(answer.complaints) == 1
    assert stage == "report" or not (run.root / DOCUMENTS[stage]).parent.exists()


def test_a_stale_stage_is_refused_until_force(run, capsys):
    files = digests(run.root)
    line = ["match", "--run", run, "--models", "offline", "--threshold", "0.7"]
    answer = command(capsys, *line)
    assert (answer.code, answer.error["code"]) == (3, "stale_stage")
    assert "option threshold" in answer.error["message"] and "--force" in answer.error["hint"]
    assert digests(run.root) == files
    assert command(capsys, *line, "--force").code == 0
    assert read_json(run.matches)["provenance"]["options"] == {"threshold": 0.7}


def test_another_instruction_does_not_overwrite_a_run(run, capsys):
    files = digests(run.root)
    answer = command(capsys, "run", "Put the bread into the bread box", "--models", "offline", "--out", run)
    assert (answer.code, answer.error["code"]) == (3, "stale_stage")
    assert "option instruction" in answer.error["message"]
    assert digests(run.root) == files


# --- what a disk can do --------------------------------------------------------------------------------


@pytest.fixture
def small_disk(tmp_path) -> Iterator[Path]:
    """A file system of 1 MB, where this process may mount one."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = shutil.which("mount")
    if mount is None or subprocess.run([mount, "-t", "tmpfs", "-o", "size=1m", "none", folder]).returncode:
        pytest.skip("this user may not mount a file system")
    yield folder
    subprocess.run(["umount", folder], check=True)


def test_an_output_below_a_file_is_refused(tmp_path, capsys):
    (tmp_path / "file").write_text("mine")
    for out in (tmp_path / "file", tmp_path / "file" / "run"):
        answer = command(capsys, "select-place", INSTRUCTION, "--models", "offline", "--out", out)
        assert (answer.code, answer.error["code"]) == (2, "output_not_writable")
        assert str(tmp_path / "file") in answer.error["message"] and "--out" in answer.error["hint"]
    assert (tmp_path / "file").read_text() == "mine"


def test_a_read_only_disk_is_refused(small_disk, capsys):
    subprocess.run(["mount", "-o", "remount,ro", small_disk], check=True)
    answer = command(capsys, "select-place", INSTRUCTION, "--models", "offline", "--out", small_disk / "run")
    assert (answer.code, answer.error["code"]) == (2, "output_not_writable")
    assert len(answer.complaints) == 1


def test_a_full_disk_leaves_the_earlier_stages_and_nothing_half_written(finished, small_disk, capsys):
    run = before(finished, "inpaint-plan", small_disk)
    filler = small_disk / "filler"
    filler.write_bytes(b"x" * (shutil.disk_usage(small_disk).free - 100_000))
    files = digests(small_disk)
    answer = command(capsys, "inpaint-plan", "--run", run, "--models", "offline")
    assert (answer.code, answer.error["code"], answer.error["retryable"]) == (7, "disk_full", True)
    assert len(answer.complaints) == 1 and "no space left" in answer.complaints[0]
    assert digests(small_disk) == files
    filler.unlink()
    assert command(capsys, "inpaint-plan", "--run", run, "--models", "offline").code == 0
    assert digests(run.root / "inpaint") == digests(finished.run.root / "inpaint")


def test_a_disk_that_fills_up_while_episodes_are_written_loses_none(run, capsys, monkeypatch):
    files = digests(run.root)

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(collect.EpisodeRunner, "one", full)
    answer = command(capsys, *arguments("collect", run)[:3], "--episodes", "2", "--fps", str(FPS), "--workers", "1")
    assert (answer.code, answer.error["code"]) == (7, "disk_full")
    assert {k: v for k, v in digests(run.root).items() if ".collecting" not in k} == files


def test_an_endpoint_that_fails_leaves_the_earlier_result(run, capsys, monkeypatch):
    files = digests(run.root)

    def down(*_: object, **__: object) -> None:
        raise EndpointFailed("the endpoint answers 503", hint="try again later")

    monkeypatch.setattr(feasible_layout, "nearest_layout", down)
    answer = command(capsys, "optimize", "--run", run, "--force")
    assert (answer.code, answer.error["retryable"]) == (6, True)
    assert digests(run.root) == files
