"""A generated sub-task script that is run by itself."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path

import pytest

from tests.run_folders import FPS, Finished, command, process
from vcage.base.files import RunFolder
from vcage.cli.subtask import run_script
from vcage.datasets.reader import EpisodeReader
from vcage.schema.episodes import Episodes
from vcage.schema.subtasks import Subtasks


@pytest.fixture
def script(finished: Finished) -> Path:
    """The first script of the chain."""
    record = Subtasks.read(finished.run.subtasks)
    return finished.run.root / next(s.script for s in record.kept if s.id == record.chains[0].subtasks[0])


def error_of(capsys: pytest.CaptureFixture[str]) -> dict:
    return json.loads(capsys.readouterr().out.splitlines()[-1])["error"]


@pytest.mark.slow
def test_it_collects_its_own_episodes_and_other_commands_continue_from_there(finished, script, tmp_path, capsys):
    run = RunFolder(tmp_path / "one")
    line = ["--episodes", "1", "--fps", str(FPS), "--models", "offline", "--out", run.root]
    answer = process([sys.executable, script, *line], cwd=tmp_path)
    assert answer.code == 0, answer.stderr
    assert answer.record["summary"]["accepted"] == 1
    (episode,) = Episodes.read(run.episodes).episodes
    with EpisodeReader(run.root / episode.file) as reader:
        assert [s.subtask for s in reader.episode.segments] == [script.stem]
        assert reader.cameras == ["cam_high", "cam_left_wrist", "cam_right_wrist", "front"]
    answer = command(capsys, "verify", "--run", run, "--models", "offline")
    summary = answer.record["summary"]
    assert (answer.code, summary["verified"], summary["taken_over"], summary["differ"]) == (0, 1, 1, 0)


def test_the_help_describes_the_command(script, capsys):
    assert run_script(str(script), ["--help"]) == 0
    out = capsys.readouterr().out
    assert Subtasks.read(script.with_name("subtasks.json")).kept[0].template == "place"
    assert out.startswith(f"usage: {script.name}") and "--episodes" in out


@pytest.mark.parametrize("line", [[], ["--out", "x", "--episodes", "0"], ["--out", "x", "--speed", "9"]])
def test_errors_of_its_command_line_exit_with_2(script, line, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run_script(str(script), line) == 2
    assert error_of(capsys)["code"] == "usage"
    assert not list(tmp_path.iterdir())


def test_a_script_that_lost_a_value_is_named(script, tmp_path, capsys):
    broken = tmp_path / script.name
    broken.write_text(script.read_text().replace("GRASPS = [", "GRABS = ["))
    assert run_script(str(broken), ["--out", str(tmp_path / "run")]) == 3
    error = error_of(capsys)
    assert (error["code"], "GRASPS" in error["message"]) == ("damaged_file", True)


def test_a_script_edited_for_another_asset_names_the_missing_parts(script, tmp_path, capsys):
    broken = tmp_path / script.name
    broken.write_text(script.read_text().replace("('plate', 'white'", "('platter', 'white'"))
    assert run_script(str(broken), ["--out", str(tmp_path / "run")]) == 3
    assert "platter" in error_of(capsys)["message"]


def test_a_folder_that_holds_another_scene_is_not_overwritten(finished, script, tmp_path, capsys):
    folder = tmp_path / "run"
    shutil.copytree(finished.run.root / "optimize", folder / "optimize")
    before = (folder / "optimize" / "scene.json").read_bytes()
    assert run_script(str(script), ["--out", str(folder)]) == 3
    assert error_of(capsys)["code"] == "stale_stage"
    assert (folder / "optimize" / "scene.json").read_bytes() == before
