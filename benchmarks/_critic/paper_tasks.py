"""Table IV of the paper: the purity of its tasks' data, with an open and with a closed loop.

An episode ends where the robot gives up, and otherwise at the end of its chain, whatever the critic says. Its verdicts
are noted beside the truth by the simulator's state. So both loops are counted on the same episodes: the open one takes
every episode that came to its end, the closed one those in which the critic accepted each step.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np

from benchmarks.tasks import FPS, TASKS, Made, made
from vcage.base.errors import VcageError
from vcage.base.proportions import wilson
from vcage.episodes.photographs import Photographer, light_look
from vcage.episodes.question import Asking, verdict
from vcage.episodes.starts import Start, Starts
from vcage.plans.actions import lasting
from vcage.runs.context import StageContext
from vcage.schema.episodes import Verdict
from vcage.schema.goals import in_steps
from vcage.schema.randomisation import WorldRanges
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.tasks.loop import run_episode
from vcage.tasks.setting import Seen, Setting
from vcage.tasks.synthesis import script_of
from vcage.tasks.task import Asked

EPISODES_PER_SCENE = 5
"""Episodes that begin in layouts drawn from one scene."""


@dataclass(frozen=True)
class TaskDraw:
    """Some episodes of a task of the paper, in one scene.

    Args:
        task: one of :data:`~benchmarks.tasks.TASKS`.
        seed: of the scene, and of all choices.
        episodes: how many.
        robot: by name.
        models: whose critic.
    """

    task: str
    seed: int
    episodes: int
    robot: str
    models: str


@dataclass(frozen=True)
class Ended:
    """How an episode ended.

    Args:
        finished: the robot came to the end of its chain.
        true: each step is done, and all goals hold at the end, by the simulator's state.
        accepted: the critic accepted each step.
    """

    finished: bool
    true: bool
    accepted: bool


def draws(episodes: int, robot: str, models: str) -> list[TaskDraw]:
    """The scenes of every task, with as many episodes of each task."""
    first = range(0, episodes, EPISODES_PER_SCENE)
    sizes = [(n, min(EPISODES_PER_SCENE, episodes - n)) for n in first]
    return [TaskDraw(task, n, size, robot, models) for task in TASKS for n, size in sizes]


def ended(draw: TaskDraw) -> tuple[TaskDraw, list[Ended]]:
    """Play the episodes of a draw; one without a start, or in a scene that is refused, did not come to its end."""
    context = _context(draw.models)
    nothing = Ended(finished=False, true=False, accepted=False)
    try:
        scene = made(TASKS[draw.task], draw.seed, context, draw.robot)
    except VcageError:
        return draw, [nothing] * draw.episodes
    found = []
    for number in range(draw.episodes):
        try:
            found.append(_played(scene, np.random.default_rng([draw.seed, number]), context))
        except VcageError:
            found.append(nothing)
    return draw, found


@lru_cache(maxsize=1)
def _context(models: str) -> StageContext:
    return StageContext(models)


def _played(scene: Made, rng: np.random.Generator, context: StageContext) -> Ended:
    """One episode from a layout that is drawn as for collecting."""
    start = Starts(scene.start, scene.relations, scene.chain, WorldRanges(), context).draw(rng)
    robot = load_robot(start.scene.robot)
    look = light_look(start.scene, start.models, robot, rng)
    photographer = Photographer(start.scene, start.models, robot, look, list(start.objects.values()))
    critic = _Noting(start.scene, photographer.empty_table(), context)
    setting = _setting(start, photographer, critic.judge)
    steps = [(subtask, script_of(subtask)) for subtask in scene.chain]
    for subtask, script in steps:
        script.try_grasps(start.grasps[subtask.id])
    done = run_episode(setting, steps, 0, lasting(in_steps(scene.start.goals)))
    holds = done.goals_hold is not None and done.goals_hold.success
    finished = len(done.segments) == len(steps)
    return Ended(
        finished=finished,
        true=finished and holds and all(a.truth is not None and a.truth.success for a in done.attempts),
        accepted=finished and all(said.accepted for said in critic.said),
    )


def _setting(start: Start, photographer: Photographer, judge: Callable[[Asked, Subtask, Seen], Verdict]) -> Setting:
    """The setting of an episode in which nothing is tried again."""
    robot = load_robot(start.scene.robot)
    return Setting(
        build=lambda: World.of_scene(start.scene, start.models, robot),
        objects=start.objects,
        slots=start.slots,
        photograph=photographer.shots,
        judge=judge,
        accept="critic",
        on_failure="abort",
        retries=0,
        fps=FPS,
        start=start.world.start,
    )


@dataclass
class _Noting:
    """A critic whose verdicts are noted and not heard.

    Args:
        scene: of the episode.
        empty: (H, W, 3) the table with nothing on it.
        context: of the critic.
        said: its verdicts so far.
    """

    scene: Scene
    empty: np.ndarray
    context: StageContext
    said: list[Verdict] = field(default_factory=list)

    def judge(self, asked: Asked, subtask: Subtask, seen: Seen) -> Verdict:
        """Yes, whatever the critic says."""
        words = subtask.model_copy(update={"text": asked.text, "goals": asked.goals})
        self.said.append(verdict(self.context, self.scene, Asking.of(words, seen, self.empty)))
        return self.said[-1].model_copy(update={"accepted": True})


def rows(played: Sequence[tuple[TaskDraw, Sequence[Ended]]]) -> list[dict[str, Any]]:
    """A row for each task: the share of true episodes among those that each loop takes."""
    return [_row(task, [one for draw, some in played if draw.task == task for one in some]) for task in TASKS]


def _row(task: str, some: Sequence[Ended]) -> dict[str, Any]:
    finished, true = sum(one.finished for one in some), sum(one.true for one in some)
    accepted, right = sum(one.accepted for one in some), sum(one.accepted and one.true for one in some)
    return {
        "task": task,
        "episodes": len(some),
        "finished": finished,
        "open_loop": _share(true, finished),
        "accepted": accepted,
        "closed_loop": _share(right, accepted),
        "closed_loop_low": round(wilson(right, accepted)[0], 4),
        "kept": _share(right, true),
    }


def _share(some: int, of: int) -> float | None:
    return round(some / of, 4) if of else None
