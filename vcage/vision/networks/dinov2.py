"""DINOv2 features, as in the paper: the class token of the object alone.

M. Oquab et al., DINOv2: Learning Robust Visual Features without Supervision, TMLR 2024.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from vcage.vision.networks.crops import turned_features
from vcage.vision.networks.loading import Weights, device
from vcage.vision.protocols import Detection

WEIGHTS = "facebook/dinov2-small"
KINDS = ("dinov2", "dinov2_with_registers")

SIDE = 224
"""Largest side of a crop, pixels; the side is a multiple of the network's patches."""


class Dinov2Embedder:
    """Implements :class:`vcage.vision.protocols.Embedder` with the class token of a DINOv2.

    Args:
        weights: a hub id or a folder, see :class:`Weights`.
    """

    def __init__(self, weights: str | None = None):
        self._weights = Weights(weights or WEIGHTS, KINDS)
        self.provider = f"dinov2:{self._weights.name}"

    def embed(self, picture: np.ndarray, regions: Sequence[Detection]) -> np.ndarray:
        """(len(regions), d) float64 unit rows, see :func:`turned_features`."""
        if not regions:
            return np.zeros((0, 0))
        patch = self._network.config.patch_size
        return turned_features(picture, regions, SIDE // patch * patch, self._class_token)

    def _class_token(self, crops: np.ndarray) -> np.ndarray:
        import torch

        with torch.inference_mode():
            answer = self._network(pixel_values=torch.from_numpy(crops).to(device()))
            return answer.last_hidden_state[:, 0].float().cpu().numpy()

    @cached_property
    def _network(self) -> Any:
        return self._weights.read("AutoModel")
