"""A small policy that predicts chunks of actions from pictures, after ACT (Zhao et al. 2023, arXiv:2304.13705).

Of ACT it has convolutions over the pictures of each camera, a transformer over their cells and the state, and one query
per action of the chunk; sized down to two cores. It has no variational latent, which models how demonstrators differ:
here all demonstrations come from one planner.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import nn


@dataclass(frozen=True)
class Size:
    """Size of a policy.

    Args:
        chunk: actions that it predicts at once.
        width: of the transformer's tokens.
        heads, layers: of its encoder; the decoder has one layer, as ACT's in effect.
    """

    chunk: int = 20
    width: int = 64
    heads: int = 4
    layers: int = 2


class ChunkPolicy(nn.Module):
    """Pictures and a state → a chunk of actions, all normalised.

    Args:
        cameras: C, whose pictures share the convolutions.
        height, width: of the pictures, pixels.
        numbers: D of a state and of an action.
        size: of the network.
    """

    def __init__(self, cameras: int, height: int, width: int, numbers: int, size: Size):
        super().__init__()
        w = size.width
        # Large steps and no normalisation: on a processor the first maps cost the most.
        self.cells = nn.Sequential(
            nn.Conv2d(3, w // 2, 8, 4, 2), nn.ReLU(),
            nn.Conv2d(w // 2, w, 3, 2, 1), nn.ReLU(),
            nn.Conv2d(w, w, 3, 2, 1),
        )  # fmt: skip
        cells = self.cells(torch.zeros(1, 3, height, width)).shape[2:].numel()
        self.state = nn.Linear(numbers, w)
        self.places = nn.Parameter(0.02 * torch.randn(1, cameras * cells + 1, w))
        self.queries = nn.Parameter(0.02 * torch.randn(1, size.chunk, w))
        layer = {"d_model": w, "nhead": size.heads, "dim_feedforward": 4 * w, "dropout": 0.0, "batch_first": True}
        encoder = nn.TransformerEncoderLayer(**layer, norm_first=True)
        self.encoder = nn.TransformerEncoder(encoder, size.layers, nn.LayerNorm(w), enable_nested_tensor=False)
        self.decoder = nn.TransformerDecoderLayer(**layer, norm_first=True)
        self.actions = nn.Sequential(nn.LayerNorm(w), nn.Linear(w, numbers))

    def forward(self, pictures: torch.Tensor, states: torch.Tensor) -> torch.Tensor:
        """(N, chunk, D) of (N, C, H, W, 3) uint8 pictures and (N, D) states."""
        count = len(pictures)
        flat = pictures.flatten(0, 1).permute(0, 3, 1, 2).float() / 127.5 - 1
        cells = self.cells(flat).flatten(2).transpose(1, 2).reshape(count, -1, self.places.shape[2])
        tokens = torch.cat([cells, self.state(states)[:, None]], dim=1) + self.places
        return self.actions(self.decoder(self.queries.expand(count, -1, -1), self.encoder(tokens)))
