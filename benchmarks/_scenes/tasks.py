"""Sub-tasks of a scene, each carried out once in a layout, and the task of several steps that is drawn for it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.tasks import FPS, play
from vcage.base.errors import VcageError
from vcage.plans.actions import HOLDING, lasting
from vcage.plans.plain_words import goal_in_words
from vcage.runs.context import StageContext
from vcage.schema.goals import AskedGoal, Goal
from vcage.schema.plan import TABLE
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Refusal, Subtask
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import FoundSubtasks, find_subtasks, sensible
from vcage.tasks.stowing import ready_for
from vcage.tasks.synthesis import script_of
from vcage.tasks.templates.proposal import Proposal
from vcage.tasks.workplace import Workplace

STEPS = 4
"""Goals of a drawn task, as many as the longest of the paper's have."""

TOGETHER = 2
"""Most goals of a drawn task about one receptacle, or one drawer of it."""


@dataclass(frozen=True)
class Played:
    """A sub-task that was tried once.

    Args:
        reason: why it failed; "" where it did not.
        seconds: of simulated time that its episode took; 0 where none began.
    """

    reason: str
    seconds: float = 0.0


def found_subtasks(scene: Scene, context: StageContext) -> list[Proposal]:
    """The sub-tasks that make sense for the objects of a scene and fit by size, wherever the objects stand."""
    return sensible(context.objects(scene), context.models.reasoner.judge_pairs)[0]


def subtask_name(found: Proposal | Subtask | Refusal) -> str:
    """Name of a sub-task, feasible or not."""
    if isinstance(found, Proposal):
        found = found.refusal("as any other")
    goal = found.goals[0] if isinstance(found, Subtask) else found.goal
    return f"{found.template} {goal} {found.functional_point}"


def possible_goals(scene: Scene, context: StageContext) -> list[Goal]:
    """Goals of a scene that a sub-task is feasible for where its objects stand."""
    objects, rng = context.objects(scene), np.random.default_rng(0)
    kept = find_subtasks(Workplace.of(scene, objects, rng), context.models.reasoner.judge_pairs).kept
    return [goal for subtask in kept for goal in subtask.goals]


def drawn_task(possible: Sequence[Goal], objects: Sequence[SceneObject], rng: np.random.Generator) -> dict[str, Any]:
    """Draw a task: instruction and goals that put different things into or onto others.

    Args:
        possible: goals to draw from.
        objects: of the scene.
        rng: of the choice.

    Returns:
        Fields of the scene.
    """
    goals: list[Goal] = []
    for number in rng.permutation(len(possible)):
        goal = possible[int(number)]
        if len(goals) < STEPS and _goes_with(goal, goals):
            goals.append(goal)
    phrases = {o.id: o.record.phrase for o in objects}
    asked = [AskedGoal(goal=goal, step=0, words=goal_in_words(goal, phrases)) for goal in goals]
    return {"instruction": "; ".join(one.words for one in asked), "goals": asked}


def _goes_with(goal: Goal, goals: Sequence[Goal]) -> bool:
    """True if a goal puts something into or onto another thing, and others of a task allow it."""
    if goal.relation not in HOLDING or goal.reference == TABLE:
        return False
    shared = Counter((other.reference, other.part) for other in goals)
    about = {name for other in goals for name in (other.subject, other.reference)}
    carried = {other.subject for other in goals}
    return goal.subject not in about and goal.reference not in carried and shared[goal.reference, goal.part] < TOGETHER


def played(scene: Scene, names: Sequence[str], seed: int, context: StageContext) -> dict[str, Played]:
    """Carry out each sub-task from the layout of a scene, or say why it is not feasible there."""
    objects, rng = context.objects(scene), np.random.default_rng([seed, 5])
    searched = find_subtasks(Workplace.of(scene, objects, rng), context.models.reasoner.judge_pairs)
    kept = {subtask_name(subtask): subtask for subtask in searched.kept}
    return {
        name: _tried(kept[name], scene, seed, context) if name in kept else Played(why_refused(name, searched))
        for name in names
    }


def _tried(subtask: Subtask, scene: Scene, seed: int, context: StageContext) -> Played:
    """The outcome of a simulated episode of a sub-task, by the simulator's state."""
    start = ready_for(subtask, scene, context.objects(scene))
    chain = [(subtask, script_of(subtask))]
    try:
        done = play(start, chain, lasting([subtask.goals]), seed, context)
    except VcageError as error:
        return Played(f"refused: {error.message}")
    attempt, seconds = done.attempts[-1], len(done.log.frames) / FPS
    if attempt.truth is None or not attempt.truth.success:
        return Played(f"at {attempt.stage}: {attempt.truth.reason if attempt.truth else attempt.reason}", seconds)
    return Played("" if done.goals_hold and done.goals_hold.success else "it does not last", seconds)


def why_refused(name: str, searched: FoundSubtasks) -> str:
    """Why a sub-task is not feasible in a layout."""
    reasons = [refusal.reason for refusal in searched.refused if subtask_name(refusal) == name]
    return f"not feasible: {reasons[-1] if reasons else 'no reason given'}"
