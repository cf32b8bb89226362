"""The input of the policy's network: joints, grippers, and objects in the world and in the frame of each gripper."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vcage.base.geometry import Pose
from vcage.sim.kinematics import kinematics_of
from vcage.sim.robots import load_robot

POSE = 9
"""Numbers of a pose: position, and the first two columns of its rotation."""


class Features:
    """Numbers for a network, from those of a state.

    Args:
        robot: name of the robot.
        names: of the numbers of a state.
        object_names: of the numbers of the objects.
    """

    def __init__(self, robot: str, names: Sequence[str], object_names: Sequence[str]):
        self._arms = {name: kinematics_of(arm) for name, arm in sorted(load_robot(robot).arms.items())}
        self._joints = {
            name: [i for i, column in enumerate(names) if column.startswith(f"{name}_joint")] for name in self._arms
        }
        self._poses = [i for i, column in enumerate(object_names) if column.endswith(".x")]
        self._others = [i for i, column in enumerate(object_names) if ".part" in column]

    def __call__(self, states: NDArray[np.float64], objects: NDArray[np.float64]) -> NDArray[np.float32]:
        """(N, F) for (N, D) states and (N, M) objects."""
        return np.stack([self._one(*row) for row in zip(states, objects, strict=True)]).astype(np.float32)

    def _one(self, state: NDArray[np.float64], objects: NDArray[np.float64]) -> NDArray[np.float64]:
        found = [state, objects]
        for name, arm in self._arms.items():
            tool = arm.fk(state[self._joints[name]])
            found.append(tool.p)
            found.append(tool.rotation()[:, :2].T.ravel())
            found += [_seen_from(tool, objects[first : first + POSE]) for first in self._poses]
        return np.concatenate(found)


def _seen_from(tool: Pose, numbers: NDArray[np.float64]) -> NDArray[np.float64]:
    """A pose, as :data:`POSE` numbers, in the frame of a tool."""
    turned = tool.rotation().T
    axes = numbers[3:].reshape(2, 3) @ turned.T
    return np.concatenate([turned @ (numbers[:3] - tool.p), axes.ravel()])
