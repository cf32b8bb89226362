"""The training of a policy on demonstrations."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import torch

from benchmarks._policy.demonstrations import Demonstrations
from benchmarks._policy.features import ObjectPoses, seen_by, targets_of
from benchmarks._policy.fitting import fit
from benchmarks._policy.hands import HandPoses
from benchmarks._policy.network import Size, loss_of
from benchmarks._policy.policy import Meaning, Policy, Scale


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
    """

    minutes: float = 10.0
    batch: int = 384
    rate: float = 1e-3
    decay: float = 1e-3
    seed: int = 0
    noise: Noise = field(default_factory=Noise)
    size: Size = field(default_factory=Size)


class Batches:
    """Inputs and targets of frames.

    Args:
        demonstrations: all frames.
        meaning: of their numbers.
        training: its noise, and the length of its chunks.
    """

    def __init__(self, demonstrations: Demonstrations, meaning: Meaning, training: Training):
        self._noise, hands = training.noise, meaning.hands()
        self._hands, self._future = hands.poses(demonstrations.states), hands.poses(demonstrations.actions)
        self._objects = meaning.seen_objects().poses(demonstrations.objects)
        self._next = torch.from_numpy(demonstrations.next_frames(training.size.chunk))

    def __len__(self) -> int:
        """Number of frames."""
        return len(self._next)

    def __getitem__(self, frames: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """(N, F) inputs with fresh noise, and their (N, K, A, :data:`TARGET`) targets."""
        hands = self._noise.added(self._hands[frames])
        return seen_by(hands, self._noise.moved(self._objects[frames])), targets_of(
            hands, self._future[self._next[frames]]
        )


def trained(demonstrations: Demonstrations, meaning: Meaning, training: Training) -> Policy:
    """Train a policy on states."""
    torch.manual_seed(training.seed)
    batches = Batches(demonstrations, meaning, training)
    scale = Scale.of(*batches[torch.arange(len(batches))])
    policy = Policy(meaning, scale, training.size)

    def loss() -> torch.Tensor:
        inputs, targets = batches[torch.randint(len(batches), (training.batch,))]
        return loss_of(policy.network(scale.inputs(inputs)), scale.targets(targets).flatten(-2))

    fit(policy.network, loss, name="policy", minutes=training.minutes, rate=training.rate, decay=training.decay)
    return policy
