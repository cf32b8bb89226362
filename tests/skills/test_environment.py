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

SCRIPT = files.resource("skills", "vcage-igsc", "scripts", "match.py")
SKILLS = sorted(path.parent for path in files.resource("skills").glob("*/SKILL.md"))
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
    return folder / "skills" / "vcage-igsc" / "scripts" / "match.py"


def fake_python(folder: Path) -> Path:
    """A program that prints its arguments, and that search paths were removed."""
    python = folder / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.write_text('#!/bin/sh\necho "$@" "path:$PYTHONPATH" "$VCAGE_RESTARTED"\n')
    python.chmod(0o755)
    return python


def test_another_interpreter_hands_over_to_the_environment_named() -> None:
    done = run(SCRIPT, "--help", VCAGE_PYTHON=sys.executable)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("usage: match.py ")


def test_the_projects_own_interpreter_continues_without_a_restart() -> None:
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


def test_a_linked_skill_finds_its_checkout(tmp_path: Path) -> None:
    script = copy_of_skills(tmp_path / "a checkout")
    fake_python(tmp_path / "a checkout")
    (tmp_path / "client").symlink_to(script.parents[1])
    done = run(tmp_path / "client" / "scripts" / "match.py", "--run", "x")
    assert done.stdout.endswith("match.py --run x path: 1\n")


def test_without_an_environment_the_command_that_makes_it_is_named_and_next(tmp_path: Path) -> None:
    script = copy_of_skills(tmp_path / "a checkout")
    (tmp_path / "a checkout" / "Makefile").touch()
    (tmp_path / "a checkout" / "vcage").mkdir()
    done = run(script)
    assert done.returncode == 4
    record = json.loads(done.stdout)
    assert record["error"]["code"] == "configuration"
    assert record["next"] == f"make -C '{tmp_path / 'a checkout'}' setup" and record["error"]["hint"].endswith(
        record["next"]
    )
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize("skill", SKILLS, ids=lambda path: path.name)
def test_a_skill_installed_alone_says_how_to_get_the_project(skill: Path, tmp_path: Path) -> None:
    alone = shutil.copytree(skill, tmp_path / skill.name, ignore=shutil.ignore_patterns("__pycache__"))
    for script in sorted(alone.glob("scripts/*.py")):
        if script.name == "vcage_environment.py":
            continue
        done = run(script, "--help", HOME=str(tmp_path))
        record = json.loads(done.stdout)
        assert (done.returncode, record["ok"], record["next"]) == (4, False, None), script
        assert "VCAGE_HOME" in record["error"]["hint"] and "Traceback" not in done.stderr


@pytest.mark.parametrize("skill", SKILLS, ids=lambda path: path.name)
def test_a_skill_installed_alone_works_with_a_given_project(skill: Path, tmp_path: Path) -> None:
    alone = shutil.copytree(skill, tmp_path / skill.name, ignore=shutil.ignore_patterns("__pycache__"))
    fake_python(tmp_path / "home")
    for script in sorted(alone.glob("scripts/*.py")):
        if script.name != "vcage_environment.py":
            assert str(script) in run(script, VCAGE_HOME=str(tmp_path / "home")).stdout


def test_a_command_installed_for_the_user_is_found_off_the_path(tmp_path: Path) -> None:
    script = copy_of_skills(tmp_path / "copied")
    command = tmp_path / ".local" / "bin" / "vcage"
    command.parent.mkdir(parents=True)
    command.write_text(f"#!{fake_python(tmp_path / 'home')}\n")
    command.chmod(0o755)
    assert str(script) in run(script, HOME=str(tmp_path)).stdout


def test_an_environment_that_was_never_finished_does_not_restart_for_ever(tmp_path: Path) -> None:
    script = copy_of_skills(tmp_path)
    python = tmp_path / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.symlink_to(OTHER_PYTHON)
    assert run(script).returncode == 4


def test_a_missing_interpreter_is_named() -> None:
    done = run(SCRIPT, VCAGE_PYTHON="/not/there")
    assert done.returncode == 4
    assert "/not/there" in done.stderr
