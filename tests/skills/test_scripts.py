"""The nine scripts as processes, with any Python and from anywhere, against the chain in one process."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

from tests.run_folders import (
    FOLDERS,
    FPS,
    INSTRUCTION,
    QUICK_VIDEOS,
    REPOSITORY,
    Answer,
    Finished,
    clean_environment,
    digests,
    process,
)

SCRIPTS = {
    "select_place": "igsc",
    "inpaint_plan": "igsc",
    "match": "igsc",
    "optimize": "igsc",
    "search_subtasks": "subtask-search",
    "collect": "collect",
    "verify": "vlm-verify",
    "compress": "compress",
    "export": "export",
}
"""Script → its skill, in the order of the chain."""


@pytest.fixture(scope="module")
def python() -> str:
    """A Python that is not the project's."""
    found = shutil.which("python3", path=os.defpath) or shutil.which("python3", path=clean_environment()["PATH"])
    if found is None:
        pytest.skip("this machine has no other python3")
    return found


def run_script(python: str, name: str, arguments: list[str], cwd: Path) -> Answer:
    return process(
        [python, REPOSITORY / "skills" / f"vcage-{SCRIPTS[name]}" / "scripts" / f"{name}.py", *arguments], cwd
    )


def test_the_nine_scripts_give_the_same_files_as_the_chain_in_one_process(finished: Finished, python, tmp_path):
    own = {"collect": ["--episodes", "1", "--fps", str(FPS)], "compress": QUICK_VIDEOS}
    # The slow part is done before, and left alone by a script with the same request; that other processes
    # make the same of it is for tests/test_chain.py and tests/cli/test_compress.py.
    done_before = ("collect", "compress")
    run = finished.run.root.name  # which data sets state
    for name in SCRIPTS:
        if name in done_before:
            shutil.copytree(finished.run.root / FOLDERS[name], tmp_path / run / FOLDERS[name])
        arguments = [INSTRUCTION, "--out", run] if name == "select_place" else ["--run", run, *own.get(name, [])]
        models = [] if name in ("optimize", "compress", "export") else ["--models", "offline"]
        answer = run_script(python, name, [*arguments, *models], tmp_path)
        assert answer.code == 0, answer.stderr
        assert answer.record["summary"]["fresh"] is (name not in done_before)
        assert Path(answer.record["output"]).is_file()
    scripts, chain = digests(tmp_path / run), digests(finished.run.root)
    assert [name for name in sorted({*scripts, *chain}) if scripts.get(name) != chain.get(name)] == []


def test_a_script_that_fails_says_so_in_one_line_and_a_record(python, tmp_path):
    answer = run_script(python, "match", ["--run", "nothing-here"], tmp_path)
    assert (answer.code, answer.error["code"]) == (3, "missing_stage")
    assert len(answer.complaints) == 1 and str(tmp_path / "nothing-here") in answer.complaints[0]
    assert not list(tmp_path.iterdir())
