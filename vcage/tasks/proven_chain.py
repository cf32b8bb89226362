"""Prove a chain: with some of the slots that its objects may go to, each sub-task is feasible in its turn."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from vcage.base.attempts import LIMITS, GaveUp, first_accepted
from vcage.base.errors import InfeasibleScene
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask
from vcage.tasks.asked_arms import asked_arms
from vcage.tasks.chain_rehearsal import NotWithTheseSlots, rehearsed
from vcage.tasks.chain_slots import slots_for_chain
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import compose, find_subtasks, judging
from vcage.tasks.slots import Slot
from vcage.tasks.workplace import Workplace


def proven(
    chain: Sequence[Subtask],
    objects: Sequence[SceneObject],
    scene: Scene,
    rng: np.random.Generator,
    draws: int = LIMITS.slot_sets,
) -> tuple[list[Subtask], dict[str, Slot]]:
    """A chain with the grasps feasible in their turn, and the slots for them.

    Args:
        chain, objects, scene, rng: as :func:`rehearsed` takes them.
        draws: sets of slots that are tried; on receptacles the first follows from sizes, the others are drawn.

    Raises:
        NoFeasibleTask: with none of them each sub-task is feasible in its turn.
        InfeasibleScene: the contents of one receptacle do not fit together, or an object has no place on the table.
    """

    def propose(drawn: bool) -> tuple[list[Subtask], dict[str, Slot]]:
        slots = slots_for_chain(chain, Workplace.of(scene, objects, rng), drawn)
        return rehearsed(chain, slots, objects, scene, rng), slots

    proposals = [partial(propose, number > 0) for number in range(draws)]
    try:
        return first_accepted(proposals, (NotWithTheseSlots, InfeasibleScene), LIMITS.same_slot_sets).value
    except GaveUp as error:
        raise error.refusals[-1] from None


def require_chain(scene: Scene, objects: Sequence[SceneObject], rng: np.random.Generator) -> None:
    """Require a chain for the scene's instruction that is feasible from its first step to its last.

    Args:
        scene: with its goals and robot.
        objects: of the scene, where they stand.
        rng: of all choices.

    Raises:
        NoFeasibleTask: there is none.
        InfeasibleScene: the contents of one receptacle do not fit together, or an object has no place on the table.
    """
    goals, arms = {asked.goal for asked in scene.goals}, asked_arms(scene.goals)
    found = find_subtasks(Workplace.of(scene, objects, rng), judging(False), goals, arms)
    kept = {subtask.id: subtask for subtask in found.kept}
    for names in compose(scene, objects, found.kept, found.refused):
        proven([kept[name] for name in names.subtasks], objects, scene, rng)
