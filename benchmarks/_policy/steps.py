"""The sub-task that is next, told from the state, and its objects first.

A policy of several sub-tasks is one of a single sub-task, repeated: it sees the objects of the sub-task that is next in
the first places, and those of the others behind. A sub-task counts as done by where its object is relative to its place
and to the hands, never by what the hands did before: so a grasp that missed is seen.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import torch
from torch import nn
from torch.nn.functional import one_hot

from benchmarks._policy.features import ObjectPoses, Objects, Seen, deviations, frames, seen_by, standardised
from benchmarks._policy.hands import HandPoses


class Steps:
    """The sub-tasks of a task, in order.

    Args:
        steps: ids of the objects of each: the moved one, and then its place if that is an object.
        ids: of the objects of a state, in their order.
    """

    def __init__(self, steps: Sequence[Sequence[str]], ids: Sequence[str]):
        own = [[ids.index(name) for name in step] for step in steps]
        rolled = [[place for step in own[first:] + own[:first] for place in step] for first in range(len(own))]
        self._order = torch.tensor([list(dict.fromkeys(row)) for row in rolled])
        self._moved = torch.tensor([step[0] for step in own])
        self._place = torch.tensor([step[1] if len(step) > 1 else step[0] for step in own])
        self._others = torch.tensor([[place not in step for place in range(len(ids))] for step in own])
        self._first = min(map(len, own))

    def __len__(self) -> int:
        """Number of sub-tasks."""
        return len(self._order)

    def weights(self, objects: Objects) -> int:
        """Number of weights of a target: see :func:`~benchmarks._policy.features.moved_with_objects`."""
        return self._first * (1 + 3 * objects.axes)

    def seen(self, hands: HandPoses, objects: ObjectPoses, step: torch.Tensor) -> Seen:
        """The objects as the hands see them, those of the sub-tasks (N,) first; and which of several these are."""
        times, order = torch.arange(len(step), device=step.device)[:, None], self._order.to(step.device)[step]
        ordered = ObjectPoses(objects.position[times, order], objects.axes[times, order], objects.parts)
        seen = seen_by(hands, ordered, self._first)
        if len(self) == 1:
            return seen
        return replace(seen, features=torch.cat([seen.features, one_hot(step, len(self)).float()], dim=1))

    def moved(self, step: torch.Tensor) -> torch.Tensor:
        """(N, O) the object that each of the sub-tasks (N,) moves."""
        return one_hot(self._moved.to(step.device)[step], self._others.shape[1]).bool()

    def only_moved(self) -> torch.Tensor:
        """(O,) objects that are moved, and are no place of another."""
        numbers = torch.arange(self._others.shape[1])
        return torch.isin(numbers, self._moved) & ~torch.isin(numbers, self._place)

    def others(self, step: torch.Tensor) -> torch.Tensor:
        """(N, O) objects that the sub-tasks (N,) are not about."""
        return self._others.to(step.device)[step]

    def relations(self, hands: HandPoses, objects: ObjectPoses) -> torch.Tensor:
        """(N, K, R) the object of each sub-task as its place and as the hands see it, and the moving parts."""
        count, number = len(objects.position), len(self)
        moved, frame = objects.position[:, self._moved], frames(objects.axes[:, self._place])
        place = torch.einsum("nkij,nkj->nki", frame, moved - objects.position[:, self._place])
        axes = torch.einsum("nkij,nkaj->nkai", frame, objects.axes[:, self._moved]).flatten(2)
        reach = hands.places(moved).transpose(1, 2).flatten(2)
        shared = torch.cat([hands.opening, objects.parts], dim=1)[:, None].expand(count, number, -1)
        names = torch.eye(number, device=moved.device).expand(count, -1, -1)
        return torch.cat([place, axes, reach, shared, names], dim=2)

    def next_of(self, progress: Progress | None, hands: HandPoses, objects: ObjectPoses) -> torch.Tensor:
        """(N,) the next sub-task; the first where nothing tells."""
        if progress is None:
            return torch.zeros(len(objects.position), dtype=torch.long, device=objects.position.device)
        with torch.no_grad():
            return progress.next_step(self.relations(hands, objects))


class Progress(nn.Module):
    """Tells from the relations of a sub-task if it is done.

    Args:
        relations: R numbers.
        width: of its hidden layers.
    """

    def __init__(self, relations: int, width: int = 64):
        super().__init__()
        self.mean: torch.Tensor
        self.deviation: torch.Tensor
        self.register_buffer("mean", torch.zeros(relations))
        self.register_buffer("deviation", torch.ones(relations))
        self.body = nn.Sequential(
            nn.Linear(relations, width), nn.GELU(), nn.Linear(width, width), nn.GELU(), nn.Linear(width, 1)
        )

    def scaled_by(self, relations: torch.Tensor) -> None:
        """Take the scale of (N, K, R) relations."""
        self.mean.copy_(relations.mean(dim=(0, 1)))
        self.deviation.copy_(deviations(relations))

    def forward(self, relations: torch.Tensor) -> torch.Tensor:
        """(N, K) logits of (N, K, R)."""
        return self.body(standardised(relations, self.mean, self.deviation))[..., 0]

    def next_step(self, relations: torch.Tensor) -> torch.Tensor:
        """(N,) the sub-task behind the last that is done, or the last of all.

        One before it may be undone again: a drawer that was opened is closed in the end.
        """
        done = self(relations)[:, :-1] > 0
        return (done * torch.arange(1, relations.shape[1], device=done.device)).amax(dim=1)
