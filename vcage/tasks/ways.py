"""Ways of an object in a hand: the poses that it goes through, one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Pose
from vcage.sim.kinematics import ArmKinematics


@dataclass(frozen=True)
class WaySettings:
    """How an arm follows a way.

    Args:
        largest_jump_rad: change of a joint between two poses.
        ik_starts: starts of inverse kinematics for its last pose.
    """

    largest_jump_rad: float = 0.4
    ik_starts: int = 2


SETTINGS = WaySettings()


def continuous_path(
    kinematics: ArmKinematics, way: Sequence[Pose], held: Pose, start: np.ndarray
) -> list[np.ndarray] | None:
    """Joints (n,) along a way of an object in a hand, without a jump; None where the arm cannot follow it.

    Args:
        kinematics: of the arm.
        way: poses of the object.
        held: gripper frame in the object's frame.
        start: (n,) joints before, rad.
    """
    last = way[-1] * held  # the hardest
    if kinematics.too_far(last) or not kinematics.reachable(last, SETTINGS.ik_starts):
        return None
    hands = [pose * held for pose in way]
    paths = (_continued(kinematics, hands[1:], first) for first in kinematics.ik_all(hands[0], start))
    return next((path for path in paths if path is not None), None)


def _continued(kinematics: ArmKinematics, hands: Sequence[Pose], first: np.ndarray) -> list[np.ndarray] | None:
    """Joints (n,) from the first on through poses of the gripper, without a jump; None where there is one."""
    path = [first]
    for hand in hands:
        joints = kinematics.ik(hand, path[-1], attempts=0)
        if joints is None or np.abs(joints - path[-1]).max() > SETTINGS.largest_jump_rad:
            return None
        path.append(joints)
    return path
