"""From a kept sub-task to a script that runs by itself."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.example_scenes import block_and_plate, scene_of, subtask
from vcage.base.errors import DamagedFile, MissingStage, UnknownName
from vcage.tasks.synthesis import Script, load_script, note_python, render_script, write_script

HOSTILE = [
    '"""; import os; os.system("touch owned")',
    "'''\nimport os",
    "a\\",
    '\\"""\nraise SystemExit',
    'he said "put it there"',
    "line one\nline two\r\nline three\u2028line four",
    "{{ scene.objects }} {% raw %} {# #}",
    "null \x00 and bell \x07",
    "backwards \u202e and \u200b unseen",
    '"',
]
texts = st.one_of(st.sampled_from(HOSTILE), st.text(min_size=1, max_size=60))
PLAIN = {**os.environ, "VCAGE_PYTHON": "", "VCAGE_HOME": "", "VCAGE_CACHE": "/nowhere", "PATH": "/usr/bin:/bin"}


def written(path: Path, text: str = "Put the block on the plate.", instruction: str = "Blocks on the plate") -> Script:
    return load_script(write_script(subtask(text=text), scene_of(block_and_plate(), instruction), path / "step.py"))


def run_without_vcage(script: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a script under a python that sees the standard library only."""
    command = [sys.executable, "-I", "-S", str(script), "--episodes", "2"]
    env = {**PLAIN, **environment}
    return subprocess.run(command, cwd=script.parent, env=env, capture_output=True, text=True, timeout=30)


def test_a_script_carries_the_scene_and_the_sub_task(tmp_path: Path):
    values = written(tmp_path).values
    assert set(values["SCENE"]) == {"block", "plate"}
    assert values["GRASPS"] == [(0, "left", -1.0)]
    assert values["GOALS"] == [("block", "on", "plate", None)]
    assert (values["TEMPLATE"], values["ROBOT"]) == ("table", "dual_panda")
    fields = {"template": "place", "object": "block", "receptacle": "plate", "functional_point": 0}
    assert values["SUBTASK"] == fields


def test_a_script_stays_under_sixty_lines(tmp_path: Path):
    lines = written(tmp_path).path.read_text().splitlines()
    assert len([line for line in lines if line.strip()]) < 60


def test_a_mistake_in_a_script_is_reported_with_its_line(tmp_path: Path):
    script = written(tmp_path)
    text = script.path.read_text().replace("    task.home()", "    tsak.home()")
    line = text.splitlines().index("    tsak.home()") + 1
    script.path.write_text(text)

    class Anything:
        def __getattr__(self, _name):
            return lambda *_args, **_options: None

    with pytest.raises(DamagedFile, match=f"line {line}: NameError: name 'tsak'"):
        load_script(script.path).play(Anything())


def test_a_script_with_an_unknown_name_is_reported_with_its_line(tmp_path: Path):
    script = written(tmp_path)
    line = next(n for n, text in enumerate(script.path.read_text().splitlines(), 1) if "task.pick" in text)

    class Nothing:
        def pick(self, *_args, **_options):
            raise UnknownName("object", "blok", ["block"])

    with pytest.raises(DamagedFile, match=f"line {line}: UnknownName: unknown object 'blok'"):
        load_script(script.path).play(Nothing())


def test_a_mistake_outside_the_script_is_not_relabelled(tmp_path: Path):
    script = written(tmp_path)
    script.path.write_text(f"{script.path.read_text()}\nplay = len\n")
    with pytest.raises(TypeError, match="len"):
        load_script(script.path).play(object())


def test_a_script_is_executable(tmp_path: Path):
    assert os.access(written(tmp_path).path, os.X_OK)


def test_a_script_plays_a_pick_a_place_and_the_way_home(tmp_path: Path):
    class Calls(list):
        def pick(self, *args, **options):
            self.append(("pick", *args, *options.values()))

        def place(self, *args, **options):
            self.append(("place", *args, *options.values()))

        def home(self):
            self.append(("home",))

    calls = Calls()
    written(tmp_path).play(calls)
    assert calls == [("pick", "block", [(0, "left")]), ("place", "plate", 0), ("home",)]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(text=texts, instruction=texts)
def test_the_words_of_a_model_come_back_as_they_were_and_never_become_code(tmp_path: Path, text: str, instruction: str):
    step = subtask(text=text, texts=[instruction])
    values = load_script(write_script(step, scene_of(block_and_plate(), instruction), tmp_path / "step.py")).values
    assert (values["TEXT"], values["TEXTS"]) == (text, [instruction])


@settings(deadline=None)
@given(text=texts, instruction=texts)
def test_the_words_of_a_model_add_no_statement_to_the_script(text: str, instruction: str):
    objects = block_and_plate()
    plain = ast.parse(render_script(subtask(), scene_of(objects)))
    hostile = ast.parse(render_script(subtask(text=text), scene_of(objects, instruction)))
    assert [type(node) for node in ast.walk(hostile)] == [type(node) for node in ast.walk(plain)]


@pytest.mark.parametrize("text", HOSTILE)
def test_the_docstring_of_a_script_hides_nothing(text: str):
    source = render_script(subtask(text=text), scene_of(block_and_plate(), text))
    assert all(c.isprintable() or c == "\n" for c in source)


def test_a_missing_script_error_names_the_stage_that_makes_it(tmp_path: Path):
    with pytest.raises(MissingStage, match=r"gone\.py") as caught:
        load_script(tmp_path / "gone.py")
    assert caught.value.maker == "search_subtasks"


def test_a_script_that_does_not_parse_names_the_line(tmp_path: Path):
    path = tmp_path / "edited.py"
    path.write_text("def play(task):\n    pass\n\ndef verify(task:\n")
    with pytest.raises(DamagedFile, match=r"edited\.py: line 4"):
        load_script(path)


def test_a_script_that_fails_while_it_is_loaded_says_how(tmp_path: Path):
    path = tmp_path / "edited.py"
    path.write_text("GRASPS = [(0, right)]\n")
    with pytest.raises(DamagedFile, match="NameError: name 'right' is not defined"):
        load_script(path)


@pytest.mark.parametrize("name", ["play", "verify"])
def test_a_script_without_one_of_its_functions_is_damaged(tmp_path: Path, name: str):
    script = written(tmp_path).path
    script.write_text(script.read_text().replace(f"def {name}(", "def other("))
    with pytest.raises(DamagedFile, match=f"defines no function {name}"):
        load_script(script)


def test_a_script_under_a_python_without_vcage_names_the_remedy(tmp_path: Path):
    done = run_without_vcage(written(tmp_path).path)
    assert done.returncode != 0
    assert "export VCAGE_PYTHON=" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_script_restarts_under_the_python_named_by_the_environment(tmp_path: Path):
    script = written(tmp_path).path
    other = tmp_path / "other-python"
    other.write_text("#!/bin/sh\necho called with $@\n")
    other.chmod(0o755)
    done = run_without_vcage(script, VCAGE_PYTHON=str(other))
    assert done.stdout.split() == ["called", "with", str(script), "--episodes", "2"]


def environment(folder: Path) -> Path:
    """A python that reports its use, in an environment of its own."""
    python = folder / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.write_text("#!/bin/sh\necho found\n")
    python.chmod(0o755)
    return python


def test_a_script_that_lies_anywhere_finds_the_python_that_generated_scripts_last(tmp_path: Path, monkeypatch):
    python = environment(tmp_path / "project")
    monkeypatch.setenv("VCAGE_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(sys, "executable", str(python))
    note_python()
    monkeypatch.undo()
    (tmp_path / "elsewhere").mkdir()
    script = written(tmp_path / "elsewhere").path
    assert run_without_vcage(script, VCAGE_CACHE=str(tmp_path / "cache")).stdout == "found\n"


def test_a_cache_that_cannot_be_written_is_no_reason_to_stop(monkeypatch):
    monkeypatch.setenv("VCAGE_CACHE", "/proc/nowhere")
    note_python()


@pytest.mark.parametrize("way", ["home", "command"])
def test_a_script_finds_the_environment_that_the_others_find(tmp_path: Path, way: str):
    python = environment(tmp_path / "project")
    command = python.with_name("vcage")
    command.write_text("#!/bin/sh\n")
    command.chmod(0o755)
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "vcage").symlink_to(command)
    (tmp_path / "elsewhere").mkdir()
    named = {"home": {"VCAGE_HOME": str(tmp_path / "project")}, "command": {"PATH": f"{tmp_path}/bin:/usr/bin:/bin"}}
    assert run_without_vcage(written(tmp_path / "elsewhere").path, **named[way]).stdout == "found\n"


def test_a_script_finds_the_environment_of_a_folder_above_it(tmp_path: Path):
    environment(tmp_path)
    folder = tmp_path / "runs" / "subtasks"
    folder.mkdir(parents=True)
    assert run_without_vcage(written(folder).path).stdout == "found\n"


def test_a_script_does_not_go_from_python_to_python_for_ever(tmp_path: Path):
    other = tmp_path / "other-python"
    other.write_text(f'#!/bin/sh\nexec {sys.executable} -I -S "$@"\n')
    other.chmod(0o755)
    done = run_without_vcage(written(tmp_path).path, VCAGE_PYTHON=str(other))
    assert done.returncode != 0
    assert "vcage is not installed" in done.stderr
