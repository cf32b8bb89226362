"""Tools with a head: the poses at which one is held over what it hits, and the test for a hit."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Pose
from vcage.goals.thresholds import THRESHOLDS
from vcage.schema.asset import Face
from vcage.sim.bodies import Body
from vcage.sim.collision import first_near
from vcage.tasks.scene_objects import SceneObject


@dataclass(frozen=True)
class HittingSettings:
    """Where a tool is held before it comes down.

    Args:
        above_m: the head over the top of what it hits.
        headings: directions of the tool around its head that are tried, the nearest to its present one first.
        clearance_m: least distance of the held tool from all other objects.
    """

    above_m: float = 0.03
    headings: int = 12
    clearance_m: float = 0.01


SETTINGS = HittingSettings()


def hits(tool: SceneObject, thing: SceneObject) -> bool:
    """True where a head of a tool is over the middle of an object, and faces down."""
    return any(_over(tool, head, thing) for head in tool.asset.annotation.faces_of("head"))


def _over(tool: SceneObject, head: Face, thing: SceneObject) -> bool:
    middle, at = thing.aabb.mean(axis=0), tool.pose.apply(head.position)
    down = -float((tool.pose.rotation() @ np.asarray(head.axis))[2])
    near = np.linalg.norm((at - middle)[:2]) <= THRESHOLDS.hit_off_m
    return bool(near and at[2] >= middle[2] and down >= np.cos(THRESHOLDS.hit_slant_rad))


def hitting_poses(tool: SceneObject, thing: SceneObject, above_m: float = SETTINGS.above_m) -> Iterator[Pose]:
    """Poses of a tool in the world, as it lies, with a head over the middle of an object.

    Args:
        tool: the held object.
        thing: what it hits.
        above_m: height of the head over the top of that, metres.
    """
    (x, y, _), top = thing.aabb.mean(axis=0), float(thing.around_boxes[1, 2])
    turns = np.linspace(-np.pi, np.pi, SETTINGS.headings, endpoint=False)
    for turn in sorted(turns.tolist(), key=lambda turn: abs(turn)):
        rotation = Pose.from_yaw([0, 0, 0], turn) * Pose(q=tool.pose.q)
        for head in tool.asset.annotation.faces_of("head"):
            yield Pose(np.array([x, y, top + above_m]) - rotation.apply(head.position), rotation.q)


def free_hitting_poses(
    tool: SceneObject, thing: SceneObject, others: Sequence[SceneObject]
) -> tuple[list[Pose], SceneObject | None]:
    """The poses of :func:`hitting_poses` with room around them; and what is in the way where there are none.

    Args:
        tool, thing: as there.
        others: all other objects, where they are.
    """
    bodies, in_the_way, free = {o.id: Body(o.asset.model, o.pose, o.joints) for o in others}, None, []
    for pose in hitting_poses(tool, thing):
        name = first_near(Body(tool.asset.model, pose, tool.joints), bodies, SETTINGS.clearance_m)
        if name is None:
            free.append(pose)
        in_the_way = in_the_way or next((o for o in others if o.id == name), None)
    return free, None if free else in_the_way
