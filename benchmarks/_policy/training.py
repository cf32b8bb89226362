"""Training a policy on demonstrations, and its error on others."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch.nn.functional import l1_loss

from benchmarks._policy.demonstrations import Demonstrations
from benchmarks._policy.network import ChunkPolicy, Size
from vcage.base.files import atomic_path

logger = logging.getLogger(__name__)

SMALLEST_SPREAD = 0.01
"""Least standard deviation that numbers are divided by, as in ACT: an arm that never moves would else be all noise."""

SPOKEN_EVERY = 50
"""Steps from one line of the log to the next."""


@dataclass(frozen=True)
class Settings:
    """Settings of the training of a policy.

    Args:
        steps: of the optimiser.
        batch: frames in each.
        rate: the highest learning rate; it rises over the first twentieth of the steps and falls as a cosine.
        decay: of the weights, by AdamW.
        clip: largest norm of a gradient.
        size: of the network.
    """

    steps: int
    batch: int = 32
    rate: float = 1e-3
    decay: float = 1e-4
    clip: float = 1.0
    size: Size = field(default_factory=Size)


@dataclass(frozen=True)
class Scale:
    """Mean and spread, (D,) each, by which numbers are normalised."""

    mean: torch.Tensor
    spread: torch.Tensor

    @classmethod
    def of(cls, numbers: NDArray[np.float32]) -> Scale:
        """The scaling of (F, D) numbers."""
        spread = np.maximum(numbers.std(axis=0), SMALLEST_SPREAD)
        return cls(torch.from_numpy(numbers.mean(axis=0)), torch.from_numpy(spread))

    def normalised(self, numbers: torch.Tensor) -> torch.Tensor:
        """Numbers in units of the spread."""
        return (numbers - self.mean.to(numbers.device)) / self.spread.to(numbers.device)

    def restored(self, numbers: torch.Tensor) -> torch.Tensor:
        """Numbers in their own units."""
        return numbers * self.spread.to(numbers.device) + self.mean.to(numbers.device)


class Policy:
    """A network with the scales of what it was trained on.

    Args:
        demonstrations: that it is trained on.
        size: of the network.
        seed: of its first weights.
    """

    def __init__(self, demonstrations: Demonstrations, size: Size, seed: int):
        torch.manual_seed(seed)
        self.device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
        self.states, self.actions = Scale.of(demonstrations.states), Scale.of(demonstrations.actions)
        _, cameras, height, width, _ = demonstrations.pictures.shape
        numbers = demonstrations.states.shape[1]
        self.network = ChunkPolicy(cameras, height, width, numbers, size).to(self.device)
        self.chunk = size.chunk

    def normalised(self, pictures: NDArray[np.uint8], states: NDArray[np.float32]) -> torch.Tensor:
        """(N, chunk, D) normalised actions for (N, C, H, W, 3) pictures and (N, D) states."""
        seen, measured = torch.from_numpy(pictures), torch.from_numpy(states)
        return self.network(seen.to(self.device), self.states.normalised(measured.to(self.device)))

    def act(self, pictures: NDArray[np.uint8], states: NDArray[np.float32]) -> NDArray[np.float32]:
        """The same in units of the actions, without gradients."""
        self.network.eval()
        with torch.inference_mode():
            return self.actions.restored(self.normalised(pictures, states)).cpu().numpy()


def trained(demonstrations: Demonstrations, settings: Settings, seed: int, name: str, kept: Path) -> Policy:
    """A trained policy; its weights are in a file, so that an interrupted benchmark resumes there."""
    policy = Policy(demonstrations, settings.size, seed)
    if kept.exists():
        policy.network.load_state_dict(torch.load(kept, map_location=policy.device, weights_only=True))
        return policy
    train(policy, demonstrations, settings, seed, _Log(name, settings.steps))
    with atomic_path(kept) as part:
        torch.save(policy.network.state_dict(), part)
    return policy


def train(
    policy: Policy,
    demonstrations: Demonstrations,
    settings: Settings,
    seed: int,
    told: Callable[[int, float], None] = lambda _step, _loss: None,
) -> None:
    """Train a policy by the L1 error of its chunks; the same seed sees the same frames in the same order.

    Args:
        told: called with the number of each step from 1, and its loss.
    """
    optimiser = torch.optim.AdamW(policy.network.parameters(), lr=settings.rate, weight_decay=settings.decay)
    schedule = torch.optim.lr_scheduler.LambdaLR(optimiser, lambda step: _rate(step, settings.steps))
    policy.network.train()
    batches = _batches(len(demonstrations), settings.batch, np.random.default_rng(seed))
    for step in range(1, settings.steps + 1):
        loss = _loss(policy, demonstrations, next(batches))
        optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(policy.network.parameters(), settings.clip)
        optimiser.step()
        schedule.step()
        told(step, float(loss.detach()))


def errors(policy: Policy, others: Demonstrations, batch: int = 64) -> dict[str, float]:
    """Mean L1 error of the chunks that a policy predicts at every frame of other episodes: of joints, radians, and of
    grippers, of their opening from 0 to 1."""
    batches = [np.arange(start, min(start + batch, len(others))) for start in range(0, len(others), batch)]
    given = np.concatenate([policy.act(others.pictures[frames], others.states[frames]) for frames in batches])
    return _errors(given, others)


def still(others: Demonstrations, chunk: int) -> dict[str, float]:
    """The same of one that stays where it is measured to be."""
    return _errors(np.repeat(others.states[:, None], chunk, axis=1), others)


def _errors(given: NDArray[np.float32], others: Demonstrations) -> dict[str, float]:
    """(F, chunk, D) actions, without the padding after the end of an episode."""
    wanted, valid = others.chunk(np.arange(len(others)), given.shape[1])
    per_number = np.abs(given - wanted)[valid].mean(axis=0)
    is_gripper = np.isin(np.arange(len(per_number)), others.grippers)
    found = {"error_rad": per_number[~is_gripper].mean(), "error_gripper": per_number[is_gripper].mean()}
    return {name: float(value) for name, value in found.items()}


def _loss(policy: Policy, demonstrations: Demonstrations, frames: NDArray[np.int64]) -> torch.Tensor:
    """Mean L1 error of normalised actions, those behind the end of an episode left out."""
    chunk, valid = demonstrations.chunk(frames, policy.chunk)
    wanted = policy.actions.normalised(torch.from_numpy(chunk).to(policy.device))
    given = policy.normalised(demonstrations.pictures[frames], demonstrations.states[frames])
    mask = torch.from_numpy(valid).to(policy.device)
    return l1_loss(given[mask], wanted[mask])


def _batches(count: int, batch: int, rng: np.random.Generator) -> Iterator[NDArray[np.int64]]:
    """Frames in random order, all once before one comes again."""
    order = np.empty(0, np.int64)
    while True:
        while len(order) < batch:
            order = np.concatenate([order, rng.permutation(count)])
        yield order[:batch]
        order = order[batch:]


def _rate(step: int, steps: int) -> float:
    """Share of the highest learning rate."""
    rise = max(1, steps // 20)
    if step < rise:
        return (step + 1) / rise
    return 0.5 * (1 + np.cos(np.pi * (step - rise) / max(1, steps - rise)))


class _Log:
    """Says now and then how far a training is."""

    def __init__(self, name: str, steps: int):
        self._name, self._steps = name, steps
        self._started, self._losses = time.perf_counter(), list[float]()

    def __call__(self, step: int, loss: float) -> None:
        self._losses.append(loss)
        if step % SPOKEN_EVERY and step != self._steps:
            return
        seconds = time.perf_counter() - self._started
        told = (self._name, step, self._steps, np.mean(self._losses), seconds, seconds * (self._steps / step - 1))
        logger.info("%s: step %d of %d, loss %.4f, %.0f s, about %.0f s left", *told)
        self._losses.clear()


def named(settings: Settings) -> dict[str, Any]:
    """The settings as plain values."""
    return asdict(settings)
