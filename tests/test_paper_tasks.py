"""The five tasks in the words of the paper, by answers of an agent that are written down in paper_tasks.yml."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from tests.run_folders import REPOSITORY
from vcage.campaigns.plan import Plan
from vcage.scenes.stated_goals import StatedGoal, StatedTask

ANSWERS = Path(__file__).with_name("paper_tasks.yml")
TASKS: dict[str, dict[str, Any]] = yaml.safe_load(ANSWERS.read_text(encoding="utf-8"))
PLAN = REPOSITORY / "examples" / "paper_tasks.yml"


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
