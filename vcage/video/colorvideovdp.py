"""ColorVideoVDP as this project uses it; its import takes a second, most of it for torch."""

from __future__ import annotations

from vcage.base.imports import left_out
from vcage.video._torchvision_shim import torchvision_names

with torchvision_names(), left_out("matplotlib", "pyplot"):  # which it draws charts with
    from pycvvdp import cvvdp

__all__ = ["cvvdp"]
