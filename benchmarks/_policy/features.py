"""The input and the output of the policy's network, in the frame of each hand.

A hand that is to grasp an object moves to it in the same way wherever both are. So objects are seen from each hand, and
its next poses are told in the frame of its present one.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from benchmarks._policy.hands import HandPoses

POSE = 9
"""Numbers of a pose: position, and the first two columns of its rotation."""

TARGET = POSE + 1
"""Numbers of a target of a hand: its pose, and the opening of the gripper."""


@dataclass(frozen=True)
class ObjectPoses:
    """Poses of O objects, N times.

    Args:
        position: (N, O, 3) in the world, metres.
        axes: (N, O, 2, 3) the first two columns of their rotations.
        parts: (N, J) positions of their moving parts, metres or radians.
    """

    position: torch.Tensor
    axes: torch.Tensor
    parts: torch.Tensor

    def __getitem__(self, which: torch.Tensor) -> ObjectPoses:
        """Those of some times."""
        return ObjectPoses(self.position[which], self.axes[which], self.parts[which])


def only_positions(position: torch.Tensor) -> ObjectPoses:
    """Objects of which nothing but the position (N, O, 3) is known."""
    return ObjectPoses(position, position.new_zeros(*position.shape[:2], 0, 3), position.new_zeros(len(position), 0))


class Objects:
    """The objects of a task among those of a state.

    Args:
        names: of the M numbers of the objects of a state.
        objects: ids of those that the task is about.
        turned: tell how they are turned, and how their parts stand; else only where they are, as a localiser does.
    """

    def __init__(self, names: Sequence[str], objects: Collection[str], turned: bool = True):
        self.ids = [name[:-2] for name in names if name.endswith(".x") and name[:-2] in objects]
        self._turned = turned
        self._poses = [i for i, name in enumerate(names) if name.endswith(".x") and name[:-2] in objects]
        self._parts = [i for i, name in enumerate(names) if ".part" in name and name.partition(".part")[0] in objects]

    def poses(self, numbers: NDArray[np.float64]) -> ObjectPoses:
        """The poses for (N, M) numbers."""
        told = torch.from_numpy(numbers.astype(np.float32))
        poses = torch.stack([told[:, first : first + POSE] for first in self._poses], dim=1)
        axes, parts = poses[..., 3:].unflatten(-1, (2, 3)), told[:, self._parts]
        return ObjectPoses(poses[..., :3], axes, parts) if self._turned else only_positions(poses[..., :3])


def seen_by(hands: HandPoses, objects: ObjectPoses) -> torch.Tensor:
    """(N, F) objects and other hands in the frame of each hand, its height and tilt, openings and moving parts."""
    count, number = hands.opening.shape
    inverse = hands.rotation.transpose(-1, -2)
    away = objects.position[:, None] - hands.position[:, :, None]
    rows = [
        hands.opening,
        hands.position[..., 2],
        hands.rotation[..., 2, :],
        torch.einsum("nhij,nhoj->nhoi", inverse, away),
        torch.einsum("nhij,noaj->nhoai", inverse, objects.axes),
        objects.parts,
    ]
    for shift in range(1, number):
        rows.append((inverse @ (hands.position.roll(shift, 1) - hands.position)[..., None])[..., 0])
        rows.append((inverse @ hands.rotation.roll(shift, 1))[..., :2])
    return torch.cat([row.reshape(count, -1) for row in rows], dim=1)


def targets_of(hands: HandPoses, future: HandPoses) -> torch.Tensor:
    """(N, K, A, :data:`TARGET`) of (N, A) hands and their next poses (N, K, A)."""
    inverse = hands.rotation.transpose(-1, -2)[:, None]
    moved = (inverse @ (future.position - hands.position[:, None])[..., None])[..., 0]
    turned = (inverse @ future.rotation)[..., :2].flatten(-2)
    return torch.cat([moved, turned, future.opening[..., None]], dim=-1)


def poses_of(targets: torch.Tensor, hands: HandPoses) -> HandPoses:
    """The K next poses of one time's hands, for (K, A, :data:`TARGET`) targets; the inverse of :func:`targets_of`."""
    columns = targets[..., 3:POSE].unflatten(-1, (3, 2))
    first = torch.nn.functional.normalize(columns[..., 0], dim=-1)
    second = torch.nn.functional.normalize(
        columns[..., 1] - first * (first * columns[..., 1]).sum(-1, keepdim=True), dim=-1
    )
    turned = torch.stack([first, second, torch.linalg.cross(first, second)], dim=-1)
    moved = (hands.rotation @ targets[..., :3, None])[..., 0]
    return HandPoses(hands.position + moved, hands.rotation @ turned, targets[..., POSE])
