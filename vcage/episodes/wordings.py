"""Wordings of an episode's task: sentences that are true of its scene, clear in it, and ask for the same."""

from __future__ import annotations

from collections.abc import Sequence

from vcage.models.protocols import Reasoner
from vcage.models.wordings import TaskToWord
from vcage.runs.context import StageContext
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Chain, Subtask
from vcage.tasks.wording import template_wordings

MOST_WORDINGS = 24
"""Most sentences for a task, with the instruction."""


def worded_chain(
    chain: Chain, steps: Sequence[Subtask], scene: Scene, context: StageContext, reasoner: Reasoner
) -> Chain:
    """Return the chain of an instruction with more wordings of its task: the reasoner's, then from templates.

    Args:
        chain: for the goals of the scene.
        steps: its sub-tasks.
        scene: where they are done.
        context: the library.
        reasoner: asked once.
    """
    task = task_to_word(steps, scene, context)
    plain = template_wordings(task, {goal for step in steps if step.template == "push" for goal in step.goals})
    said = reasoner.word_task(task, plain)
    wordings = list(dict.fromkeys([*said.sentences, *plain]))
    return chain.model_copy(update={"wordings": wordings[: MOST_WORDINGS - 1], "wordings_dropped": said.dropped})


def wordings_for(
    text: str, wordings: Sequence[str], steps: Sequence[Subtask], scene: Scene, context: StageContext
) -> list[str]:
    """Return the text, and the other wordings that fit an episode and its scene.

    Args:
        text: the instruction, or the words of the sub-task.
        wordings: of the chain, in the words of the episode.
        steps: the sub-tasks, in the words of the episode.
        scene: of the episode.
        context: the library.
    """
    if scene.goals:
        further = task_to_word(steps, scene, context).reviewed(wordings)
    else:
        further = steps[0].texts if len(steps) == 1 else []
    return list(dict.fromkeys([text, *further]))[:MOST_WORDINGS]


def task_to_word(steps: Sequence[Subtask], scene: Scene, context: StageContext) -> TaskToWord:
    """Return the task a sentence must ask for, with the names it may use.

    Args:
        steps: the sub-tasks that do it.
        scene: with its goals.
        context: the library.
    """
    used = (name for step in steps for name in (step.tool, step.grasped, step.receptacle))
    return TaskToWord(
        instruction=scene.instruction or "",
        goals=scene.goals,
        untouched=scene.untouched,
        descriptions=scene.descriptions,
        things={o.id: o.kind() for o in context.objects(scene)},
        phrases={o.id: o.phrase for o in scene.objects},
        lying={o.id: o.container for o in scene.objects if o.container is not None},
        tools=[name for name in used if name is not None],
        catalogue=context.annotated,
    )
