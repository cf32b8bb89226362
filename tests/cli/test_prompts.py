"""``vcage prompts show`` prints the questions of a stage without asking anyone."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.run_folders import command, copied, digests
from vcage.base.files import RunFolder, write_json

TASK = "Put the red block and the green block into the box"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that rules have planned, in a folder with a space in its name."""
    return tmp_path_factory.mktemp("with space") / "run"


@pytest.fixture
def planned(run: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    if not run.exists():
        assert command(capsys, "select-place", TASK, "--models", "offline", "--out", str(run)).code == 0
    return run


@pytest.mark.parametrize(
    ("name", "stage"),
    [("select_assets", ("select-place", TASK, "--out")), ("plan_layout", ("inpaint-plan", "--run"))],
)
def test_the_shown_prompt_is_the_agents(
    planned: Path, name: str, stage: tuple[str, ...], tmp_path: Path, capsys
) -> None:
    shown = command(capsys, "prompts", "show", name, "--run", str(planned))
    asked = command(capsys, *stage, str(planned), "--models", "agent", "--force").error["details"]["asked"][0]
    assert Path(asked["folder"]).name == f"reasoner-{shown.record['summary']['hash'][:12]}"
    prompt = (Path(asked["folder"]) / "prompt.md").read_text()
    assert len(prompt) >= shown.record["summary"]["characters"]


def test_showing_changes_nothing_in_the_run(planned: Path, capsys) -> None:
    before = digests(planned)
    shown = command(capsys, "prompts", "show", "rearrange", "--run", str(planned))
    assert (shown.code, shown.record["summary"]["pictures"]) == (0, ["the picture to edit"])
    assert digests(planned) == before


def test_missing_input_is_reported_with_its_path_and_the_command_that_makes_it(planned: Path, capsys) -> None:
    ended = command(capsys, "prompts", "show", "judge_pairs", "--run", str(planned))
    assert (ended.code, ended.error["details"]["missing"]) == (3, str(planned / "optimize" / "scene.json"))


def test_a_folder_without_a_run_is_named(tmp_path: Path, capsys) -> None:
    ended = command(capsys, "prompts", "show", "plan_layout", "--run", str(tmp_path / "none"))
    assert ended.code == 3 and "none" in ended.error["message"]


def test_options_that_were_damaged_are_named_with_their_file(planned: Path, tmp_path: Path, capsys) -> None:
    run = copied(RunFolder(planned), tmp_path / "run", before="inpaint_plan")
    write_json(run.options, {"models": ["--models", "nobody"]})
    answer = command(capsys, "prompts", "show", "plan_layout", "--run", run)
    assert answer.code == 3 and str(run.options) in answer.error["message"] and "nobody" in answer.error["message"]
    assert answer.error["hint"].startswith("fix it")
