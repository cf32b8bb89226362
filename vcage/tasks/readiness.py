"""The state in which a sub-task can begin."""

from __future__ import annotations

from collections.abc import Sequence

from vcage.schema.base import PoseRecord, box_record
from vcage.schema.scene import ObjectRecord, Scene
from vcage.schema.subtasks import Subtask
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.stowing import with_part


def ready_for(subtask: Subtask, scene: Scene, objects: Sequence[SceneObject]) -> Scene:
    """The scene as it must be before a sub-task: open what it needs open, closed what it needs closed, and what lies in
    such a part where that is.

    Args:
        subtask: what is to begin.
        scene: with parts as they are.
        objects: of the scene.
    """
    now = [o.moved(o.pose, scene.object(o.id).joints) for o in objects]
    for goal in subtask.requires:
        holder = next((o for o in now if o.id == goal.subject), None)
        if holder is None or goal.part not in {link.name for link in holder.asset.model.links}:
            continue
        end = holder.asset.model.link(goal.part).joint.far_end
        now = with_part(now, holder.id, goal.part, end if goal.relation == "open" else 0.0)
    there = {o.id: o for o in now}
    return scene.model_copy(update={"objects": [_record(record, there[record.id]) for record in scene.objects]})


def _record(record: ObjectRecord, now: SceneObject) -> ObjectRecord:
    """An object as it is now; all joints at rest are none."""
    update: dict[str, object] = {"joints": now.joints if any(now.joints) else ()}
    if record.container_part is not None:
        update |= {"pose": PoseRecord.of(now.pose), "aabb": box_record(now.asset.bounds, now.pose)}
    return record.model_copy(update=update)
