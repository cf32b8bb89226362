"""Small shifts of objects between two episodes of one scene, never a collision."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vcage.base.geometry import Pose, boxes_overlap
from vcage.tasks.scene_objects import SceneObject


def shifted_poses(
    objects: Sequence[SceneObject],
    rng: np.random.Generator,
    shift_m: float = 0.008,
    turn_deg: float = 6.0,
    gap_m: float = 0.035,
) -> dict[str, Pose]:
    """A pose for each object, slightly varied; an object that would come too close to another keeps its pose.

    Contents and containers with contents are not moved.

    Args:
        objects: of a scene.
        rng: of all choices.
        shift_m: largest shift along an axis.
        turn_deg: largest turn.
        gap_m: gap between two objects, with room for a finger.
    """
    holding = {o.record.container for o in objects} - {None}
    placed = {o.id: o for o in objects}
    for o in objects:
        dx, dy, turn = rng.uniform(-1, 1, size=3) * [shift_m, shift_m, np.radians(turn_deg)]
        if o.record.container is not None or o.id in holding:
            continue
        moved = o.moved(Pose(o.pose.p + [dx, dy, 0.0], (Pose.from_yaw([0, 0, 0], turn) * Pose(q=o.pose.q)).q))
        others = [other for key, other in placed.items() if key != o.id]
        if not any(boxes_overlap(moved.aabb, other.aabb, gap_m) for other in others):
            placed[o.id] = moved
    return {key: o.pose for key, o in placed.items()}
