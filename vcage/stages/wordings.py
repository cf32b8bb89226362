"""How the task of an episode may be said: each sentence is read back in the episode's scene, and asks for the same."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from vcage.models.rules.bystanders import asked_by
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask
from vcage.stages.context import StageContext
from vcage.tasks.wording import task_wordings

MOST = 24
"""Wordings that are kept of a task."""


def said_of(text: str, chain: Sequence[Subtask], scene: Scene, context: StageContext) -> list[str]:
    """The text, and further sentences that ask for what the chain does, true of the scene: "the cup" only where there
    is one, "the red cup" where there are others.

    Args:
        text: what the task is called: the instruction, or the words of its sub-task.
        chain: the sub-tasks, in the words of the episode.
        scene: of the episode.
        context: the library.
    """
    if scene.instruction is None:
        (subtask,) = chain
        return list(dict.fromkeys([text, *subtask.texts]))[:MOST]
    things = {o.id: o.kind() for o in context.objects(scene)}
    lying = {o.id: o.container for o in scene.objects if o.container is not None}
    asked = {one.goal for one in scene.goals}
    called = Counter(kind.words.name for kind in things.values())
    names = {o.phrase: name for o in scene.objects if called[name := things[o.id].words.name] == 1}
    found = [text]
    for sentence in task_wordings([[subtask.text, *subtask.texts] for subtask in chain], names):
        read = asked_by(sentence, things, lying)
        if len(found) < MOST and read is not None and {goal for _, goal in read[0]} == asked and not read[1]:
            found.append(sentence)
    return list(dict.fromkeys(found))
