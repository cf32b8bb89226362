"""A policy trained on demonstrations, and its answers."""

from __future__ import annotations

import logging
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from benchmarks._policy.demonstrations import Demonstrations
from benchmarks._policy.features import Features
from benchmarks._policy.network import ChunkPolicy, Size, loss_of

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Training:
    """Settings of a training.

    Args:
        minutes: of wall time.
        batch: frames of a step.
        rate: highest learning rate; it falls to none along a cosine.
        noise_rad: standard deviation of what is added to the joints in copies of the demonstrations: their targets
            stay, so that the policy learns to come back to the way.
        copies: of each frame with noise.
        seed: of weights, noise and order.
        size: of the network.
    """

    minutes: float = 20.0
    batch: int = 512
    rate: float = 1e-3
    noise_rad: float = 0.02
    copies: int = 6
    seed: int = 0
    size: Size = field(default_factory=Size)


class Policy:
    """A network with what its numbers mean.

    Args:
        robot: name of the robot.
        names, object_names: of the numbers of a state and of the objects.
        scales: mean and deviation of features and of targets.
        size: of the network.
    """

    def __init__(
        self,
        robot: str,
        names: tuple[str, ...],
        object_names: tuple[str, ...],
        scales: Mapping[str, NDArray[np.float32]],
        size: Size,
    ):
        self.robot, self.names, self.object_names, self.scales, self.size = robot, names, object_names, scales, size
        self.features = Features(robot, names, object_names)
        self.joints = np.array(["_joint_" in name for name in names])
        self.network = ChunkPolicy(len(scales["input_mean"]), len(names), size)

    def infer(self, observation: Mapping[str, Any]) -> dict[str, NDArray[np.float64]]:
        """Return ``actions`` (chunk, D), absolute targets, for ``observation/state`` and ``…/environment_state``."""
        state = np.asarray(observation["observation/state"], np.float64)
        objects = np.asarray(observation["observation/environment_state"], np.float64)
        seen = self.normalised(self.features(state[None], objects[None]))
        with torch.inference_mode():
            chunks, scores = self.network(torch.from_numpy(seen))
        chunk = chunks[0, int(scores[0].argmax())].numpy() * self.scales["target_scale"] + self.scales["target_mean"]
        return {"actions": chunk.astype(np.float64) + np.where(self.joints, state, 0.0)}

    def normalised(self, features: NDArray[np.float32]) -> NDArray[np.float32]:
        """Features with mean 0 and deviation 1."""
        return ((features - self.scales["input_mean"]) / self.scales["input_scale"]).clip(-5, 5).astype(np.float32)

    def write(self, path: Path) -> None:
        """Write all that :meth:`read` needs."""
        facts = {"robot": self.robot, "names": self.names, "object_names": self.object_names}
        scales = {name: torch.from_numpy(values) for name, values in self.scales.items()}
        weights = self.network.state_dict()
        torch.save({**facts, "scales": scales, "size": asdict(self.size), "weights": weights}, path)

    @classmethod
    def read(cls, path: Path) -> Policy:
        """Read what :meth:`write` wrote."""
        kept = torch.load(path, weights_only=True)
        scales = {name: values.numpy() for name, values in kept["scales"].items()}
        policy = cls(kept["robot"], kept["names"], kept["object_names"], scales, Size(**kept["size"]))
        policy.network.load_state_dict(kept["weights"])
        policy.network.eval()
        return policy


def trained(demonstrations: Demonstrations, robot: str, training: Training) -> Policy:
    """Train a policy."""
    torch.manual_seed(training.seed)
    rng = np.random.default_rng(training.seed)
    joints = np.array(["_joint_" in name for name in demonstrations.names])
    chunks = demonstrations.chunks(training.size.chunk)
    measured = Features(robot, demonstrations.names, demonstrations.object_names)
    inputs, targets = [], []
    for copy in range(1 + training.copies):
        noise = training.noise_rad * rng.standard_normal(demonstrations.states.shape) * joints * (copy > 0)
        states = demonstrations.states + noise
        inputs.append(measured(states, demonstrations.objects))
        targets.append((chunks - np.where(joints, states, 0.0)[:, None]).astype(np.float32))
    seen, wanted = np.concatenate(inputs), np.concatenate(targets)
    scales = {
        "input_mean": seen.mean(axis=0),
        "input_scale": seen.std(axis=0).clip(1e-3),
        "target_mean": wanted.mean(axis=(0, 1)),
        "target_scale": wanted.std(axis=(0, 1)).clip(1e-3),
    }
    policy = Policy(robot, demonstrations.names, demonstrations.object_names, scales, training.size)
    wanted = (wanted - scales["target_mean"]) / scales["target_scale"]
    _fit(policy.network, torch.from_numpy(policy.normalised(seen)), torch.from_numpy(wanted), training)
    return policy


def _fit(network: ChunkPolicy, seen: torch.Tensor, wanted: torch.Tensor, training: Training) -> None:
    optimiser = torch.optim.AdamW(network.parameters(), lr=training.rate, weight_decay=1e-4)
    begun, step, mean = time.perf_counter(), 0, 0.0
    length = training.minutes * 60
    network.train()
    while (spent := time.perf_counter() - begun) < length:
        for group in optimiser.param_groups:
            group["lr"] = training.rate * min(1.0, (step + 1) / 100) * 0.5 * (1 + np.cos(np.pi * spent / length))
        chosen = torch.randint(len(seen), (training.batch,))
        loss = loss_of(network(seen[chosen]), wanted[chosen])
        optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), 1.0)
        optimiser.step()
        step, mean = step + 1, 0.98 * mean + 0.02 * float(loss.detach())
        if step % 200 == 0:
            logger.info("step %d, loss %.4f, %.0f of %.0f s", step, mean, spent, length)
    network.eval()
