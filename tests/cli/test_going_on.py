"""Every printed command runs unchanged: in any folder, with a PATH without vcage."""

from __future__ import annotations

import ast
import os
import re
import shlex
import subprocess
from pathlib import Path

import pytest

from tests.run_folders import INSTRUCTION, QUICK_VIDEOS, REPOSITORY, STAGES, Answer, Finished, command, copied, process
from vcage.base.commands import vcage_command
from vcage.base.files import RunFolder
from vcage.cli.arguments import parse
from vcage.cli.going_on import remembered, stage_command
from vcage.cli.main import COMMANDS, load
from vcage.stages import collect, export
from vcage.stages.match import Options

SOURCES = sorted((REPOSITORY / "vcage").rglob("*.py"))
PACKAGES = re.compile(r"\b(vcage [a-z]|pip install|make -C)")
"""How a text begins that names a command which is on no PATH."""

STAGE = re.compile(rf"\b({'|'.join(STAGES)}) --|\brun ({'|'.join(STAGES)})\b(?! first)")


def told(path: Path) -> list[ast.Call]:
    """The calls in a module that make a command."""
    text = path.read_text(encoding="utf-8")
    if "vcage_command" not in text:
        return []
    calls = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
    return [call for call in calls if isinstance(call.func, ast.Name) and call.func.id == "vcage_command"]


def sample(call: ast.Call) -> list[str]:
    """The words of a command printed by a module, with a likely value for everything known only at run time."""
    likely = {"part": "assets", "run": "/somewhere/a run", "imported[:8]": "mug"}
    likely |= {"str(folder)": "/a run/renders", "str(run.root / 'renders-compressed')": "/a run/renders-compressed"}
    likely |= {"folder.root": "/a campaign", "folder.plan_file": "/a campaign/plan.yml", "several": "--group"}
    likely |= {"folder.root / 'dataset'": "/a campaign/dataset", "again": "--force", "options.channels": "depth"}
    words = []
    for argument in call.args:
        value = argument.value if isinstance(argument, ast.Starred) else argument
        words.append(str(value.value) if isinstance(value, ast.Constant) else likely[ast.unparse(value)])
    return words


def literal_commands() -> list[list[str]]:
    """All commands printed by modules, each once, except those made from the call itself."""
    made_of_calls = {"main.py", "going_on.py"}
    found = {tuple(sample(call)) for path in SOURCES if path.name not in made_of_calls for call in told(path)}
    return sorted(map(list, found))


def run_as_told(command: str) -> Answer:
    return process(["sh", "-c", command], Path("/"))


@pytest.mark.parametrize("words", literal_commands(), ids=shlex.join)
def test_a_command_that_a_module_tells_is_one(words: list[str]) -> None:
    count = 2 if " ".join(words[:2]) in COMMANDS else 1
    name = " ".join(words[:count])
    if words[-1] == "--help":
        assert name in COMMANDS
    else:
        assert parse(load(name).options, words[count:], prog=name, text="", about="") is not None


@pytest.mark.slow
def test_the_commands_that_modules_tell_begin_as_processes_from_anywhere() -> None:
    one_of_each = {words[0]: words for words in literal_commands()}  # the test before reads the words of all
    for words in one_of_each.values():
        asked = f"{vcage_command(*(word for word in words if word != '--help'))} --help"
        done = subprocess.run(asked, shell=True, cwd="/", env={"PATH": os.defpath}, capture_output=True, text=True)
        assert done.returncode == 0 and done.stdout.startswith("usage: vcage"), asked


def test_no_text_names_a_command_that_would_not_run() -> None:
    trees = [ast.parse(path.read_text(encoding="utf-8")) for path in SOURCES]
    calls = [node for tree in trees for node in ast.walk(tree) if isinstance(node, ast.Call)]
    texts = {text for call in calls for text in _texts(call)}
    assert [text for text in texts if PACKAGES.search(text) or STAGE.search(text)] == []


def _texts(call: ast.Call) -> list[str]:
    """The texts among the arguments of a call that raises or tells something."""
    called = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
    if called.endswith(("argument", "field", "arg", "Field", "partial", "print")):
        return []
    arguments = [*call.args, *(keyword.value for keyword in call.keywords)]
    inside = [node for argument in arguments for node in ast.walk(argument)]
    return [node.value for node in inside if isinstance(node, ast.Constant) and isinstance(node.value, str)]


@pytest.mark.slow
def test_the_chain_is_gone_through_from_next_to_next_in_a_folder_with_spaces(
    finished: Finished, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    run = copied(finished.run, tmp_path / "it's a run")
    begun = shlex.join(["select-place", INSTRUCTION, "--out", str(run), "--models", "offline"])
    answer = run_as_told(f"{vcage_command()} {begun}")
    for later in (["collect", "--episodes", "1", "--fps", "5"], ["compress", *QUICK_VIDEOS]):
        command(capsys, *later, "--run", run)  # `next` repeats options given once
    steps = []
    while answer.record["next"]:
        assert answer.code == 0, answer.stderr
        steps.append(shlex.split(answer.record["next"])[1:])
        # A shell runs the first; the others are split as it would, in this process, which starts no interpreter.
        answer = command(capsys, *steps[-1]) if len(steps) > 1 else run_as_told(answer.record["next"])
    assert [step[0].replace("-", "_") for step in steps] == [*STAGES[1:], "report"]
    of = {step[0]: step for step in steps}
    assert all(step[1:3] == ["--run", str(run)] for step in steps)
    assert "offline" in of["search-subtasks"] and "offline" in of["verify"] and "--models" not in of["optimize"]
    assert {"--episodes", "1", "--fps", "5"} <= set(of["collect"]) and set(QUICK_VIDEOS) <= set(of["compress"])


def test_next_repeats_the_options_of_the_call_that_lacked_input(
    finished: Finished, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    run = copied(finished.run, tmp_path / "a run", before="search_subtasks")
    missed = command(capsys, "collect", "--run", run.root, "--episodes", "5", "--models", "offline")
    assert (missed.code, missed.error["code"]) == (3, "missing_stage")
    assert missed.record["next"] == vcage_command("search-subtasks", "--run", run, "--models", "offline")
    assert missed.error["hint"].endswith(missed.record["next"]) and missed.complaints[0].endswith(missed.record["next"])
    found = command(capsys, *shlex.split(missed.record["next"])[1:])
    assert found.record["next"] == vcage_command("collect", "--run", run, "--models", "offline", "--episodes", "5")


def test_a_destructive_command_is_offered_but_not_as_next(
    finished: Finished, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    run = copied(finished.run, tmp_path / "run", before="optimize")
    stale = command(capsys, "match", "--run", run.root, "--threshold", "0.9", "--models", "offline")
    assert stale.record["next"] is None
    asked = ["match", "--run", run, "--models", "offline", "--threshold", "0.9", "--force"]
    offered = stale.error["hint"].partition("replace it: ")[2]
    assert sorted(shlex.split(offered)) == sorted(shlex.split(vcage_command(*asked)))


def test_a_dry_run_offers_the_same_command_as_next(
    finished: Finished, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(finished.run.root.parent)
    told = command(capsys, "collect", "--run", finished.run.root.name, "--episodes", "9", "--dry-run")
    assert told.record["next"] == vcage_command("collect", "--run", finished.run, "--episodes", "9")


def test_wrong_options_lead_to_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert command(capsys, "match", "--rnu", "x").record["next"] == vcage_command("match", "--help")
    assert command(capsys).record["next"] == vcage_command("--help")


def test_options_no_longer_given_are_forgotten(tmp_path: Path) -> None:
    run = RunFolder(tmp_path)
    run.scene.parent.mkdir()
    with remembered(run, Options(models="offline", threshold=0.7)):
        pass
    assert stage_command("collect", run) == vcage_command("collect", "--run", run, "--models", "offline")
    with remembered(run, Options(threshold=0.7)):
        pass
    assert stage_command("collect", run) == vcage_command("collect", "--run", run)


def test_what_an_export_leaves_out_is_recorded_all_the_same(tmp_path: Path) -> None:
    run = RunFolder(tmp_path)
    run.scene.parent.mkdir()
    with remembered(run, collect.Options(channels=("rgb", "depth"))):
        pass
    with remembered(run, export.Options(exported_channels=("rgb",))):
        pass
    assert stage_command("collect", run) == vcage_command("collect", "--run", run, "--channels", "rgb", "depth")
    assert stage_command("export", run) == vcage_command("export", "--run", run, "--channels", "rgb")
