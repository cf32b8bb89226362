"""The gripper poses of a place: from above its slot down to where an object is let go, and away."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vcage.base.geometry import Pose
from vcage.schema.robot import Gripper
from vcage.sim.kinematics import ArmKinematics, follow
from vcage.tasks.grasps import approach_opening, hand_boxes
from vcage.tasks.scene_objects import Obstacles, SceneObject, SolidBox

SET_DOWN = 0.004
"""Metres above its support at which an object is let go when nothing is in the way."""


@dataclass(frozen=True)
class DropSettings:
    """How far an object may fall when it is let go.

    Args:
        most_m: into a receptacle whose rim keeps the hand out.
        deep_m: into one that is so deep that its walls are around the object before it is let go.
        sunk_m: depth of the object's bottom below the rim then.
    """

    most_m: float = 0.075
    deep_m: float = 0.12
    sunk_m: float = 0.03


DROP = DropSettings()


def largest_drop(receptacle: SceneObject, point: int) -> float:
    """How far an object may fall to a functional point, metres."""
    annotated = receptacle.asset.annotation.functional_point(point)
    walled = annotated.holds == "in" and annotated.link is None  # the rim of a drawer is its front: its walls are lower
    depth = receptacle.asset.opening(annotated).depth if walled else 0.0
    return max(DROP.most_m, min(DROP.deep_m, depth - DROP.sunk_m))


@dataclass(frozen=True)
class PlaceWay:
    """Gripper poses of a place, in order, and how far the object falls when it is let go (metres)."""

    above: Pose
    release: Pose
    after: Pose
    drop: float

    def raised(self, rise: float) -> PlaceWay:
        """The same, but let go higher, metres."""
        up = np.array([0.0, 0.0, rise])
        higher = (Pose(pose.p + up, pose.q) for pose in (self.above, self.release, self.after))
        return PlaceWay(*higher, drop=self.drop + rise)


def place_way(held: Pose, goal: Pose, obstacles: Obstacles, gripper: Gripper, width: float, height: float) -> PlaceWay:
    """From ``height`` down to where the object is let go, as low as the hand can without touching an obstacle.

    Args:
        held: gripper frame in the object frame.
        goal: where the object shall come to rest, in the world.
        obstacles: walls and contents of the receptacle, and the neighbours.
        gripper: that holds it.
        width: material between the fingers, metres.
        height: z that the object's frame keeps on the way, metres.
    """
    lowest = Pose(goal.p + [0, 0, SET_DOWN], goal.q) * held
    hand = hand_boxes(gripper, approach_opening(width, gripper), width)
    rise = _rise_to_clear(lowest, obstacles, hand)
    release = Pose(lowest.p + [0, 0, rise], lowest.q)
    above = Pose(release.p + [0, 0, max(height - goal.p[2] - SET_DOWN - rise, 0.02)], release.q)
    after = Pose(release.p + [0, 0, max(above.p[2] - release.p[2], gripper.approach)], release.q)
    return PlaceWay(above=above, release=release, after=after, drop=rise + SET_DOWN)


def reached_place(
    kinematics: ArmKinematics, way: PlaceWay, start: np.ndarray
) -> tuple[PlaceWay, list[np.ndarray]] | None:
    """The way, at its end no higher than the arm reaches, and the joints on it; None where the arm cannot follow it.

    Args:
        kinematics: of the arm.
        way: it may end where it starts, if it does not reach higher.
        start: (n,) joints before, rad.
    """
    for after in (way.after, way.above):
        path = follow(kinematics, [way.above, way.release, after], start)
        if path is not None:
            return replace(way, after=after), path
    return None


def _rise_to_clear(pose: Pose, obstacles: Obstacles, hand: Sequence[np.ndarray]) -> float:
    """Height by which the hand must rise so that none of its boxes touches an obstacle below it."""
    rise = 0.0
    for part, below in obstacles.under([SolidBox(bounds, pose) for bounds in hand]):
        rise = max(rise, obstacles.tops[below].max(initial=-np.inf) + SET_DOWN - part.bottom)
    return float(np.round(rise, 6))
