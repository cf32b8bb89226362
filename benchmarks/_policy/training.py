"""A policy trained on demonstrations, and its answers."""

from __future__ import annotations

import logging
import time
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from benchmarks._policy.demonstrations import Demonstrations
from benchmarks._policy.features import TARGET, Objects, poses_of, seen_by, targets_of
from benchmarks._policy.hands import HandPoses, Hands
from benchmarks._policy.network import ChunkPolicy, Size, loss_of

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Noise:
    """Displacement of the hands in training: their targets stay, so that the policy learns to come back to the way.

    Args:
        position_m, rotation_rad, opening: standard deviations.
        spread: of the logarithm of a factor by which a frame's noise is larger or smaller.
        share: of the frames that get any.
    """

    position_m: float = 0.006
    rotation_rad: float = 0.025
    opening: float = 0.02
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


@dataclass(frozen=True)
class Scale:
    """Mean and deviation of the numbers of inputs (F,) and targets (:data:`TARGET`,)."""

    input_mean: torch.Tensor
    input_deviation: torch.Tensor
    target_mean: torch.Tensor
    target_deviation: torch.Tensor

    @classmethod
    def of(cls, inputs: torch.Tensor, targets: torch.Tensor) -> Scale:
        """The scale of (N, F) inputs and (N, K, A, :data:`TARGET`) targets; one for all directions in space."""
        deviation = targets.std(dim=(0, 1, 2)).clip(1e-3)
        deviation[:3], deviation[3:-1] = deviation[:3].mean(), deviation[3:-1].mean()
        return cls(inputs.mean(dim=0), inputs.std(dim=0).clip(1e-3), targets.mean(dim=(0, 1, 2)), deviation)

    def inputs(self, inputs: torch.Tensor) -> torch.Tensor:
        """Inputs with mean 0 and deviation 1."""
        return ((inputs - self.input_mean) / self.input_deviation).clip(-5, 5)

    def targets(self, targets: torch.Tensor) -> torch.Tensor:
        """Targets with mean 0 and deviation 1."""
        return (targets - self.target_mean) / self.target_deviation

    def told(self, targets: torch.Tensor) -> torch.Tensor:
        """The inverse of :meth:`targets`."""
        return targets * self.target_deviation + self.target_mean


class Policy:
    """A network with what its numbers mean.

    Args:
        robot: name of the robot.
        names, object_names: of the numbers of a state and of its objects.
        objects: ids of the objects that the task is about.
        scale: of inputs and targets.
        size: of the network.
    """

    def __init__(
        self,
        robot: str,
        names: tuple[str, ...],
        object_names: tuple[str, ...],
        objects: Collection[str],
        scale: Scale,
        size: Size,
    ):
        self.facts = {"robot": robot, "names": names, "object_names": object_names, "objects": sorted(objects)}
        self.scale, self.size = scale, size
        self.hands, self.objects = Hands(robot, names), Objects(object_names, objects)
        self.network = ChunkPolicy(len(scale.input_mean), len(self.hands) * TARGET, size)

    def infer(self, observation: Mapping[str, Any]) -> dict[str, NDArray[np.float64]]:
        """Return ``actions`` (chunk, D), absolute targets, for ``observation/state`` and ``…/environment_state``."""
        state = np.asarray(observation["observation/state"], np.float64)
        objects = np.asarray(observation["observation/environment_state"], np.float64)
        hands = self.hands.poses(state[None])
        with torch.inference_mode():
            chunks, scores = self.network(self.scale.inputs(seen_by(hands, self.objects.poses(objects[None]))))
        chunk = chunks[0, int(scores[0].argmax())].unflatten(-1, (len(self.hands), TARGET))
        return {"actions": self.hands.states(poses_of(self.scale.told(chunk), hands), state)}

    def write(self, path: Path) -> None:
        """Write all that :meth:`read` needs."""
        kept = {**self.facts, "scale": vars(self.scale), "size": asdict(self.size)}
        torch.save({**kept, "weights": self.network.state_dict()}, path)

    @classmethod
    def read(cls, path: Path) -> Policy:
        """Read what :meth:`write` wrote."""
        kept = torch.load(path, weights_only=True)
        weights, scale, size = kept.pop("weights"), Scale(**kept.pop("scale")), Size(**kept.pop("size"))
        policy = cls(**kept, scale=scale, size=size)
        policy.network.load_state_dict(weights)
        policy.network.eval()
        return policy


class Batches:
    """Inputs and targets of frames.

    Args:
        demonstrations: all frames.
        hands: of the robot.
        objects: that the task is about.
        training: its noise, and the length of its chunks.
    """

    def __init__(self, demonstrations: Demonstrations, hands: Hands, objects: Objects, training: Training):
        self._noise = training.noise
        self._hands, self._future = hands.poses(demonstrations.states), hands.poses(demonstrations.actions)
        self._objects = objects.poses(demonstrations.objects)
        self._next = torch.from_numpy(demonstrations.next_frames(training.size.chunk))

    def __len__(self) -> int:
        """Number of frames."""
        return len(self._next)

    def __getitem__(self, frames: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """(N, F) inputs with fresh noise, and their (N, K, A, :data:`TARGET`) targets."""
        hands = self._noise.added(self._hands[frames])
        return seen_by(hands, self._objects[frames]), targets_of(hands, self._future[self._next[frames]])


def trained(demonstrations: Demonstrations, robot: str, objects: Collection[str], training: Training) -> Policy:
    """Train a policy.

    Args:
        demonstrations: the data.
        robot: name of the robot.
        objects: ids of the objects that the task is about.
        training: settings.
    """
    torch.manual_seed(training.seed)
    hands, seen = Hands(robot, demonstrations.names), Objects(demonstrations.object_names, objects)
    batches = Batches(demonstrations, hands, seen, training)
    scale = Scale.of(*batches[torch.arange(len(batches))])
    policy = Policy(robot, demonstrations.names, demonstrations.object_names, objects, scale, training.size)
    _fit(policy, batches, training)
    return policy


def _fit(policy: Policy, batches: Batches, training: Training) -> None:
    network, length = policy.network, training.minutes * 60
    optimiser = torch.optim.AdamW(network.parameters(), lr=training.rate, weight_decay=training.decay)
    begun, step, mean = time.process_time(), 0, 0.0
    network.train()
    while (spent := time.process_time() - begun) < length:
        for group in optimiser.param_groups:
            group["lr"] = training.rate * min(1.0, (step + 1) / 100) * 0.5 * (1 + np.cos(np.pi * spent / length))
        inputs, targets = batches[torch.randint(len(batches), (training.batch,))]
        loss = loss_of(network(policy.scale.inputs(inputs)), policy.scale.targets(targets).flatten(-2))
        optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), 1.0)
        optimiser.step()
        step, mean = step + 1, 0.98 * mean + 0.02 * float(loss.detach())
        if step % 500 == 0:
            logger.info("step %d, loss %.4f, %.0f of %.0f s", step, mean, spent, length)
    network.eval()
