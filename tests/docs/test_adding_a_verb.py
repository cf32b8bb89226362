"""The verb of docs/adding-a-verb.md: the page shows the package's own files, and they do what it says."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from tests.example_scenes import TABLE_TOP, robot, scene_of, sensible, thing, world_of
from vcage.episodes.photographs import Photographer, light_look
from vcage.episodes.question import Asking, verdict
from vcage.goals import forms, meanings
from vcage.goals.thresholds import THRESHOLDS
from vcage.models import prompts
from vcage.runs.context import StageContext
from vcage.scenes.stated_goals import StatedTask
from vcage.schema.episodes import Truth, Verdict
from vcage.schema.goals import AskedGoal, Goal
from vcage.schema.scene import Scene
from vcage.schema.subtasks import PairAnswer, PairQuestion, Subtask
from vcage.sim.state import WorldState
from vcage.tasks.proven_chain import proven
from vcage.tasks.search import compose, find_subtasks
from vcage.tasks.slots import Slot
from vcage.tasks.synthesis import script_of
from vcage.tasks.task import Task
from vcage.tasks.truth import goals_hold, subtask_done, watch_of
from vcage.tasks.workplace import Workplace

PAGE = Path(__file__).parents[2] / "docs" / "adding-a-verb.md"
OBJECTS = [thing("block", (-0.2, -0.05), 0.3, "content"), thing("plate", (0.2, 0.1), 0.0, "receptacle")]


def files_of_the_page() -> dict[str, str]:
    """The Python files that the page shows, by path."""
    blocks = re.findall(r"```python\n# (\S+)\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    return dict(blocks)


@pytest.fixture(scope="module")
def goal() -> Goal:
    stated = StatedTask.of(["block lifted"], [], None)
    assert stated is not None
    (one,) = stated.goals
    return Goal(subject=one.subject, relation=one.word, reference=one.reference)


@dataclass
class Played:
    """The sub-task as it was played in the simulator.

    Args:
        subtask: that was found for the goal.
        before, moment, after: states of the world.
        truth: of the state afterwards.
        untrue: of a world in which nothing was done.
    """

    scene: Scene
    subtask: Subtask
    before: WorldState
    moment: WorldState
    after: WorldState
    truth: Truth
    untrue: Truth


@pytest.fixture(scope="module")
def played(goal: Goal) -> Played:
    asked = AskedGoal(goal=goal, step=1, words="Lift the block")
    scene = scene_of(OBJECTS, "Lift the block").model_copy(update={"goals": [asked]})
    subtask, slots = planned(scene, goal)
    world, objects = world_of(OBJECTS), {o.id: o for o in OBJECTS}
    world.settle()
    before, watch = world.state(), watch_of(subtask, world, objects)
    untrue = goals_hold([goal], watch)
    task = Task(world, objects, {subtask.object: slots[subtask.id]})
    script_of(subtask).play(task)
    assert task.moment is not None
    truth = subtask_done(subtask, subtask.goals, watch)
    return Played(scene, subtask, before, task.moment, world.state(), truth, untrue)


def planned(scene: Scene, goal: Goal) -> tuple[Subtask, Mapping[str, Slot]]:
    """The one sub-task of the chain for the goal, and its slots."""
    rng = np.random.default_rng(0)
    found = find_subtasks(Workplace.of(scene, OBJECTS, rng), not_asked_for, {goal})
    (chain,) = compose(scene, OBJECTS, found.kept, found.refused)
    by_id = {subtask.id: subtask for subtask in found.kept}
    (subtask,), slots = proven([by_id[name] for name in chain.subtasks], OBJECTS, scene, rng)
    return subtask, slots


def not_asked_for(questions: Sequence[PairQuestion]) -> list[PairAnswer]:
    """A reasoner for whom only the stated goal makes sense."""
    return [a.model_copy(update={"sensible": False}) for a in sensible(questions)]


def judged(played: Played, moment: WorldState, after: WorldState) -> Verdict:
    """The offline critic's verdict on pictures of states."""
    context = StageContext("offline")
    models, rng = context.physical_models(played.scene), np.random.default_rng(0)
    look = light_look(played.scene, models, robot(), rng)
    photographer = Photographer(played.scene, models, robot(), look, OBJECTS)
    photographer.world.set_state(played.before)
    empty = photographer.empty_table()
    goals = played.subtask.goals
    states: Sequence[tuple[str, WorldState, str | None]] = (
        ("before", played.before, None), ("moment", moment, "left"), ("after", after, None),
    )  # fmt: skip
    seen = {when: photographer.shots(state, goals, arm) for when, state, arm in states}
    return verdict(context, played.scene, Asking.of(played.subtask, seen, empty))


@pytest.mark.parametrize("path", files_of_the_page())
def test_the_page_shows_the_files_of_the_package(path: str) -> None:
    assert files_of_the_page()[path] == (PAGE.parents[1] / path).read_text(encoding="utf-8")


def test_the_goal_can_be_stated_and_put_into_words(played: Played) -> None:
    assert played.subtask.text == f"Lift the {OBJECTS[0].record.phrase}."
    assert len(played.subtask.texts) >= 9


def test_the_prompts_explain_the_word(goal: Goal) -> None:
    assert meanings([goal], THRESHOLDS) == [
        ["Lifted: one arm alone held the thing 5 cm or more above the table for 0.4 s."]
    ]
    reader = prompts.fill("read_goals", instruction="x", things={}, lying={}, contents=[], forms=forms()).text
    assert "`lifted`" in reader


def test_the_simulator_tells_that_it_was_done(played: Played) -> None:
    assert not played.untrue.success
    assert played.truth.success, played.truth.reason
    assert played.moment.objects["block"].p[2] > TABLE_TOP + 0.03


def test_the_critic_tells_a_lift_from_none(played: Played) -> None:
    done = judged(played, played.moment, played.after)
    assert done.accepted, done.reason
    assert not judged(played, played.before, played.before).accepted
