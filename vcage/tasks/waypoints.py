"""The gripper's way in a pick and a place: shared by the feasibility checks and by the execution."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Pose
from vcage.schema.robot import Gripper
from vcage.tasks.grasps import GraspPose, approach_opening, hand_boxes
from vcage.tasks.scene_objects import SceneObject, SolidBox

APPROACH = 0.09
"""Metres from the pre-grasp to the grasp, along the approach."""

CLEARANCE = 0.03
"""Metres between what is carried and the highest thing on the table."""

SET_DOWN = 0.004
"""Metres above its support at which an object is let go when nothing is in the way."""

MAX_DROP = 0.075
"""An object may fall this far into a receptacle whose rim keeps the hand out, metres."""


@dataclass(frozen=True)
class PickWay:
    """Gripper poses of a pick, in order."""

    before: Pose
    grasp: Pose
    lifted: Pose


@dataclass(frozen=True)
class PlaceWay:
    """Gripper poses of a place, in order, and how far the object falls when it is let go (metres)."""

    above: Pose
    release: Pose
    after: Pose
    drop: float


def transfer_height(others: Sequence[SceneObject], table_height: float) -> float:
    """z that the bottom of a carried object must keep, metres."""
    return max([table_height, *(o.box.top for o in others)]) + CLEARANCE


def pick_way(target: SceneObject, grasp: GraspPose, height: float) -> PickWay:
    """From above the contact point down to it, and straight up until the object's bottom is at ``height``."""
    approach = grasp.pose.rotation()[:, 2]
    rise = max(height - target.box.bottom, APPROACH)
    return PickWay(
        before=Pose(grasp.pose.p - APPROACH * approach, grasp.pose.q),
        grasp=grasp.pose,
        lifted=Pose(grasp.pose.p + [0, 0, rise], grasp.pose.q),
    )


def place_way(
    held: Pose, goal: Pose, obstacles: Sequence[SolidBox], gripper: Gripper, width: float, height: float
) -> PlaceWay:
    """From ``height`` down to where the object is let go, as low as the hand can without touching an obstacle.

    Args:
        held: gripper frame in the object frame.
        goal: where the object shall come to rest, in the world.
        obstacles: walls and contents of the receptacle, and the neighbours.
        width: material between the fingers, metres.
        height: z that the object's bottom keeps on the way, metres.
    """
    lowest = Pose(goal.p + [0, 0, SET_DOWN], goal.q) * held
    rise = _rise_to_clear(lowest, obstacles, gripper, approach_opening(width, gripper))
    release = Pose(lowest.p + [0, 0, rise], lowest.q)
    above = Pose(release.p + [0, 0, max(height - goal.p[2] - SET_DOWN - rise, 0.02)], release.q)
    after = Pose(release.p + [0, 0, max(above.p[2] - release.p[2], APPROACH)], release.q)
    return PlaceWay(above=above, release=release, after=after, drop=rise + SET_DOWN)


def _rise_to_clear(pose: Pose, obstacles: Sequence[SolidBox], gripper: Gripper, opening: float) -> float:
    """How far the hand must go up so that none of its boxes touches an obstacle below it."""
    rise = 0.0
    for bounds in hand_boxes(gripper, opening):
        part = SolidBox(bounds, pose)
        for obstacle in obstacles:
            if part.outline.intersects(obstacle.outline):
                rise = max(rise, obstacle.top + SET_DOWN - part.bottom)
    return float(np.round(rise, 6))
