"""Commands in odd surroundings: one clear line, the exit code, JSON where stdout takes it, and no traceback."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from vcage.base import files

VCAGE = f"{sys.executable} -m vcage.cli.main"
SCRIPT = f"{sys.executable} {files.resource('skills', 'vcage-objects', 'scripts', 'assets_list.py')}"
LIST = "robots list"


def shell(command: str, folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(
        ["bash", "-c", command], capture_output=True, text=True, cwd=folder, env={**os.environ, **variables}
    )
    assert "Traceback" not in done.stderr + done.stdout
    return done


def last_record(done: subprocess.CompletedProcess[str]) -> dict:
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.slow
@pytest.mark.parametrize("program", [f"{VCAGE} {LIST}", SCRIPT])
def test_a_closed_stdout_is_reported_and_the_command_completes(tmp_path: Path, program: str) -> None:
    done = shell(f"{program} >&-", tmp_path)
    assert (done.returncode, done.stderr) == (0, "vcage: stdout is closed, so the result is not printed\n")


@pytest.mark.slow
@pytest.mark.parametrize("closed", ["2>&-", "<&- 2>&-", "2>/dev/full"])
def test_without_stderr_stdout_has_the_record_alone(tmp_path: Path, closed: str) -> None:
    done = shell(f"{VCAGE} match --run /nowhere {closed}", tmp_path)
    assert (done.returncode, len(done.stdout.splitlines())) == (3, 1)
    assert last_record(done)["ok"] is False


def test_an_opened_file_does_not_replace_a_closed_stream(tmp_path: Path) -> None:
    code = "from vcage.cli.process import prepare; prepare(); print(open('a', 'w').fileno(), file=open('b', 'w'))"
    shell(f'{sys.executable} -c "{code}" <&- >&- 2>&-', tmp_path)
    assert int((tmp_path / "b").read_text()) > 2


@pytest.mark.parametrize("command", [LIST, "--help", "robots list --help"])
def test_a_full_stdout_is_reported_on_stderr(tmp_path: Path, command: str) -> None:
    done = shell(f"{VCAGE} {command} >/dev/full", tmp_path)
    assert done.returncode == 7
    assert "No space left" in done.stderr


def test_a_reader_of_the_help_that_went_away_is_no_error(tmp_path: Path) -> None:
    done = shell(f"{VCAGE} --help | true; exit ${{PIPESTATUS[0]}}", tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.slow
def test_a_stdout_of_ascii_gets_escapes(tmp_path: Path) -> None:
    done = shell(f"{VCAGE} match --run {tmp_path}/Bücher", tmp_path, LC_ALL="C", PYTHONIOENCODING="ascii")
    assert done.returncode == 3 and done.stdout.isascii()
    assert "Bücher" in last_record(done)["error"]["message"]
    assert shell(f"{VCAGE} assets --help", tmp_path, LC_ALL="C", PYTHONIOENCODING="ascii").returncode == 0


@pytest.mark.parametrize("program", [f"{VCAGE} {LIST}", SCRIPT])
def test_a_removed_folder_is_named(tmp_path: Path, program: str) -> None:
    (tmp_path / "gone").mkdir()
    done = shell(f"cd gone; rmdir ../gone; {program}", tmp_path, PYTHONPATH=str(Path(files.__file__).parents[2]))
    assert done.returncode == 2 and done.stderr.count("\n") == 1
    assert last_record(done)["error"]["message"] == "the current folder was removed"


def test_too_few_open_files_are_refused_and_a_low_soft_limit_is_raised(tmp_path: Path) -> None:
    done = shell(f"ulimit -n 40; {VCAGE} {LIST}", tmp_path)
    assert done.returncode == 4 and "ulimit -n" in last_record(done)["error"]["hint"]
    assert shell(f"ulimit -Sn 40; {VCAGE} {LIST}", tmp_path).returncode == 0


IMPORTS = """
import subprocess, sys
import vcage.cli
import yaml, only_there
assert subprocess.run([sys.executable, "-Pc", "import yaml, only_there"]).returncode == 0
"""


@pytest.mark.parametrize("named", ["{}", "{}/", "{}/../{name}", ":/usr"])
def test_packages_of_another_interpreter_do_not_shadow_ours_here_or_in_child_processes(
    tmp_path: Path, named: str
) -> None:
    (tmp_path / "yaml.py").write_text("raise SyntaxError('for another Python')")
    (tmp_path / "only_there.py").touch()
    path = named.format(tmp_path, name=tmp_path.name)
    done = shell(f"{sys.executable} -Pc '{IMPORTS}'", tmp_path, PYTHONPATH=path)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("variables", [{}, {"PYTHONPATH": "."}], ids=["beside", "PYTHONPATH"])
def test_modules_of_others_do_not_come_before_pythons_own_and_ours(tmp_path: Path, variables: dict[str, str]) -> None:
    for name in ("json", "dataclasses", "tyro"):
        (tmp_path / f"{name}.py").write_text("raise RuntimeError('for another Python')")
    done = shell(f"{VCAGE} {LIST}", tmp_path, **variables)
    assert done.returncode == 0 and last_record(done)["ok"]


def test_a_package_that_does_not_load_is_no_bug(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text("from vcage.cli.main import main; raise SystemExit(main())")
    (tmp_path / "tyro.py").write_text("raise ImportError('libGL.so.1: cannot open shared object file', name='tyro')")
    done = shell(f"{sys.executable} program.py {LIST}", tmp_path)
    error = last_record(done)["error"]
    assert (done.returncode, error["code"]) == (4, "missing_dependency")
    assert "libGL.so.1" in error["message"] and "doctor" in error["hint"]
