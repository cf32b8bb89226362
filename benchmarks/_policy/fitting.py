"""Gradient descent for so many steps."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from torch import nn

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class FittingSettings:
    """Settings of the descent.

    Args:
        warm_up: steps until the learning rate is highest.
        most_gradient: norm of a gradient, to which longer ones are cut.
        logged: steps between two lines of the log.
        smoothing: share of the last step in the mean loss of the log.
    """

    warm_up: int = 100
    most_gradient: float = 1.0
    logged: int = 200
    smoothing: float = 0.02


SETTINGS = FittingSettings()


def fit(
    network: nn.Module, loss: Callable[[], torch.Tensor], *, name: str, steps: int, rate: float, decay: float
) -> float:
    """Train a network by AdamW; its learning rate falls to none along a cosine.

    The number of steps is given, not the time: a machine with other work would else train less.

    Args:
        network: in training mode meanwhile, and in evaluation mode afterwards.
        loss: of the next batch.
        name: for the log.
        steps: their number.
        rate: highest learning rate, reached after a warm-up.
        decay: of the weights.

    Returns:
        Seconds of CPU time of this process.
    """
    optimiser = torch.optim.AdamW(network.parameters(), lr=rate, weight_decay=decay)
    begun, mean = time.process_time(), 0.0
    network.train()
    for step in range(steps):
        for group in optimiser.param_groups:
            group["lr"] = rate * min(1.0, (step + 1) / SETTINGS.warm_up) * 0.5 * (1 + np.cos(np.pi * step / steps))
        found = loss()
        optimiser.zero_grad()
        found.backward()
        nn.utils.clip_grad_norm_(network.parameters(), SETTINGS.most_gradient)
        optimiser.step()
        mean += SETTINGS.smoothing * (float(found.detach()) - mean)
        if (step + 1) % SETTINGS.logged == 0:
            spent = time.process_time() - begun
            logger.info("%s: step %d of %d, loss %.4f, %.0f s", name, step + 1, steps, mean, spent)
    network.eval()
    return time.process_time() - begun
