"""The slots of the chains that a search found, as the reasoner fills them."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence

import numpy as np

from vcage.base.attempts import LIMITS
from vcage.base.errors import InfeasibleScene, NoFeasibleTask
from vcage.models.protocols import Reasoner
from vcage.schema.scene import Scene
from vcage.schema.subtasks import SlotAnswer, SlotQuestion, Subtask
from vcage.tasks.choosing import checked, filled, slot_questions, with_open_parts
from vcage.tasks.proven_chain import proven
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import actions_of, initial_state
from vcage.tasks.stowing import ready_for

logger = logging.getLogger(__name__)


def with_chosen_slots(
    chains: Sequence[Sequence[Subtask]],
    kept: Mapping[str, Subtask],
    scene: Scene,
    objects: Sequence[SceneObject],
    reasoner: Reasoner,
    rng: np.random.Generator,
) -> list[list[Subtask]]:
    """The chains with the reasoner's choices, those of an instruction proven from step to step.

    It is asked once for all of them, and only where it has a choice. Where a chain cannot be done with the chosen
    places, it follows the ranking.

    Args:
        chains: the sub-tasks of each, in order.
        kept: all sub-tasks that were found, by id.
        scene, objects: where.
        reasoner: is asked.
        rng: of all choices that are drawn.

    Raises:
        NoFeasibleTask, InfeasibleScene: a chain cannot be done, see :func:`vcage.tasks.proven_chain.proven`.
        ModelRefused: the reasoner gives no valid answer.
    """
    asked = [_questions(chain, kept, scene, objects) for chain in chains]
    flat = [question for questions in asked for question in questions]
    answers = iter(
        reasoner.fill_slots(scene.instruction, flat)
        if any(question.is_open for question in flat)
        else [SlotAnswer(subtask=question.subtask) for question in flat]
    )
    found = []
    for chain, questions in zip(chains, asked, strict=True):
        answered = [
            with_open_parts(subtask, question, next(answers))
            for subtask, question in zip(chain, questions, strict=True)
        ]
        if scene.goals:
            found.append(_proven(chain, answered, kept, scene, objects, rng))
        else:  # a single option was proven by the search
            found.append(filled(chain, {}, answered))
    return found


def _questions(
    chain: Sequence[Subtask], kept: Mapping[str, Subtask], scene: Scene, objects: Sequence[SceneObject]
) -> list[SlotQuestion]:
    """Choices in a chain. A sub-task that is a task of its own keeps its place: others use the other places."""
    actions = actions_of(chain, objects, scene)
    if scene.goals:
        return slot_questions(chain, kept.values(), objects, initial_state(objects), actions)
    ready = ready_objects(chain[0], scene, objects)
    return slot_questions(chain, (), ready, initial_state(ready), actions)


def ready_objects(subtask: Subtask, scene: Scene, objects: Sequence[SceneObject]) -> list[SceneObject]:
    """The objects of a scene where they stand, with their parts as they must be before a sub-task."""
    joints = {o.id: o.joints for o in ready_for(subtask, scene, objects).objects}
    return [o.moved(o.pose, joints[o.id]) for o in objects]


def _proven(
    chain: Sequence[Subtask],
    answers: Sequence[SlotAnswer],
    kept: Mapping[str, Subtask],
    scene: Scene,
    objects: Sequence[SceneObject],
    rng: np.random.Generator,
) -> list[Subtask]:
    chosen = filled(chain, kept, answers)
    if [subtask.id for subtask in chosen] != [subtask.id for subtask in chain]:
        try:
            return proven(chosen, objects, scene, rng, LIMITS.final_slot_sets)[0]
        except (NoFeasibleTask, InfeasibleScene) as error:
            logger.warning("the chain follows the ranking, not the chosen places: %s", error.message)
            chosen = checked(chain, answers)
    return proven(chosen, objects, scene, rng, LIMITS.final_slot_sets)[0]
