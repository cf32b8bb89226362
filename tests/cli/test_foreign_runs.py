"""Commands on a run folder of somebody else neither read nor write outside of it, and execute nothing in it."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from tests.run_folders import INSTRUCTION, Finished, command
from vcage.base.files import PRODUCERS, RunFolder, read_json, sha256_file, write_json
from vcage.cli.going_on import words_of
from vcage.runs.edits import seal
from vcage.schema.episodes import Episodes
from vcage.schema.export import Export

OFFLINE = ("--models", "offline")
COMMANDS = {
    "inpaint-plan": ("inpaint-plan", "--run", "{run}", *OFFLINE),
    "match": ("match", "--run", "{run}", *OFFLINE),
    "optimize": ("optimize", "--run", "{run}"),
    "search-subtasks": ("search-subtasks", "--run", "{run}", *OFFLINE),
    "collect": ("collect", "--run", "{run}", *OFFLINE, "--force"),
    "verify": ("verify", "--run", "{run}", *OFFLINE),
    "compress": ("compress", "--run", "{run}", "--force"),
    "export": ("export", "--run", "{run}", "--append-to", "{run}-sets"),
    "merge": ("merge", "{run}", "--out", "{run}-merged"),
    "run": ("run", INSTRUCTION, "--out", "{run}", *OFFLINE),
    "report": ("report", "--run", "{run}"),
    "replay": ("replay", "{run}"),
    "render": ("render", "{run}", "--workers", "1"),
    "view": ("view", "{run}", "--save", "{run}.rrd"),
    "prompts show": ("prompts", "show", "judge_subtask", "--run", "{run}"),
}
THAT_READ_EPISODES = ("verify", "compress", "export", "merge", "report", "replay", "render", "view")


@pytest.fixture(scope="module")
def foreign(finished: Finished, tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    """A copy of the finished run, for tests that leave it as it is."""
    folder = tmp_path_factory.mktemp("foreign") / "run"
    shutil.copytree(finished.run.root, folder)
    return RunFolder(folder)


def told_by(capsys, name: str, run: RunFolder):
    return command(capsys, *(word.format(run=run.root) for word in COMMANDS[name]))


@pytest.fixture
def linked(foreign: RunFolder, tmp_path: Path):
    """The run with its episodes elsewhere, and their files."""
    elsewhere = tmp_path / "elsewhere"
    episodes = foreign.root / "episodes"
    shutil.move(episodes, elsewhere)
    episodes.symlink_to(elsewhere)
    yield RunFolder(foreign.root), elsewhere
    episodes.unlink()
    shutil.move(elsewhere, episodes)


@pytest.mark.parametrize("name", COMMANDS)
def test_a_stage_folder_must_not_be_a_link(name: str, linked, capsys) -> None:
    run, elsewhere = linked
    before = {path: sha256_file(path) for path in elsewhere.rglob("*") if path.is_file()}
    answer = told_by(capsys, name, run)
    assert answer.code == 3 and f"{run.root / 'episodes'} is a symbolic link" in answer.error["message"]
    assert {path: sha256_file(path) for path in elsewhere.rglob("*") if path.is_file()} == before
    assert not (run.root / "in-use").exists()


@pytest.mark.parametrize("name", THAT_READ_EPISODES)
def test_an_episode_elsewhere_is_refused_by_file_and_field_though_it_was_sealed(name, foreign, capsys) -> None:
    before = foreign.episodes.read_bytes()
    was = foreign.episodes.with_name(".written.json").read_bytes()
    record = Episodes.read(foreign.episodes)
    there = record.episodes[0].model_copy(update={"file": str(foreign.root.parent / "secret.hdf5")})
    seal(record.model_copy(update={"episodes": [there]}), foreign.episodes)
    answer = told_by(capsys, name, foreign)
    foreign.episodes.write_bytes(before)
    foreign.episodes.with_name(".written.json").write_bytes(was)
    assert answer.code == 3 and f"{foreign.episodes}: field episodes.0.file" in answer.error["message"]


def test_a_data_set_that_says_its_videos_are_elsewhere_is_not_added_to_others(foreign, tmp_path, capsys) -> None:
    for info in foreign.root.glob("export/*/meta/info.json"):
        write_json(info, {**read_json(info), "video_path": "/etc/passwd"})
    seal(Export.read(foreign.export), foreign.export)
    answer = command(capsys, "export", "--run", foreign.root, "--append-to", tmp_path / "sets")
    assert answer.code == 3 and "info.json: video_path" in answer.error["message"]


FOREIGN_WORDS = {
    "a script": {"script": ["--script", "/tmp/x.py"]},
    "a script under another name": {"seed": ["--script", "/tmp/x.py"]},
    "another option": {"seed": ["--seed", "1", "--script", "/tmp/x.py"]},
    "force": {"seed": ["--force"]},
    "no words": {"seed": "--force", "episodes": [7]},
    "no options": ["--force"],
}


@pytest.mark.parametrize("given", FOREIGN_WORDS.values(), ids=FOREIGN_WORDS)
def test_options_that_somebody_wrote_into_the_folder_do_not_reach_a_command(given, tmp_path: Path) -> None:
    run = RunFolder(tmp_path)
    run.options.write_text(json.dumps(given))
    assert words_of("collect", run) == ["--run", str(tmp_path)]


def test_every_command_of_a_run_is_among_these() -> None:
    assert {name.replace("_", "-") for name in PRODUCERS.values()} - {"select-place"} <= set(COMMANDS)
