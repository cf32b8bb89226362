"""The room that a robot's hand needs around what it grasps from above."""

from __future__ import annotations

from dataclasses import dataclass

from vcage.schema.robot import Robot

LOWEST_GRASP = 0.013
"""Height above the table at which the origin of a gripper is at its lowest when it closes, metres."""

NARROWEST_GRASPED = 0.014
"""Extent along the palm of the narrowest things that are grasped, metres: the palm covers no table beside that much."""


@dataclass(frozen=True)
class HandClearance:
    """What a hand that comes straight down keeps clear of.

    Args:
        height: things lower than this pass under its palm, metres.
        gap: that it needs between what it grasps and what is higher, metres.
    """

    height: float
    gap: float


def hand_clearance(robot: Robot) -> HandClearance:
    """What the largest of a robot's hands keeps clear of, to the micrometre."""
    grippers = [arm.gripper for arm in robot.arms.values()]
    below = min(gripper.finger_length for gripper in grippers)
    aside = max(max(gripper.palm_size) / 2 for gripper in grippers)
    return HandClearance(round(LOWEST_GRASP + below, 6), round(aside - NARROWEST_GRASPED / 2, 6))
