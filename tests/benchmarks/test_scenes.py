"""A sub-task is the same one before and after it was looked into; layouts and drawn tasks are what they say."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from benchmarks._scenes.layouts import naive
from benchmarks._scenes.tasks import STEPS, TOGETHER, Played, drawn_task, subtask_name, why_refused
from benchmarks.scenes import Outcome, Tally
from tests.example_scenes import scene_of, sensible, thing, workplace
from vcage.runs.context import StageContext
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import find_subtasks
from vcage.tasks.search import sensible as proposed


def names(objects: Sequence[SceneObject]) -> set[str]:
    return {subtask_name(proposal) for proposal in proposed(objects, sensible)[0]}


def test_each_proposal_is_kept_or_refused_under_its_name() -> None:
    objects = [
        thing("chocolate_bar", (-0.2, 0.0)),
        thing("electronic_scale", (0.1, 0.05)),
        thing("cabinet_two_drawers", (0.6, 0.9)),
    ]
    found = find_subtasks(workplace(objects), sensible)
    kept = {subtask_name(subtask) for subtask in found.kept}
    assert "weigh chocolate_bar weighed 0" in kept
    refused = names(objects) - kept
    assert refused and not any("no reason given" in why_refused(name, found) for name in refused)


def test_an_infeasible_weighing_says_why() -> None:
    objects = [thing("chocolate_bar", (0.0, 0.9)), thing("electronic_scale", (0.1, 0.05))]
    found = find_subtasks(workplace(objects), sensible)
    assert "does not reach" in why_refused("weigh chocolate_bar weighed 0", found)


@pytest.mark.parametrize("part", ["top", "bottom"])
def test_each_drawer_has_a_reason_of_its_own(part: str) -> None:
    found = find_subtasks(workplace([thing("cabinet_two_drawers", (0.0, 0.9))]), sensible)
    reason = why_refused(f"open cabinet_two_drawers/drawer_{part} open None", found)
    assert part in reason


def test_a_drawn_task_puts_different_things_and_few_into_one_place() -> None:
    objects = [
        *(thing("block", (0.1 * n, 0.0), id=f"block_{n}") for n in range(6)),
        thing("packaging_box", (0.3, 0.1)),
        thing("plate", (-0.3, 0.1)),
    ]
    found = [proposal.goal for proposal in proposed(objects, sensible)[0]]
    for seed in range(5):
        task = drawn_task(found, objects, np.random.default_rng(seed))
        goals = [asked.goal for asked in task["goals"]]
        assert 1 < len(goals) <= STEPS and len({goal.subject for goal in goals}) == len(goals)
        assert max([goal.reference for goal in goals].count(name) for name in ("plate", "packaging_box")) <= TOGETHER
        assert all(asked.words in task["instruction"] for asked in task["goals"])


def test_a_naive_layout_knows_boxes_and_the_workspace_alone() -> None:
    objects = [thing("cabinet_two_drawers", (0.0, 0.1)), *(thing("block", (0.2, 0.0), id=f"b{n}") for n in range(4))]
    scene, context = scene_of(objects), StageContext("offline")
    made = [naive(scene, np.random.default_rng(seed), context) for seed in range(6)]
    for one in made:
        boxes = np.array([o.aabb for o in one.objects])[:, :, :2]
        assert np.all(boxes[:, 0] > np.subtract(scene.workspace.lower, 0.01))
        assert np.all(boxes[:, 1] < np.add(scene.workspace.upper, 0.01))
    turned = [abs(one.object("cabinet_two_drawers").pose.pose().yaw) for one in made]
    assert max(turned) > np.pi / 2, "its front may face away"


def test_shares_are_of_all_tries_and_of_the_valid_subtasks() -> None:
    tally = Tally()
    tally.add(Outcome({"a": Played("", 4.0), "b": Played("not feasible: far"), "c": Played("", 6.0)}, ""))
    tally.add(
        Outcome({"a": Played("", 4.0), "b": Played("not feasible: far"), "c": Played("at verify", 6.0)}, "no room")
    )
    row = tally.row()
    assert (row["found"], row["seeds"], row["valid"], row["mean_success"]) == (3, 2, 0.6667, 0.75)
    assert (row["success"], row["attempts"], row["robot_seconds"], row["chain"]) == (0.5, 2.0, 6.67, 0.5)


def test_a_layout_in_which_nothing_succeeds_has_no_attempts_or_seconds_of_a_success() -> None:
    tally = Tally()
    tally.add(Outcome({"a": Played("not feasible: far")}, "far"))
    row = tally.row()
    assert (row["valid"], row["mean_success"], row["attempts"], row["robot_seconds"]) == (0.0, 0.0, None, None)
