"""The table of commands, their help, and errors of usage."""

from __future__ import annotations

import importlib
import json
import subprocess
import sys

import pytest

from vcage import __version__
from vcage.cli.main import COMMANDS, main, script_main


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_explains_itself_with_examples(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([name, "--help"]) == 0
    out, _ = capsys.readouterr()
    assert out.startswith(f"usage: vcage {name}")
    assert f"\n  vcage {name}" in out


@pytest.mark.parametrize("name", COMMANDS)
def test_every_module_of_the_table_keeps_the_contract(name: str) -> None:
    module = importlib.import_module(COMMANDS[name][0])
    assert callable(module.add_arguments) and callable(module.execute)


def test_the_help_of_vcage_names_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    out, _ = capsys.readouterr()
    assert all(f"  {name} " in out for name in COMMANDS)


def test_the_version_is_that_of_the_package(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"vcage {__version__}\n"


@pytest.mark.parametrize("arguments", [[], ["no-such-command"], ["setup", "nothing"], ["doctor", "--unknown"]])
def test_errors_of_usage_exit_with_2_and_a_record(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    error = json.loads(out.splitlines()[-1])["error"]
    assert error["code"] in ("usage", "unknown_name")
    assert error["hint"]
    assert len(err.splitlines()) == 1


def test_a_script_shows_its_own_name(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "argv", ["/some/where/look.py", "--help"])
    assert script_main("doctor") == 0
    assert capsys.readouterr().out.startswith("usage: look.py ")


def test_help_imports_nothing_heavy() -> None:
    code = (
        "import sys; from vcage.cli.main import main; main(['--help']); "
        "print([name for name in ('numpy', 'pydantic', 'sapien', 'torch', 'rich') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"
