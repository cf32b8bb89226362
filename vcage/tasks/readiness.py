"""The state in which a sub-task can begin."""

from __future__ import annotations

from collections.abc import Sequence

from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask
from vcage.tasks.scene_objects import SceneObject


def ready_for(subtask: Subtask, scene: Scene, objects: Sequence[SceneObject]) -> Scene:
    """The scene as it must be before a sub-task: open what it needs open, and closed what it needs closed.

    Args:
        subtask: what is to begin.
        scene: with parts as they are.
        objects: of the scene.
    """
    by_id = {o.id: o for o in objects}
    records = []
    for record in scene.objects:
        links = by_id[record.id].asset.model.links
        wanted = {goal.part: goal.relation for goal in subtask.requires if goal.subject == record.id}
        joints = list(record.joints or [0.0] * len(links))
        for index, link in enumerate(links):
            if link.name in wanted:
                joints[index] = link.joint.far_end if wanted[link.name] == "open" else 0.0
        records.append(record.model_copy(update={"joints": tuple(joints) if any(joints) else ()}))
    return scene.model_copy(update={"objects": records})
