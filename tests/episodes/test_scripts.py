"""A script run directly has the sub-task it was made from."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.example_scenes import scene_of, subtask, thing
from vcage.base.errors import DamagedFile
from vcage.base.files import RunFolder
from vcage.episodes.scripts import NEEDED, prepare_run
from vcage.schema.goals import Goal
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Preference, Statement, Subtask, Subtasks
from vcage.tasks.synthesis import write_script

OBJECTS = [thing("block", (-0.2, 0.0)), thing("packaging_box", (0.3, 0.05))]


def handing() -> Subtask:
    """A sub-task with something in every field but the checks."""
    return subtask("block", "packaging_box", "inside").model_copy(
        update={
            "template": "hand_over",
            "texts": [f"In other words, number {number}." for number in range(10)],
            "tool": "block",
            "grasped": "block",
            "target": 0.1,
            "arm": "left",
            "hand_to": "right",
            "prefers": Preference(contact=0, arm="left"),
            "statements": [Statement(subject="packaging_box", word="unmoved")],
            "requires": [Goal(subject="block", relation="on", reference="table")],
        }
    )


def prepared(step: Subtask, folder: Path) -> RunFolder:
    script = write_script(step, scene_of(OBJECTS), folder / f"{step.id}.py")
    prepare_run(run := RunFolder(folder / "run"), script, seed=0, force=False)
    return run


def test_nothing_that_a_script_was_made_from_is_lost(tmp_path: Path):
    step = handing()
    assert [name for name in Subtask.model_fields if getattr(step, name) in (None, [])] == ["checks"]
    run = prepared(step, tmp_path)
    (again,) = Subtasks.read(run.subtasks).kept
    assert again == step.model_copy(update={"script": f"subtasks/{step.id}.py"})
    assert Scene.read(run.layout).objects == scene_of(OBJECTS).objects


@pytest.mark.parametrize("name", NEEDED)
def test_a_script_that_lacks_a_value_is_damaged(tmp_path: Path, name: str):
    script = write_script(handing(), scene_of(OBJECTS), tmp_path / "step.py")
    script.write_text(
        script.read_text().replace(f"\n{name}", f"\nOTHER_{name}").replace(f", {name} =", f", OTHER_{name} =")
    )
    with pytest.raises(DamagedFile, match=f"defines no {name}"):
        prepare_run(RunFolder(tmp_path / "run"), script, seed=0, force=False)
