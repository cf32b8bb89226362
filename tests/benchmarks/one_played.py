"""A sub-task of a template that is carried out once, from which the critic's benchmark makes failures."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from benchmarks._critic.played import Case, Played
from tests.example_scenes import script_of, workplace, world_of
from vcage.schema.goals import Goal
from vcage.schema.robot import Robot
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import Slot
from vcage.tasks.task import Task
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.workplace import Workplace

Use = Callable[[Task, list[tuple[int, str]]], None]
"""Does it with some grasps."""


def one_played(
    name: str,
    objects: Sequence[SceneObject],
    goal: Goal,
    use: Use,
    *,
    seed: int,
    place: Workplace | None = None,
    robot: Robot | None = None,
    slots: Mapping[str, Slot] | None = None,
    goes_home: bool = True,
) -> Played:
    """Return the outcome.

    Args:
        name: of the template.
        objects: where they stand; the template has one proposal for them.
        goal: that is asked for.
        use: does it.
        seed: of all choices.
        place: of the objects, with the arms that do it; those of the examples where none is given.
        robot: the same for the world.
        slots: id of an object → where it goes.
        goes_home: False where the hand keeps what it holds.
    """
    ((proposal,), _) = TEMPLATES[name].proposals(objects, [goal])
    step, _ = proposal.examine(place or workplace(objects))
    assert step is not None
    grasps = [(grasp.contact, grasp.arm) for grasp in step.grasps]

    def play(task: Task) -> None:
        use(task, grasps)
        if goes_home:
            task.home()

    return Case(
        subtask=step,
        script=script_of(step, play),
        objects={o.id: o for o in objects},
        slots=slots or {},
        build=lambda: world_of(objects, robot),
        others=(),
        rng=np.random.default_rng(seed),
    ).play()
