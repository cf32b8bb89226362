"""The two names of torchvision that pycvvdp imports, for machines without a torchvision that matches their torch."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from types import ModuleType

import torch
from torch import Tensor, nn
from torch.nn import functional


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
