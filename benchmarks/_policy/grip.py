"""Objects in the grip of a hand: which those are, and how noise in training moves them.

A hand that has grasped an object a bit beside its middle has to make up for that where it puts it. Demonstrations grasp
exactly, and do not show this. So in training a held object moves along with the noise of its hand, and is shifted in
it, and the targets of the hand bring it to where the demonstration put it.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch

from benchmarks._policy.features import ObjectPoses
from benchmarks._policy.hands import HandPoses


@dataclass(frozen=True)
class GripSettings:
    """Settings that tell held objects.

    Args:
        reach_m: distance from the hand within which it may hold an object.
        rigid_m: shift in the hand from one frame to the next up to which it does.
    """

    reach_m: float = 0.15
    rigid_m: float = 0.002


SETTINGS = GripSettings()


def held(hands: HandPoses, objects: ObjectPoses, following: torch.Tensor, may: torch.Tensor) -> torch.Tensor:
    """(N, A, O) a hand holds an object: it keeps its place there until the next frame. None is held by two hands.

    Args:
        hands: N times.
        objects: likewise.
        following: (N,) the next frame of each.
        may: (N, A, O) objects that may be held.
    """
    places = hands.places(objects.position)
    shifts = places[following] - places
    found = may & (places.norm(dim=-1) < SETTINGS.reach_m) & (shifts.norm(dim=-1) < SETTINGS.rigid_m)
    return found & (found.sum(dim=1, keepdim=True) == 1)


def carried(
    objects: ObjectPoses, holds: torch.Tensor, before: HandPoses, after: HandPoses, slips: torch.Tensor
) -> ObjectPoses:
    """Objects, of which the held ones move with their hand.

    Args:
        objects: N times.
        holds: (N, A, O) the hand that holds an object.
        before, after: the hands before and after they move.
        slips: (N, A, 3) shifts of objects in their hand, in its frame.
    """
    places = before.places(objects.position) + slips[:, :, None]
    position = torch.einsum("naij,naoj->naoi", after.rotation, places) + after.position[:, :, None]
    turns = after.rotation @ before.rotation.transpose(-1, -2)
    axes = torch.einsum("naij,novj->naovi", turns, objects.axes)
    some, by = holds.any(dim=1)[..., None], holds[..., None]
    return ObjectPoses(
        torch.where(some, (by * position).sum(dim=1), objects.position),
        torch.where(some[..., None], (by[..., None] * axes).sum(dim=1), objects.axes),
        objects.parts,
    )


def compensated(future: HandPoses, slips: torch.Tensor) -> HandPoses:
    """Poses (N, K, A) of hands that bring objects shifted in them by (N, A, 3) to the same places."""
    shift = torch.einsum("nkaij,naj->nkai", future.rotation, slips)
    return HandPoses(future.position - shift, future.rotation, future.opening)
