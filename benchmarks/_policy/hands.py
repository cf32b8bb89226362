"""The hands of a robot: from joints to their poses, and back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from vcage.sim.kinematics import ArmKinematics, kinematics_of
from vcage.sim.robots import load_robot


@dataclass(frozen=True)
class InverseSettings:
    """Effort of the inverse kinematics, which only ever solves for a pose near the present one.

    Args:
        iterations: Gauss-Newton steps for a pose.
        tolerance: error in metres and radians below which no further step is taken.
        damping: of a step, in metres and radians.
        difference_rad: for the Jacobian by finite differences.
        margin_rad: distance from the joint limits.
    """

    iterations: int = 4
    tolerance: float = 2e-5
    damping: float = 0.01
    difference_rad: float = 1e-5
    margin_rad: float = 0.01


SETTINGS = InverseSettings()


@dataclass(frozen=True)
class HandPoses:
    """Poses of A hands, N times.

    Args:
        position: (N, A, 3) in the world, metres.
        rotation: (N, A, 3, 3) from the hand to the world.
        opening: (N, A) of the gripper, 0 closed to 1 open.
    """

    position: torch.Tensor
    rotation: torch.Tensor
    opening: torch.Tensor

    def __getitem__(self, which: torch.Tensor) -> HandPoses:
        """Those of some times."""
        return HandPoses(self.position[which], self.rotation[which], self.opening[which])

    def to(self, device: str) -> HandPoses:
        """Those on a device of torch."""
        return HandPoses(self.position.to(device), self.rotation.to(device), self.opening.to(device))

    def places(self, positions: torch.Tensor) -> torch.Tensor:
        """(N, A, O, 3) positions (N, O, 3) in the frame of each hand."""
        away = positions[:, None] - self.position[:, :, None]
        return torch.einsum("naji,naoj->naoi", self.rotation, away)


class Hands:
    """The hands of a robot.

    Args:
        robot: its name.
        names: of the D numbers of a state or an action: joints in radians, and openings of grippers.
    """

    def __init__(self, robot: str, names: Sequence[str]):
        self._arms = {name: kinematics_of(arm) for name, arm in sorted(load_robot(robot).arms.items())}
        self._joints = [[i for i, name in enumerate(names) if name.startswith(f"{arm}_joint")] for arm in self._arms]
        self._openings = [list(names).index(f"{arm}_gripper") for arm in self._arms]

    def __len__(self) -> int:
        """Number of hands."""
        return len(self._arms)

    def poses(self, states: NDArray[np.float64]) -> HandPoses:
        """The poses for (N, D) states."""
        found = [
            [arm.fk(state[joints]) for arm, joints in zip(self._arms.values(), self._joints, strict=True)]
            for state in states
        ]
        return HandPoses(
            torch.from_numpy(np.array([[pose.p for pose in row] for row in found], np.float32)),
            torch.from_numpy(np.array([[pose.rotation() for pose in row] for row in found], np.float32)),
            torch.from_numpy(states[:, self._openings].astype(np.float32)),
        )

    def states(self, poses: HandPoses, first: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N, D) states with these poses, one after the other, as near as the joints' limits allow.

        Args:
            poses: each near the one before.
            first: (D,) the state before the first.
        """
        found, state = np.empty((len(poses.opening), len(first))), first
        for row in range(len(found)):
            found[row] = state
            for hand, (arm, joints) in enumerate(zip(self._arms.values(), self._joints, strict=True)):
                position, rotation = poses.position[row, hand].numpy(), poses.rotation[row, hand].numpy()
                found[row, joints] = _brought_to(arm, state[joints], position, rotation)
                found[row, self._openings[hand]] = np.clip(float(poses.opening[row, hand]), 0.0, 1.0)
            state = found[row]
        return found


def _brought_to(
    arm: ArmKinematics, joints: NDArray[np.float64], position: NDArray[np.float32], rotation: NDArray[np.float32]
) -> NDArray[np.float64]:
    """(n,) joints near the given ones that bring the hand to a pose."""

    def error(q: NDArray[np.float64]) -> NDArray[np.float64]:
        pose = arm.fk(q)
        turn = Rotation.from_matrix(rotation @ pose.rotation().T).as_rotvec()
        return np.concatenate([position - pose.p, turn])

    for _ in range(SETTINGS.iterations):
        off, step = error(joints), SETTINGS.difference_rad
        if np.abs(off).max() < SETTINGS.tolerance:
            break
        jacobian = np.stack([(off - error(joints + step * unit)) / step for unit in np.eye(len(joints))], axis=1)
        damped = jacobian @ jacobian.T + SETTINGS.damping**2 * np.eye(len(off))
        moved = joints + jacobian.T @ np.linalg.solve(damped, off)
        joints = np.clip(moved, arm.lower + SETTINGS.margin_rad, arm.upper - SETTINGS.margin_rad)
    return joints
