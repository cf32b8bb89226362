"""``python -m tests.video.package_losses FOLDER DISPLAY ...``: losses that the package cvvdp itself computes, as JSON.

FOLDER has a .npz for each pair: worse pictures, and pictures.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from unittest.mock import patch

import numpy as np
import torch


@contextmanager
def torchvision_names() -> Iterator[None]:
    """Let ``import pycvvdp`` find inside what it takes from torchvision, where that is missing."""
    names = {"torchvision.transforms": {"GaussianBlur": Blur}, "torchvision.ops": {"MLP": None}}
    made = {}
    for name, members in names.items():
        made[name] = ModuleType(name)
        vars(made[name]).update(members)
    with patch.dict(sys.modules, {"torchvision": ModuleType("torchvision"), **made}):
        yield


class Blur:
    """``torchvision.transforms.GaussianBlur`` for one sigma."""

    def __init__(self, kernel_size: int, sigma: float):
        places = torch.linspace(-(kernel_size - 1) / 2, (kernel_size - 1) / 2, kernel_size)
        weights = torch.exp(-0.5 * (places / sigma) ** 2)
        self.weights = weights / weights.sum()

    def forward(self, image: torch.Tensor) -> torch.Tensor:
        """Blur (N, 1, H, W)."""
        half = len(self.weights) // 2
        padded = torch.nn.functional.pad(image, (half,) * 4, mode="reflect")
        rows = torch.nn.functional.conv2d(padded, self.weights.view(1, 1, 1, -1))
        return torch.nn.functional.conv2d(rows, self.weights.view(1, 1, -1, 1))


def main(folder: Path, displays: list[str]) -> None:
    """Print display → pair → losses, JOD."""
    with torchvision_names():
        from pycvvdp import cvvdp
    found: dict[str, dict[str, list[float]]] = {}
    for display in displays:
        metric = cvvdp(display_name=display, device=torch.device("cpu"), quiet=True)
        found[display] = {}
        for path in sorted(folder.glob("*.npz")):
            test, reference = np.load(path).values()
            jod, _ = metric.predict(test, reference, "BHWC")
            found[display][path.stem] = (10 - jod).tolist()
    print(json.dumps(found))


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
