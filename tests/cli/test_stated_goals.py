"""``--goal``, ``--start`` and ``--objects`` on the command line: the script as a process, and what later calls keep."""

from __future__ import annotations

import sys

import pytest

from tests.run_folders import REPOSITORY, command, process
from vcage.base.errors import StaleStage
from vcage.base.files import RunFolder
from vcage.cli.going_on import remembered, stage_command
from vcage.runs.context import StageContext
from vcage.schema.scene import Scene
from vcage.stages import select_place

SCRIPT = REPOSITORY / "skills" / "vcage-igsc" / "scripts" / "select_place.py"
GOALS = ("marker inside packaging_box", "then rubber_eraser inside packaging_box")


@pytest.mark.slow
def test_the_script_makes_the_scene_of_given_goals_and_a_changed_goal_makes_it_stale(tmp_path):
    run = RunFolder(tmp_path / "run")
    stated = [word for goal in GOALS for word in ("--goal", goal)]
    answer = process([sys.executable, SCRIPT, *stated, "--out", str(run)], tmp_path)
    assert answer.code == 0, answer.stderr
    assert answer.record["answered_by"] == {}
    scene = Scene.read(run.scene)
    assert [o.asset for o in scene.objects] == ["marker", "packaging_box", "rubber_eraser"]
    box = scene.objects[1].id
    assert [str(one.goal).split(" ", 1)[1] for one in scene.goals] == [f"inside {box}"] * 2
    assert [one.step for one in scene.goals] == [1, 2]
    phrases = [o.phrase for o in scene.objects]
    assert scene.instruction == "Put the {0} into the {1}, then put the {2} into the {1}.".format(*phrases)
    assert scene.provenance.options["goals"] == list(GOALS)
    assert scene.provenance.providers == {}

    context = StageContext("offline")
    assert not select_place.execute(run, select_place.Options(goals=GOALS), context).fresh
    with pytest.raises(StaleStage, match="option goals"):
        select_place.execute(run, select_place.Options(goals=GOALS[:1]), context)


@pytest.mark.parametrize(
    "arguments, code, complaint",
    [
        (["--goal", "eraser inside pot"], "unknown_name", "did you mean rubber_eraser"),
        (["--goal", "plate inside pot"], "no_feasible_task", "no contact point to carry it by"),
        (["--goal", "apple inside mug"], "no_feasible_task", "nothing can achieve"),
        (["--goal", "then apple inside pot"], "usage", "has none before it"),
        (["--objects", "apple"], "usage", "--objects needs goals"),
    ],
)
def test_bad_goals_end_with_one_line_and_nothing_is_written(capsys, tmp_path, arguments, code: str, complaint: str):
    answer = command(capsys, "select-place", *arguments, "--out", tmp_path / "run")
    assert (answer.code, answer.error["code"]) == (2, code)
    assert len(answer.complaints) == 1
    assert complaint in answer.complaints[0]
    assert not (tmp_path / "run" / "place").exists()


def test_goals_and_every_subtask_of_a_scene_are_refused_together(capsys, tmp_path):
    answer = command(capsys, "run", "--goal", GOALS[0], "--all-subtasks", "--out", tmp_path / "run")
    assert answer.code == 2
    assert "--goal" in answer.error["hint"]


def test_a_dry_run_repeats_the_given_goals(capsys, tmp_path):
    answer = command(capsys, "select-place", "--goal", GOALS[0], "--out", tmp_path / "run", "--dry-run")
    assert answer.record["summary"]["options"]["goals"] == [GOALS[0]]


def test_the_command_that_goes_on_repeats_all_goals(tmp_path):
    run = RunFolder(tmp_path)
    (tmp_path / "place").mkdir()
    with remembered(run, select_place.Options(goals=GOALS, objects="marker, packaging_box")):
        pass
    again = stage_command("select_place", run)
    assert f"--goal '{GOALS[0]}' --goal '{GOALS[1]}'" in again
    assert "--objects 'marker, packaging_box'" in again
