"""Printed commands run unchanged."""

from __future__ import annotations

import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from vcage.base.commands import pip_command, vcage_command


def test_a_command_names_the_program_of_this_environment_and_is_quoted_for_a_shell() -> None:
    program, *words = shlex.split(vcage_command("collect", "--run", Path("/a folder/it's")))
    assert Path(program) == Path(sys.executable).with_name("vcage")
    assert words == ["collect", "--run", "/a folder/it's"]


def test_where_no_program_lies_beside_the_interpreter_the_package_is_run(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    assert vcage_command("doctor") == f"{tmp_path / 'python'} -m vcage.cli.main doctor"


def test_pip_is_that_of_this_environment() -> None:
    told = subprocess.run(f"{pip_command()} --help", shell=True, cwd="/", env={}, capture_output=True, text=True)
    assert told.returncode == 0 and "pip install" in told.stdout
