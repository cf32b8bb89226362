"""What differs between two episodes of one scene: small shifts of the objects, never a collision."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vcage.base.geometry import Pose, boxes_overlap
from vcage.tasks.scene_objects import SceneObject

SHIFT = 0.008
"""Largest shift along an axis, metres."""

TURN = np.radians(6)
"""Largest turn, radians."""

GAP = 0.035
"""Gap that two objects keep, so that a finger finds room between them, metres."""


def shifted_poses(objects: Sequence[SceneObject], rng: np.random.Generator) -> dict[str, Pose]:
    """A pose for each object, a little off its own; one that would come too close to another stays where it is.

    Objects that lie in a container, and containers that hold something, are not moved.
    """
    holding = {o.record.container for o in objects} - {None}
    placed = {o.id: o for o in objects}
    for o in objects:
        dx, dy, turn = rng.uniform(-1, 1, size=3) * [SHIFT, SHIFT, TURN]
        if o.record.container is not None or o.id in holding:
            continue
        moved = o.moved(Pose(o.pose.p + [dx, dy, 0.0], (Pose.from_yaw([0, 0, 0], turn) * Pose(q=o.pose.q)).q))
        others = [other for key, other in placed.items() if key != o.id]
        if not any(boxes_overlap(moved.aabb, other.aabb, GAP) for other in others):
            placed[o.id] = moved
    return {key: o.pose for key, o in placed.items()}
