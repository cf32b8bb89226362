"""The five tasks in the words of the paper, by answers of an agent that are written down in paper_tasks.yml."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from tests.run_folders import REPOSITORY
from vcage.campaigns.plan import Plan
from vcage.stages.select_place import Options

ANSWERS = Path(__file__).with_name("paper_tasks.yml")
TASKS: dict[str, dict[str, Any]] = yaml.safe_load(ANSWERS.read_text(encoding="utf-8"))
PLAN = REPOSITORY / "examples" / "paper_tasks.yml"


def test_the_plan_of_the_campaign_asks_for_what_the_agent_chose_and_read() -> None:
    planned = {task.instruction: task for task in Plan.load(PLAN).tasks}
    assert set(planned) == {task["instruction"] for task in TASKS.values()}
    for task in TASKS.values():
        one, answers = planned[task["instruction"]], task["answers"]
        assert str(one.objects).split(", ") == [o["look"] for o in answers["missing"]["objects"]]
        stated = Options(goals=one.goals, objects=one.objects, instruction=one.instruction)
        assert len(one.goals) == len(answers["goals"]["goals"]) and stated.goals == one.goals
