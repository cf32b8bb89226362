"""ColorVideoVDP as this project uses it; its import takes a second, most of it for torch."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from types import ModuleType

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn import functional

from vcage.base.imports import left_out


class GaussianBlur(nn.Module):
    """Gaussian blur with reflecting borders, as ``torchvision.transforms.GaussianBlur`` for one sigma.

    Args:
        kernel_size: taps, odd.
        sigma: standard deviation, pixels.
    """

    def __init__(self, kernel_size: int, sigma: float):
        super().__init__()
        half = (kernel_size - 1) / 2
        weights = torch.exp(-0.5 * (torch.linspace(-half, half, kernel_size) / sigma) ** 2)
        self.weights = weights / weights.sum()

    def forward(self, image: Tensor) -> Tensor:
        """Blur (…, H, W)."""
        for axis in (-1, -2):
            image = self._along(image, axis)
        return image

    def _along(self, image: Tensor, axis: int) -> Tensor:
        """Blur along one axis: shifted copies added up, which takes a fifth of a convolution's time on a CPU."""
        pad, length = len(self.weights) // 2, image.shape[axis]
        padding = (pad, pad, 0, 0) if axis == -1 else (0, 0, pad, pad)
        padded = functional.pad(image.reshape(-1, 1, *image.shape[-2:]), padding, mode="reflect")
        blurred = torch.zeros_like(image)
        for shift, weight in enumerate(self.weights.tolist()):
            blurred.add_(padded.narrow(axis, shift, length).reshape(image.shape), alpha=weight)
        return blurred


class MLP(nn.Module):
    """Only named by pycvvdp's learned variants, which this project does not use."""

    def __init__(self, *_args: object, **_kwargs: object):
        super().__init__()
        raise NotImplementedError("the learned variants of ColorVideoVDP need torchvision")


def _usable() -> bool:
    """True if torchvision is there and fits torch: a wheel for another torch fails at import with RuntimeError."""
    try:
        import_module("torchvision.ops")
        import_module("torchvision.transforms")
    except (ImportError, RuntimeError, AttributeError):
        return False
    return True


@contextmanager
def torchvision_names() -> Iterator[None]:
    """Let ``import pycvvdp`` find ``GaussianBlur`` and ``MLP`` inside, without a false torchvision afterwards."""
    if _usable():
        yield
        return
    names = {
        "torchvision": {},
        "torchvision.transforms": {"GaussianBlur": GaussianBlur},
        "torchvision.ops": {"MLP": MLP},
    }
    before = {name: sys.modules.get(name) for name in names}
    for name, members in names.items():
        module = ModuleType(name)
        vars(module).update(members)
        sys.modules[name] = module
    try:
        yield
    finally:
        for name, module in before.items():
            if module is None:
                del sys.modules[name]
            else:
                sys.modules[name] = module


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
        return self._displayed(self._test, device, colorspace)

    def get_reference_frame(self, _frame: int, device: torch.device, colorspace: str) -> Tensor:
        """(N, 3, 1, H, W) in a linear colour space."""
        return self._displayed(self._reference, device, colorspace)

    def _displayed(self, pictures: NDArray[np.uint8], device: torch.device, colorspace: str) -> Tensor:
        count, height, width, channels = pictures.shape
        light = cv2.LUT(pictures.reshape(count * height, width, channels), self._shown).reshape(pictures.shape)
        axes = torch.eye(channels, device=device).view(channels, channels, 1, 1, 1)
        matrix = self._photometry.linear_2_target_colorspace(axes, colorspace).view(channels, channels)
        return (torch.from_numpy(light).to(device) @ matrix).permute(0, 3, 1, 2).unsqueeze(2)
