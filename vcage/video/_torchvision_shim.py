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
        weights = self.weights.to(image)
        pad = len(weights) // 2
        planes = functional.pad(image.reshape(-1, 1, *image.shape[-2:]), (pad, pad, pad, pad), mode="reflect")
        planes = functional.conv2d(planes, weights.view(1, 1, 1, -1))
        return functional.conv2d(planes, weights.view(1, 1, -1, 1)).reshape(image.shape)


class MLP(nn.Module):
    """Only named by pycvvdp's learned variants, which this project does not use."""

    def __init__(self, *_args: object, **_kwargs: object):
        super().__init__()
        raise NotImplementedError("the learned variants of ColorVideoVDP need torchvision")


def _usable() -> bool:
    """Whether torchvision is there and fits torch: a wheel for another torch fails at import with RuntimeError."""
    try:
        import_module("torchvision.ops")
        import_module("torchvision.transforms")
    except (ImportError, RuntimeError, AttributeError):
        return False
    return True


@contextmanager
def torchvision_names() -> Iterator[None]:
    """Let ``import pycvvdp`` find ``GaussianBlur`` and ``MLP``; afterwards no false torchvision is left behind."""
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
