"""The training of a policy on demonstrations."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import torch
from torch.nn.functional import binary_cross_entropy_with_logits

from benchmarks._policy.demonstrations import Demonstrations
from benchmarks._policy.features import ObjectPoses, targets_of
from benchmarks._policy.fitting import fit
from benchmarks._policy.hands import HandPoses
from benchmarks._policy.network import Size, loss_of
from benchmarks._policy.policy import Meaning, Policy, Scale
from benchmarks._policy.steps import Progress


@dataclass(frozen=True)
class Noise:
    """Displacement of hands and objects in training: targets stay, so that the policy learns to come back to the way.

    Args:
        position_m, rotation_rad, opening: standard deviations of hands.
        object_m: of the positions of objects.
        spread: of the logarithm of a factor by which a frame's noise is larger or smaller.
        share: of the frames that get any.
    """

    position_m: float = 0.006
    rotation_rad: float = 0.025
    opening: float = 0.02
    object_m: float = 0.0
    spread: float = 0.5
    share: float = 0.8

    def added(self, hands: HandPoses) -> HandPoses:
        """Displaced hands."""
        count, number = hands.opening.shape
        factor = (torch.rand(count, 1, 1) < self.share) * torch.exp(torch.randn(count, 1, 1) * self.spread)
        turn = torch.randn(count, number, 3) * self.rotation_rad * factor
        x, y, z, none = *turn.unbind(-1), torch.zeros(count, number)
        skew = torch.stack([none, -z, y, z, none, -x, -y, x, none], dim=-1).unflatten(-1, (3, 3))
        return HandPoses(
            hands.position + torch.randn(count, number, 3) * self.position_m * factor,
            hands.rotation @ torch.linalg.matrix_exp(skew),
            (hands.opening + torch.randn(count, number) * self.opening).clip(0, 1),
        )

    def moved(self, objects: ObjectPoses) -> ObjectPoses:
        """Displaced objects."""
        return replace(objects, position=objects.position + torch.randn_like(objects.position) * self.object_m)


@dataclass(frozen=True)
class Training:
    """Settings of a training.

    Args:
        minutes: of CPU time, on one core.
        batch: frames of a step.
        rate: highest learning rate; it falls to none along a cosine.
        decay: of the weights.
        seed: of weights, noise and order.
        noise: on the hands.
        size: of the network.
        presses: opening by which a gripper stays above its target where it presses on something, 0 closed to 1 open.
        press_frames: frames in which a gripper without anything between its fingers reaches its target.
        progress_share: time to learn which sub-tasks are done, as a share of that of the policy.
    """

    minutes: float = 10.0
    batch: int = 384
    rate: float = 1e-3
    decay: float = 1e-3
    seed: int = 0
    noise: Noise = field(default_factory=Noise)
    size: Size = field(default_factory=Size)
    presses: float = 0.05
    press_frames: int = 5
    progress_share: float = 0.1


class Batches:
    """Inputs and targets of frames.

    Args:
        demonstrations: all frames.
        meaning: of their numbers.
        training: its noise, and the length of its chunks.

    Attributes:
        progress: tells the sub-task of each frame, as it will where the policy acts; None if there is but one.
    """

    def __init__(self, demonstrations: Demonstrations, meaning: Meaning, training: Training):
        self._noise, hands = training.noise, meaning.hands()
        self._hands, self._future = hands.poses(demonstrations.states), hands.poses(demonstrations.actions)
        self._objects = meaning.seen_objects().poses(demonstrations.objects)
        self._next = torch.from_numpy(demonstrations.next_frames(training.size.chunk))
        self._sequence = meaning.sequence()
        later = torch.from_numpy(demonstrations.next_frames(training.press_frames + 1)[:, -1])
        presses = self._future.opening < self._hands.opening[later] - training.presses
        back = np.arange(len(self)) > demonstrations.releases(presses.any(dim=1).numpy())
        self._next_step = torch.from_numpy(demonstrations.steps + back)
        self.progress: Progress | None = None

    def __len__(self) -> int:
        """Number of frames."""
        return len(self._next)

    def __getitem__(self, frames: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """(N, F) inputs with fresh noise, and their (N, K, A, :data:`TARGET`) targets."""
        hands = self._noise.added(self._hands[frames])
        objects = self._noise.moved(self._objects[frames])
        inputs = self._sequence.inputs(hands, objects, self._sequence.next_of(self.progress, hands, objects))
        return inputs, targets_of(hands, self._future[self._next[frames]])

    def relations(self, frames: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """(N, K, R) relations of the sub-tasks with fresh noise, and (N, K) 1 where these are done.

        A sub-task is done when its object is released: so the way back of the hand belongs to the next.
        """
        hands, objects = self._noise.added(self._hands[frames]), self._objects[frames]
        done = self._next_step[frames][:, None] > torch.arange(len(self._sequence))
        return self._sequence.relations(hands, self._noise.moved(objects)), done.float()


def trained(demonstrations: Demonstrations, meaning: Meaning, training: Training) -> Policy:
    """Train a policy on states."""
    torch.manual_seed(training.seed)
    batches = Batches(demonstrations, meaning, training)
    if len(meaning.steps) > 1:
        batches.progress = _progress(batches, training)
    scale = Scale.of(*batches[torch.arange(len(batches))])
    policy = Policy(meaning, scale, training.size, batches.progress)

    def loss() -> torch.Tensor:
        inputs, targets = batches[torch.randint(len(batches), (training.batch,))]
        return loss_of(policy.network(scale.inputs(inputs)), scale.targets(targets).flatten(-2))

    fit(policy.network, loss, name="policy", minutes=training.minutes, rate=training.rate, decay=training.decay)
    return policy


def _progress(batches: Batches, training: Training) -> Progress:
    """Train the part that tells which sub-tasks are done, in a share of the time."""
    relations, _ = batches.relations(torch.arange(len(batches)))
    progress = Progress(relations.shape[-1])
    progress.scaled_by(relations)

    def loss() -> torch.Tensor:
        told, done = batches.relations(torch.randint(len(batches), (training.batch,)))
        return binary_cross_entropy_with_logits(progress(told), done)

    minutes = training.progress_share * training.minutes
    fit(progress, loss, name="progress", minutes=minutes, rate=training.rate, decay=training.decay)
    return progress
