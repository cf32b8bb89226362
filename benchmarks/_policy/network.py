"""A network that predicts some alternative chunks of targets, and which of them is right.

A planner takes this arm or that, and grasps a block from this side or that: of two ways that are as good, a mean is
none. So each alternative is trained on the demonstrations that it predicts best (A. Guzmán-Rivera et al., "Multiple
Choice Learning", NeurIPS 2012), and a classifier learns which that will be.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import torch
from torch import nn
from torch.nn.functional import cross_entropy


@dataclass(frozen=True)
class LossSettings:
    """Shares of the loss beside the error of the nearest alternative.

    Args:
        all_ways: of the mean error of all alternatives, which keeps each of them near the demonstrations.
        classifier: of the classifier.
    """

    all_ways: float = 0.05
    classifier: float = 0.1


SETTINGS = LossSettings()


@dataclass(frozen=True)
class Size:
    """Size of a policy.

    Args:
        chunk: targets that it predicts at once.
        width, layers: of its hidden layers.
        ways: alternative chunks.
        aims: alternative aims.
    """

    chunk: int = 8
    width: int = 256
    layers: int = 4
    ways: int = 2
    aims: int = 8

    def of_aims(self) -> Size:
        """The size of the network that aims."""
        return replace(self, chunk=1, ways=self.aims)


class ChunkPolicy(nn.Module):
    """Features → alternative chunks, and the score of each.

    Args:
        features: F numbers of an input.
        numbers: D of a step of a chunk.
        size: of the network.
    """

    def __init__(self, features: int, numbers: int, size: Size):
        super().__init__()
        self.size, self.numbers = size, numbers
        widths = [features, *[size.width] * size.layers]
        layers = [nn.Sequential(nn.Linear(a, b), nn.LayerNorm(b), nn.GELU()) for a, b in itertools.pairwise(widths)]
        self.body = nn.Sequential(*layers)
        self.chunks = nn.Linear(size.width, size.ways * size.chunk * numbers)
        self.scores = nn.Linear(size.width, size.ways)

    def forward(self, features: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """(N, ways, chunk, D) and (N, ways) of (N, F)."""
        hidden = self.body(features)
        return self.chunks(hidden).view(-1, self.size.ways, self.size.chunk, self.numbers), self.scores(hidden)


def loss_of(given: tuple[torch.Tensor, torch.Tensor], wanted: torch.Tensor) -> torch.Tensor:
    """Mean error of the nearest alternative, a small share of the mean over all, and the error of the classifier.

    Args:
        given: (N, ways, chunk, …) alternatives, and the score (N, ways) of each.
        wanted: (N, chunk, …) numbers.
    """
    chunks, scores = given
    errors = (chunks - wanted[:, None]).abs().flatten(2).mean(dim=2)
    nearest, which = errors.min(dim=1)
    return nearest.mean() + SETTINGS.all_ways * errors.mean() + SETTINGS.classifier * cross_entropy(scores, which)
