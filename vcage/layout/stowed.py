"""Objects in a moving part, such as a closed drawer, and balls in a heap: no layout moves them, they go along."""

from __future__ import annotations

from collections.abc import Mapping

from vcage.base.geometry import Pose
from vcage.schema.scene import ObjectRecord, Scene


def with_places(scene: Scene) -> dict[str, ObjectRecord]:
    """The objects with a place of their own in a layout, by id."""
    return {o.id: o for o in scene.objects if not o.rides}


def with_stowed(scene: Scene, poses: Mapping[str, Pose]) -> dict[str, Pose]:
    """Poses of all objects of a scene with the independently placed ones at these.

    Args:
        scene: with contents at their places in the containers.
        poses: by id, of the independently placed objects.
    """
    found = dict(poses)
    for o in scene.objects:
        if o.rides and o.container in poses:
            way = poses[o.container] * scene.object(o.container).pose.pose().inverse()
            found[o.id] = way * o.pose.pose()
    return found
