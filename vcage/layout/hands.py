"""The room that a robot's hand needs around what it grasps from above."""

from __future__ import annotations

from dataclasses import dataclass

from vcage.schema.robot import Robot


@dataclass(frozen=True)
class HandSettings:
    """Sizes of grasps from above.

    Args:
        lowest_grasp_m: height above the table of a gripper's origin when it closes at its lowest.
        narrowest_m: extent along the palm of the narrowest objects: the palm covers no table beside that much.
    """

    lowest_grasp_m: float = 0.013
    narrowest_m: float = 0.014


SETTINGS = HandSettings()


@dataclass(frozen=True)
class HandClearance:
    """Clearance of a hand that comes straight down.

    Args:
        height: things lower than this pass under its palm, metres.
        gap: that it needs between what it grasps and what is higher, metres.
    """

    height: float
    gap: float


def hand_clearance(robot: Robot) -> HandClearance:
    """Clearance of the largest of a robot's hands, to the micrometre."""
    grippers = [arm.gripper for arm in robot.arms.values()]
    below = min(gripper.finger_length for gripper in grippers)
    aside = max(max(gripper.palm_size) / 2 for gripper in grippers)
    return HandClearance(round(SETTINGS.lowest_grasp_m + below, 6), round(aside - SETTINGS.narrowest_m / 2, 6))
