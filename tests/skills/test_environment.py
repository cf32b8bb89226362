"""Scripts find the project's environment under any interpreter, or say how to make it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from vcage.base import files

SCRIPT = files.resource("skills", "igsc", "scripts", "match.py")
OTHER_PYTHON = Path(sys._base_executable).resolve()
"""The interpreter that the environment was made from: it cannot import vcage."""

pytestmark = pytest.mark.skipif(sys.prefix == sys.base_prefix, reason="the tests run outside an environment")


def run(
    script: Path, *arguments: str, python: Path = OTHER_PYTHON, **variables: str
) -> subprocess.CompletedProcess[str]:
    """Run a script in an almost empty environment, from the root folder."""
    environment = {"PATH": os.defpath, **variables}
    command = [str(python), str(script), *arguments]
    return subprocess.run(command, env=environment, cwd="/", capture_output=True, text=True)


def copy_of_skills(folder: Path) -> Path:
    """The skills without a checkout around them; returns the script."""
    shutil.copytree(files.resource("skills"), folder / "skills")
    return folder / "skills" / "igsc" / "scripts" / "match.py"


def fake_python(folder: Path) -> Path:
    """A program that says with which arguments it was called, and that search paths were taken away."""
    python = folder / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.write_text('#!/bin/sh\necho "$@" "path:$PYTHONPATH" "$VCAGE_RESTARTED"\n')
    python.chmod(0o755)
    return python


def test_another_interpreter_hands_over_to_the_environment_named() -> None:
    done = run(SCRIPT, "--help", VCAGE_PYTHON=sys.executable)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("usage: match.py ")


def test_the_projects_own_interpreter_goes_on_without_a_restart() -> None:
    done = run(SCRIPT, "--help", python=Path(sys.executable), VCAGE_PYTHON=sys.executable)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("usage: match.py ")


def test_the_environment_of_the_checkout_is_found_and_gets_the_same_arguments(tmp_path: Path) -> None:
    script = copy_of_skills(tmp_path)
    fake_python(tmp_path)
    done = run(script, "--run", "a b", PYTHONPATH="/for/another/python")
    assert done.stdout.split("\n")[0] == f"{script} --run a b path: 1"


def test_vcage_home_names_another_checkout(tmp_path: Path) -> None:
    script = copy_of_skills(tmp_path / "copied")
    fake_python(tmp_path / "home")
    assert str(script) in run(script, VCAGE_HOME=str(tmp_path / "home")).stdout


def test_the_command_on_the_path_is_the_last_resort(tmp_path: Path) -> None:
    script = copy_of_skills(tmp_path / "copied")
    python = fake_python(tmp_path / "home")
    command = tmp_path / "bin" / "vcage"
    command.parent.mkdir()
    command.write_text(f"#!{python}\n")
    command.chmod(0o755)
    assert str(script) in run(script, PATH=f"{command.parent}:{os.defpath}").stdout


def test_without_an_environment_the_command_that_makes_it_is_named(tmp_path: Path) -> None:
    script = copy_of_skills(tmp_path)
    (tmp_path / "Makefile").touch()
    done = run(script)
    assert done.returncode == 4
    error = json.loads(done.stdout.splitlines()[-1])["error"]
    assert error["code"] == "configuration"
    assert error["hint"] == f"run: make -C {tmp_path} venv"
    assert len(done.stderr.splitlines()) == 1


def test_an_environment_that_was_never_finished_does_not_restart_for_ever(tmp_path: Path) -> None:
    script = copy_of_skills(tmp_path)
    python = tmp_path / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.symlink_to(OTHER_PYTHON)
    assert run(script).returncode == 4


def test_an_interpreter_that_is_not_there_is_named() -> None:
    done = run(SCRIPT, VCAGE_PYTHON="/not/there")
    assert done.returncode == 4
    assert "/not/there" in done.stderr
