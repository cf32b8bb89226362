"""The five tasks in the words of the paper, by answers of an agent that are written down in paper_tasks.yml."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.run_folders import REPOSITORY, Answer, command
from vcage.base.files import RunFolder
from vcage.campaigns.plan import Plan
from vcage.scenes.stated_goals import StatedGoal, StatedTask
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtasks

ANSWERS = Path(__file__).with_name("paper_tasks.yml")
TASKS: dict[str, dict[str, Any]] = yaml.safe_load(ANSWERS.read_text(encoding="utf-8"))
PLAN = REPOSITORY / "examples" / "paper_tasks.yml"
KINDS = ("missing", "goals", "lacks", "relations", "pairs", "sentences", "steps")
"""A field that the answers to one kind of question alone have."""


def paths(name: str, part: str, looks: Mapping[str, str]) -> set[str | None]:
    """How a stated goal may call what an answer names by its id: by its kind or its look, and the part."""
    if name == "none":
        return {None}
    tail = "" if part == "none" else f"/{part}"
    return {looks[name] + tail, looks[name].partition("/")[0] + tail}


def says(stated: StatedGoal, read: Mapping[str, Any], looks: Mapping[str, str]) -> bool:
    """True if a stated goal is the one that the agent read."""
    of_subject = read["reference"] == "none"
    subject = paths(read["subject"], read["part"] if of_subject else "none", looks)
    reference = paths(read["reference"], read["part"], looks)
    same = (stated.word, stated.step) == (read["relation"], read["step"])
    return same and stated.subject in subject and stated.reference in reference


def test_the_plan_of_the_campaign_asks_for_what_the_agent_chose_and_read() -> None:
    planned = {task.instruction: task for task in Plan.load(PLAN).tasks}
    assert set(planned) == {task["instruction"] for task in TASKS.values()}
    for task in TASKS.values():
        one, answers = planned[task["instruction"]], task["answers"]
        chosen = [o["look"] for o in answers["missing"]["objects"]]
        assert str(one.objects).split(", ") == chosen
        stated, read = StatedTask.of(one.goals, (), one.objects), answers["goals"]["goals"]
        looks = {look.replace("/", "_"): look for look in chosen}
        assert stated is not None and len(stated.goals) == len(read)
        assert all(says(goal, answer, looks) for goal, answer in zip(stated.goals, read, strict=True))


def answered(capsys: pytest.CaptureFixture[str], task: str, *words: str | Path) -> Answer:
    """Run a command to its end, with the written answer to each of its questions."""
    while True:
        ended = command(capsys, *words, "--models", "agent")
        if ended.code != 8:
            return ended
        for question in ended.error["details"]["asked"]:
            assert not question["complaint"], f"the answer for {task} no longer holds: {question['complaint']}"
            fields = json.loads((Path(question["folder"]) / "schema.json").read_text())["properties"]
            kind = next(kind for kind in KINDS if kind in fields)
            Path(question["answer"]).write_text(json.dumps(TASKS[task]["answers"][kind]))


@pytest.mark.slow
@pytest.mark.parametrize("task", sorted(TASKS))
def test_a_task_in_the_words_of_the_paper_becomes_a_chain_that_is_feasible(task: str, tmp_path: Path, capsys) -> None:
    run = RunFolder(tmp_path / "run")
    words = ("select-place", TASKS[task]["instruction"], "--robot", "aloha_agilex", "--out", run.root)
    begun = answered(capsys, task, *words)
    assert begun.code == 0, begun.record
    for stage in ("inpaint-plan", "match", "optimize", "search-subtasks"):
        asks = stage != "optimize"
        ended = answered(capsys, task, stage, "--run", run.root) if asks else command(capsys, stage, "--run", run.root)
        assert ended.code == 0, (stage, ended.record)
    goals = [asked.goal for asked in Scene.read(run.layout).goals]
    found = Subtasks.read(run.subtasks)
    steps = {subtask.id: subtask for subtask in found.kept}
    done = {goal for name in found.chains[0].subtasks for goal in steps[name].goals}
    assert set(goals) <= done and len(found.chains[0].subtasks) == TASKS[task]["steps"]
