"""Gripper poses for a contact point: the candidates of an arm, and the room for its fingers.

Gripper frame: z along the approach, y along the closing direction, origin between the finger tips.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Pose, frame_from_axes
from vcage.schema.asset import ContactPoint
from vcage.schema.robot import Gripper
from vcage.sim.kinematics import TILTS, leaning


@dataclass(frozen=True)
class GraspSettings:
    """Room that fingers need.

    Args:
        tip_clearance_m: between the finger tips and the surface below them.
        grip_room_m: opening of the gripper beyond the width of the material.
        grasp_room_m: how much wider than the material the fingers open before they close on it, or let it go.
    """

    tip_clearance_m: float = 0.002
    grip_room_m: float = 0.006
    grasp_room_m: float = 0.024


GRASPING = GraspSettings()


@dataclass(frozen=True)
class GraspPose:
    """One way to hold an object at a contact point.

    Args:
        pose: gripper frame in the world.
        in_object: gripper frame in the object frame.
    """

    pose: Pose
    in_object: Pose


def grasp_poses(
    object_pose: Pose, contact: ContactPoint, gripper: Gripper, support: float, tilts: Sequence[float] = TILTS
) -> Iterator[GraspPose]:
    """The gripper poses to try for a contact point, the straightest first.

    They turn about the closing axis and are flipped (:func:`~vcage.sim.kinematics.leaning`). A pose whose finger tips
    or palm would touch the support is raised until they clear it, and so is one with tips deeper than those of a
    straight hand.

    Args:
        object_pose: object frame in the world.
        support: z of the object's support, metres.
        tilts: turns about the closing axis to try, in this order, radians.
    """
    frame = object_pose * frame_from_axes(contact.position, contact.approach, contact.closing)
    # Deeper than the tips of a straight hand an object may be wider than where it is to be held.
    deepest = frame.p[2] - _tips_below(frame, gripper) if contact.link is None else -np.inf
    for turned in leaning(frame, tilts):
        pose = _raised_above(turned, gripper, support + GRASPING.tip_clearance_m, deepest)
        yield GraspPose(pose, object_pose.inverse() * pose)


def _raised_above(pose: Pose, gripper: Gripper, support: float, deepest: float) -> Pose:
    """The pose so high that tips and palm are above ``support`` and the tips above ``deepest``, too (z, metres)."""
    tips, palm = _tips_below(pose, gripper), _palm_below(pose, gripper)
    lowest = pose.p[2] - np.array([tips, palm, tips])
    return Pose(pose.p + [0, 0, max(0.0, *(np.array([support, support, deepest]) - lowest))], pose.q)


def _tips_below(pose: Pose, gripper: Gripper) -> float:
    """Depth of the finger tips below the gripper frame, metres: corners of tilted fingers are lower."""
    down, sideways = -pose.rotation()[2, 2], abs(pose.rotation()[2, 0]) / 2
    return float(max(down, 0.0) * gripper.tip_depth + sideways * gripper.finger_width)


def _palm_below(pose: Pose, gripper: Gripper) -> float:
    """Depth of the palm, or of the hand behind it if that is lower, below the gripper frame, metres."""
    down, sideways = -pose.rotation()[2, 2], abs(pose.rotation()[2, 0]) / 2
    behind = gripper.finger_length + (gripper.palm_height if down < 0 else 0.0)
    return float(sideways * gripper.palm_size[0] - down * behind)


def approach_opening(width: float, gripper: Gripper) -> float:
    """Distance of the fingers when they come down around ``width`` of material, metres."""
    return min(gripper.max_width, width + GRASPING.grasp_room_m)


def command_of(width: float, gripper: Gripper) -> float:
    """The gripper's command, 0 closed to 1 open, for fingers ``width`` metres apart."""
    return width / gripper.max_width


def hand_boxes(gripper: Gripper, opening: float, closed: float | None = None) -> list[np.ndarray]:
    """Boxes (2, 3) in the gripper frame that the hand fills while its fingers go from ``closed`` to ``opening``.

    The fingers come first, then the palm with what must stay free above it.

    Args:
        gripper: whose hand it is.
        opening: the fingers' widest distance, metres.
        closed: their narrowest; they stand still when it is not given.
    """
    x, outer = gripper.finger_width / 2, opening / 2 + gripper.finger_thickness
    inner = (opening if closed is None else closed) / 2
    palm_x, palm_y = (size / 2 for size in gripper.palm_size)
    bottom, top = gripper.tip_depth, -gripper.finger_length
    return [
        np.array([[-x, inner, top], [x, outer, bottom]]),
        np.array([[-x, -outer, top], [x, -inner, bottom]]),
        np.array([[-palm_x, -palm_y, top - gripper.palm_height], [palm_x, palm_y, top]]),
    ]
