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
class FeatureSettings:
    """Scales of what the networks see.

    Args:
        near_m: farther away, positions are told on a logarithmic scale, too: a grasp needs millimetres, the way to it
            decimetres.
        smallest_deviation: of a number, by which it is divided: what never changes in demonstrations, as a part that
            nobody moves, may be touched by a policy.
        most_deviations: from the mean, at which a number is clipped.
    """

    near_m: float = 0.01
    smallest_deviation: float = 0.01
    most_deviations: float = 5.0


SETTINGS = FeatureSettings()


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

    def to(self, device: str) -> ObjectPoses:
        """Those on a device of torch."""
        return ObjectPoses(self.position.to(device), self.axes.to(device), self.parts.to(device))


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

    @property
    def axes(self) -> int:
        """Number of axes that are told of an object."""
        return 2 if self._turned else 0

    def poses(self, numbers: NDArray[np.float64]) -> ObjectPoses:
        """The poses for (N, M) numbers."""
        told = torch.from_numpy(numbers.astype(np.float32))
        poses = torch.stack([told[:, first : first + POSE] for first in self._poses], dim=1)
        axes, parts = poses[..., 3:].unflatten(-1, (2, 3)), told[:, self._parts]
        return ObjectPoses(poses[..., :3], axes, parts) if self._turned else only_positions(poses[..., :3])


@dataclass(frozen=True)
class Seen:
    """The view of A hands, N times, each in its own frame.

    Args:
        features: (N, F) all of it, and the state of the hands.
        places: (N, A, O, 3) positions of the objects that count, metres.
        axes: (N, A, V, 3) the axes of these objects.
    """

    features: torch.Tensor
    places: torch.Tensor
    axes: torch.Tensor


def seen_by(hands: HandPoses, objects: ObjectPoses, first: int) -> Seen:
    """Objects and other hands in the frame of each hand, its height and tilt, openings and moving parts.

    Args:
        hands: N times.
        objects: likewise.
        first: number of the objects that count, which come first, and of these the place last; of the others only the
            positions are seen.
    """
    count, number = hands.opening.shape
    inverse, places = hands.rotation.transpose(-1, -2), hands.places(objects.position)
    axes = torch.einsum("nhij,noaj->nhoai", inverse, objects.axes[:, :first])
    rows = [
        hands.opening,
        hands.position[..., 2],
        hands.rotation[..., 2, :],
        places,
        torch.asinh(places[:, :, :first] / SETTINGS.near_m),
        axes,
        objects.parts,
        around := _around(objects, first - 1),
        torch.asinh(around / SETTINGS.near_m),
    ]
    for shift in range(1, number):
        rows.append((inverse @ (hands.position.roll(shift, 1) - hands.position)[..., None])[..., 0])
        rows.append((inverse @ hands.rotation.roll(shift, 1))[..., :2])
    features = torch.cat([row.reshape(count, -1) for row in rows], dim=1)
    return Seen(features, places[:, :, :first], axes.flatten(2, 3))


def aimed(seen: Seen, aims: torch.Tensor) -> torch.Tensor:
    """(N, F') features of what is seen, and of the poses (N, A, :data:`TARGET`) that the hands aim at."""
    place = aims[..., :3]
    return torch.cat(
        [seen.features, place.flatten(1), torch.asinh(place / SETTINGS.near_m).flatten(1), aims[..., 3:].flatten(1)], 1
    )


def deviations(numbers: torch.Tensor) -> torch.Tensor:
    """(F,) standard deviations of (…, F) numbers, none of them too small to divide by."""
    return numbers.flatten(0, -2).std(dim=0).clip(SETTINGS.smallest_deviation)


def standardised(numbers: torch.Tensor, mean: torch.Tensor, deviation: torch.Tensor) -> torch.Tensor:
    """Numbers with mean 0 and deviation 1; far ones are clipped."""
    return ((numbers - mean) / deviation).clip(-SETTINGS.most_deviations, SETTINGS.most_deviations)


def frames(axes: torch.Tensor) -> torch.Tensor:
    """(…, 3, 3) rotations from the world into objects with these axes (…, V, 3); none where V is 0."""
    if not axes.shape[-2]:
        return torch.eye(3, device=axes.device).expand(*axes.shape[:-2], 3, 3)
    return torch.cat([axes, torch.linalg.cross(axes[..., 0, :], axes[..., 1, :])[..., None, :]], dim=-2)


def _around(objects: ObjectPoses, place: int) -> torch.Tensor:
    """(N, O, 3) where the objects lie as one of them sees them: which part of a plate is free."""
    away = objects.position - objects.position[:, place, None]
    return torch.einsum("nij,noj->noi", frames(objects.axes[:, place]), away)


def moved_with_objects(targets: torch.Tensor, weights: torch.Tensor, seen: Seen) -> torch.Tensor:
    """Targets that move and turn with objects, as the hand sees them.

    A hand grasps a block wherever it is in the same place of the block. To add the block's position to such a target is
    exact; to learn that sum takes many demonstrations.

    Args:
        targets: (N, W, K, A, :data:`TARGET`) without objects.
        weights: (N, W, K, A, O + 3 V) of places, of axes for the position in units of ``near_m``, and of axes for
            both columns of the rotation.
        seen: N times.
    """
    number, turns = seen.places.shape[2], seen.axes.shape[2]
    to_places, to_axes, columns = weights.split([number, turns, 2 * turns], dim=-1)
    position = torch.einsum("nwkao,naoi->nwkai", to_places, seen.places)
    position = position + SETTINGS.near_m * torch.einsum("nwkav,navi->nwkai", to_axes, seen.axes)
    turned = torch.einsum("nwkacv,navi->nwkaic", columns.unflatten(-1, (2, turns)), seen.axes)
    return targets + torch.cat([position, turned.flatten(-2), torch.zeros_like(targets[..., :1])], dim=-1)


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
