"""From a kept sub-task to a Python script that a person can read and run.

The text of a model never becomes code: only validated slots (ids, point numbers, closed words, quoted strings)
are rendered into the template.
"""

from __future__ import annotations

import ast
import contextlib
import functools
import runpy
import sys
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jinja2

from vcage.base.errors import DamagedFile, MissingStage, UnknownName, VcageError
from vcage.base.files import cache_path, write_text
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Grasp, Subtask
from vcage.tasks.templates import TEMPLATES

FIELDS_ELSEWHERE = {"id", "text", "texts", "grasps", "requires", "goals", "statements", "script", "checks"}
"""Fields that a script's SUBTASK leaves out: those with names of their own, and those that follow from the script."""


def render_script(subtask: Subtask, scene: Scene) -> str:
    """The script's source."""
    text = _page().render(
        subtask=subtask,
        scene=scene,
        fields=subtask.model_dump(exclude=FIELDS_ELSEWHERE, exclude_none=True),
        grasps=_grasp_rows(subtask.grasps),
        goals=[(g.subject, g.relation, g.reference, g.part) for g in subtask.goals],
        requires=[(g.subject, g.relation, g.reference, g.part) for g in subtask.requires],
        statements=[(s.subject, s.word, s.reference, s.part) for s in subtask.statements],
        calls=TEMPLATES[subtask.template].calls(subtask),
    )
    ast.parse(text)
    return text


def write_script(subtask: Subtask, scene: Scene, path: Path) -> Path:
    """Write the script, executable.

    Args:
        subtask: to be done by the script.
        scene: its objects, ready for the sub-task.
        path: of the script.
    """
    write_text(path, render_script(subtask, scene))
    path.chmod(0o755)
    return path


def note_python() -> None:
    """Note in the user's cache which Python runs scripts: a script in any folder finds it there, under any other."""
    with contextlib.suppress(VcageError, OSError):  # a cache that cannot be written
        write_text(cache_path("python"), f"{sys.executable}\n")


@dataclass(frozen=True)
class Script:
    """The motions of a sub-task and the question to the critic: generated, or loaded from a file.

    Args:
        path: of the file; of a generated one its future name.
        play: the robot's actions, called with a task.
        verify: the question to the critic, called with a task.
        values: its upper-case names (SCENE, TEXT, GRASPS…).
    """

    path: Path
    play: Callable[[Any], None]
    verify: Callable[[Any], Any]
    values: dict[str, Any]

    def try_grasps(self, grasps: Sequence[Grasp]) -> None:
        """Let the script try these, best first, in place of its own."""
        self.values["GRASPS"][:] = _grasp_rows(grasps)

    def tries(self, grasps: Sequence[Grasp]) -> bool:
        """Check if it tries just these grasps."""
        return self.values.get("GRASPS") == _grasp_rows(grasps)


def _grasp_rows(grasps: Sequence[Grasp]) -> list[tuple[int, str, float]]:
    return [(grasp.contact, grasp.arm, grasp.score) for grasp in grasps]


def script_of(subtask: Subtask) -> Script:
    """The script of a sub-task, generated from its validated slots; no file is executed."""
    values = {"GRASPS": _grasp_rows(subtask.grasps)}
    goals = [(g.subject, g.relation, g.reference, g.part) for g in subtask.goals]
    calls = compile("\n".join(TEMPLATES[subtask.template].calls(subtask)), f"{subtask.id}.py", "exec")
    return Script(
        path=Path(f"{subtask.id}.py"),
        play=lambda task: exec(calls, {"task": task, **values}),
        verify=lambda task: task.ask(subtask.text, goals=goals),
        values=values,
    )


def load_script(path: Path) -> Script:
    """Execute the file of a sub-task script; only for one named or started by a person.

    Raises:
        MissingStage: it is not there.
        DamagedFile: it does not parse, fails while it is loaded, or lacks ``play`` or ``verify``.
    """
    if not path.is_file():
        raise MissingStage(f"{path} does not exist", hint="make it first", maker="search_subtasks")
    try:
        names = runpy.run_path(str(path), run_name="vcage_subtask")
    except SyntaxError as error:
        raise _damaged(f"{path}: line {error.lineno}: {error.msg}") from error
    except Exception as error:  # any value left by an edit
        raise _damaged(f"{path} cannot be loaded: {type(error).__name__}: {error}") from error
    for name in ("play", "verify"):
        if not callable(names.get(name)):
            raise _damaged(f"{path} defines no function {name}(task)")
    values = {name: value for name, value in names.items() if name.isupper()}
    return Script(path, _naming_lines(path, names["play"]), _naming_lines(path, names["verify"]), values)


def _damaged(message: str) -> DamagedFile:
    return DamagedFile(message, hint="fix it", maker="search_subtasks")


def _naming_lines(path: Path, function: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """A function of a script, whose own mistakes are reported with the script's line."""

    def reported(task: Any) -> Any:
        try:
            return function(task)
        except (Exception, SystemExit) as error:
            frames = traceback.extract_tb(error.__traceback__)
            ours = next((frame for frame in reversed(frames) if frame.filename == str(path)), None)
            if ours is None or (ours is not frames[-1] and not isinstance(error, UnknownName)):
                raise  # not a mistake of the script
            message = f"{path}: line {ours.lineno}: {type(error).__name__}: {error}"
            raise _damaged(message) from error

    return reported


def _for_docstring(text: str) -> str:
    """One line of ``text`` that can neither end a docstring nor hide anything in it."""
    visible = "".join(c if c.isprintable() else " " for c in text)
    return " ".join(visible.replace("\\", "/").replace('"', "'").split())


@functools.cache
def _page() -> jinja2.Template:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("vcage.tasks", package_path=""),
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
        autoescape=False,
    )
    environment.filters["literal"] = repr
    environment.filters["docstring"] = _for_docstring
    return environment.get_template("script.py.jinja")
