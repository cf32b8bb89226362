"""The table of commands, their help, and errors of usage."""

from __future__ import annotations

import json
import re
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


def test_every_option_of_every_command_is_explained(capsys: pytest.CaptureFixture[str]) -> None:
    bare = {}
    for name in COMMANDS:
        main([name, "--help"])
        boxes = capsys.readouterr().out.split("\noptions:\n")[1]
        explained = re.findall(r"^  (-\S.*?)(?:   *\S|\n {8,}\S)", boxes, re.MULTILINE)
        bare[name] = set(re.findall(r"^  (-\S+)", boxes, re.MULTILINE)) - {option.split()[0] for option in explained}
    assert {name: options for name, options in bare.items() if options} == {}


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


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ("optimize", "missing: --run DIR (the run folder)"),
        ("optimize --run x --restarts abc", "--restarts: 'abc' is not a whole number"),
        ("optimize --run x --bogus 3", "there is no option --bogus"),
        ("optimize --run x --margn 3", "there is no option --margn; did you mean --margin? "),
        ("optimize --run", "--run needs a value"),
        ("optimize --run x more", "one word too many: more"),
        ("compress --run x --codec gif", "--codec: there is no 'gif'; there are: hevc, h264, av1"),
        ("decompress", "folder of them); --out DIR (the folder to write; it must be new)"),
        ("assets lst", "unknown command 'assets lst'; available: assets gallery, assets import, assets list,"),
    ],
)
def test_an_error_of_usage_names_the_option_and_the_way_out(
    arguments: str, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments.split()) == 2
    _, err = capsys.readouterr()
    assert told in err
    assert err.count("\n") == 1
    assert "did you mean" in err or "--help" in err
