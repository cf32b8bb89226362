"""Values of a plan with which no job could run: all of them at once, before any job begins."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np

from vcage.base.errors import InfeasibleScene, NoFeasibleTask, VcageError
from vcage.base.files import RunFolder
from vcage.base.problems import Problem, require_none
from vcage.campaigns.options import options_of_plan
from vcage.campaigns.plan import Plan, Task, slug
from vcage.models.protocols import OFFLINE
from vcage.runs.context import StageContext
from vcage.scenes.chosen_objects import choose
from vcage.scenes.stated_scene import choose_stated
from vcage.schema.scene import SceneTemplate
from vcage.sim.robots import load_robot, load_template
from vcage.stages.chain import ChainOptions
from vcage.stages.select_place import asked_by

OPTION = re.compile(r"--(goal|start|objects|scene|all-subtasks|layout|randomise|models)\b(?: agent,)?")
"""An option of `vcage run` in an error; an agent, which some offer, answers in no campaign."""

KEYS = {
    "goal": "goals",
    "start": "starts",
    "all-subtasks": "all_subtasks",
    "layout": "layouts",
    "randomise": "looks",
    "models": "options.models",
}
"""Option of `vcage run` → key of a plan, where they differ."""

MOST_JOBS = 2_000_000
"""Of a plan."""

DRAWS = 3
"""Choices of looks with which a task is tried: a goal may be possible with some looks of its objects only."""


def problems_of_values(path: Path, plan: Plan) -> Iterator[Problem]:
    """Name every value of a plan with which no job could run.

    Args:
        path: of its file.
        plan: of which all fields are right.
    """
    yield from _too_many(path, plan)
    yield from _repeated(path, plan)
    for number, robot in enumerate(plan.robots):
        yield from _complaints(path, f"robots.{number}", partial(load_robot, robot))
    yield from _problems_of_options(path, plan.options)
    for number, look in enumerate(plan.looks):
        for layout in plan.layouts:
            ranges = ChainOptions(randomise=look, layout=layout).ranges
            yield from _complaints(path, f"looks.{number}", ranges)
    for number, task in enumerate(plan.tasks):
        yield from _problems_of_task(path, f"tasks.{number}", task)


def _too_many(path: Path, plan: Plan) -> Iterator[Problem]:
    """A plan of more jobs than can be kept in memory and in one folder."""
    seeds = plan.seeds if isinstance(plan.seeds, int) else len(plan.seeds)
    cells = len(plan.tasks) * max(len(plan.robots), 1) * len(plan.layouts) * len(plan.looks) * seeds
    jobs = cells * ceil(plan.episodes / plan.episodes_per_job)
    if jobs > MOST_JOBS:
        hint = "make several campaigns of it, or jobs of more episodes_per_job"
        yield Problem(path, "episodes", f"{jobs:,} jobs in all; expected at most {MOST_JOBS:,}", hint)


def _repeated(path: Path, plan: Plan) -> Iterator[Problem]:
    """Entries of lists that would give two cells one name."""
    names: dict[str, Sequence[Any]] = {
        "tasks": [task.name for task in plan.tasks],
        "robots": [slug(robot) for robot in plan.robots],
        "layouts": plan.layouts,
        "looks": [slug(Path(look).stem) for look in plan.looks],
        "seeds": () if isinstance(plan.seeds, int) else plan.seeds,
    }
    for field, found in names.items():
        for number, name in enumerate(found):
            if (first := found.index(name)) < number:
                hint = "give one of them another id" if field == "tasks" else "leave one out, or rename its file"
                yield Problem(path, f"{field}.{number}", f"{name!r} is the name of {field}.{first}, too", hint)


def _problems_of_options(path: Path, options: Mapping[str, Any]) -> Iterator[Problem]:
    each = ((f"options.{key}", {key: value}) for key, value in options.items())
    found = [problem for field, one in each for problem in _complaints(path, field, partial(options_of_plan, one))]
    yield from found or _complaints(path, "options", partial(options_of_plan, options))


def _problems_of_task(path: Path, field: str, task: Task) -> Iterator[Problem]:
    found = list(_complaints(path, f"{field}.scene", partial(load_template, task.scene)))
    has_task = task.instruction is not None or bool(task.goals)
    if not has_task and not task.all_subtasks:
        text = "nothing to do; expected one of instruction, goals, or all_subtasks: true with a scene"
        found.append(Problem(path, field, text))
    if has_task and task.all_subtasks:
        text = "all_subtasks runs every sub-task of the scene, so it takes neither instruction nor goals"
        found.append(Problem(path, field, text, "leave out one or the other, or make two tasks of it"))
    yield from found or _complaints(path, field, partial(asked_by, ChainOptions(**task.options)))


def require_readable(path: Path, plan: Plan, earlier: Plan | None = None) -> None:
    """Check that jobs could begin with the goals of every task, and with its instruction where rules read it.

    A third of a second for each task and robot.

    Args:
        path: of the plan.
        plan: with values that can be.
        earlier: plan whose tasks were checked before.

    Raises:
        SchemaMismatch: they could not; names all such tasks.
    """
    known = set() if earlier is None else {(str(cell.task), cell.robot) for cell in earlier.cells}
    rules = plan.chain_options.who(RunFolder(".")).of("reasoner") == OFFLINE
    context, found = StageContext(OFFLINE), list[Problem]()
    for number, task in enumerate(plan.tasks):
        if not task.goals and (task.instruction is None or not rules):
            continue
        field = f"tasks.{number}.{'goals' if task.goals else 'instruction'}"
        for robot in plan.robots_of(task):
            if (str(task), robot) not in known:
                found += _complaints(path, field, partial(_choose, task, load_template(task.scene, robot), context))
    require_none(found)


def _choose(task: Task, template: SceneTemplate, context: StageContext) -> None:
    """Choose the objects of a task as its jobs do.

    Raises:
        VcageError: it cannot be done, whichever looks are drawn.
    """
    stated = ChainOptions(**task.options).stated()
    for seed in range(DRAWS):
        rng = np.random.default_rng(seed)
        try:
            if stated is not None:
                choose_stated(stated, task.instruction, template, context, rng)
            else:
                choose(task.instruction, template, context, rng)
            return
        except (NoFeasibleTask, InfeasibleScene):
            if seed == DRAWS - 1:
                raise


def _complaints(path: Path, field: str, check: Callable[[], Any]) -> Iterator[Problem]:
    """The error of a check, in the words of a plan."""
    try:
        check()
    except VcageError as error:
        text, hint = (
            OPTION.sub(lambda found: KEYS.get(found[1], found[1]), words) for words in (error.message, error.way_out)
        )
        yield Problem(path, field, text, hint or Problem.hint)
