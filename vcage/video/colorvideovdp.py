"""ColorVideoVDP as this project uses it; its import takes a second, most of it for torch."""

from __future__ import annotations

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from vcage.base.imports import left_out
from vcage.video._torchvision_shim import torchvision_names

with torchvision_names(), left_out("matplotlib", "pyplot"):  # which it draws charts with
    from pycvvdp import cvvdp
    from pycvvdp.display_model import vvdp_display_photometry

__all__ = ["Pairs", "cvvdp"]

DEPTH = 256
"""Values of 8 bits."""


class Pairs:
    """Pictures and their references as a display shows them: a ``video_source`` of ColorVideoVDP.

    The light of each of the 256 values on the display is computed once and looked up. The metric's own source computes
    it for every pixel and checks the result, which is a quarter of the time of a loss (measured, at 320x240 on a CPU).
    The losses are the same but for roundings of the fifth decimal.

    Args:
        test, reference: (N, H, W, 3) uint8 RGB.
        photometry: of a display that takes sRGB, and so shows each channel by itself.
    """

    def __init__(self, test: NDArray[np.uint8], reference: NDArray[np.uint8], photometry: vvdp_display_photometry):
        self._test, self._reference, self._photometry = test, reference, photometry
        values = torch.arange(DEPTH, dtype=torch.float32) / (DEPTH - 1)
        self._shown = np.asarray(photometry.forward(values.view(1, 1, 1, 1, DEPTH))).ravel()

    def get_video_size(self) -> tuple[int, int, int]:
        """Height, width, and one frame: the pairs are a batch of pictures."""
        _, height, width, _ = self._test.shape
        return height, width, 1

    def get_frames_per_second(self) -> float:
        """0 for pictures."""
        return 0

    def get_batch_size(self) -> int:
        """Return the number of pairs."""
        return len(self._test)

    def get_test_frame(self, _frame: int, device: torch.device, colorspace: str) -> Tensor:
        """(N, 3, 1, H, W) in a linear colour space."""
        return self._seen(self._test, device, colorspace)

    def get_reference_frame(self, _frame: int, device: torch.device, colorspace: str) -> Tensor:
        """(N, 3, 1, H, W) in a linear colour space."""
        return self._seen(self._reference, device, colorspace)

    def _seen(self, pictures: NDArray[np.uint8], device: torch.device, colorspace: str) -> Tensor:
        count, height, width, channels = pictures.shape
        light = cv2.LUT(pictures.reshape(count * height, width, channels), self._shown).reshape(pictures.shape)
        axes = torch.eye(channels, device=device).view(channels, channels, 1, 1, 1)
        matrix = self._photometry.linear_2_target_colorspace(axes, colorspace).view(channels, channels)
        return (torch.from_numpy(light).to(device) @ matrix).permute(0, 3, 1, 2).unsqueeze(2)
