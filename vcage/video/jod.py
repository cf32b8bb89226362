"""The loss of a compressed picture, in just-objectionable differences (JOD) of ColorVideoVDP.

R. Mantiuk et al., "ColorVideoVDP", 2024, https://github.com/gfxdisp/ColorVideoVDP. Equal pictures score 10 JOD, so the
loss is 10 − JOD (paper, section III-D). The meaning of a score depends on the display model: it is part of the result.
"""

from __future__ import annotations

import json
import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from vcage.base.commands import vcage_command
from vcage.base.errors import MissingDependency, UnknownName, UsageError

DISPLAY = "standard_fhd"
PERFECT = 10.0
BATCH = {"cpu": 2, "cuda": 16}
"""Pairs at a time; on a CPU more of them cost time, for their buffers leave the cache."""

DISPLAYS = "display_models.json"
"""File of ColorVideoVDP, which looks for it in ``CVVDP_PATH``, and then among its own files."""

SRGB = "sRGB"
"""The colour space of recordings, and of display models that name none."""

SET_UP = vcage_command("setup", "cvvdp")

_LOCK = threading.Lock()


class JodMetric:
    """ColorVideoVDP for a display; one instance per thread.

    Args:
        display: name of a display model of ColorVideoVDP.
        device: 'cpu' or 'cuda'; None takes a GPU where there is one.

    Raises:
        MissingDependency: pycvvdp or torch is not installed.
        UnknownName: there is no such display.
        UsageError: the display does not show sRGB.
    """

    DIGITS: ClassVar[int] = 5
    """Decimals of a loss; finer ones differ from machine to machine."""

    def __init__(self, display: str = DISPLAY, device: str | None = None):
        require_display(display)
        self._parts = _colorvideovdp()
        import torch

        self._torch = torch
        self.device = torch.device(device or ("cuda" if torch.cuda.is_available() else "cpu"))
        self.display = display
        self._metric = self._parts.cvvdp(display_name=display, device=self.device, quiet=True)

    def loss(self, test: NDArray[np.uint8], reference: NDArray[np.uint8]) -> NDArray[np.float64]:
        """Return the loss of each of N pictures against its reference, both (N, H, W, 3) uint8 RGB.

        Returns:
            (N,) JOD, 0 for equal pictures.
        """
        if test.shape != reference.shape:
            raise ValueError(f"test is {test.shape}, reference {reference.shape}")
        batch = BATCH[self.device.type]
        losses: list[NDArray[np.float64]] = []
        with _quick(self._torch), self._torch.no_grad():
            for start in range(0, len(test), batch):
                one = slice(start, start + batch)
                pairs = self._parts.Pairs(test[one], reference[one], self._metric.display_photometry)
                jod, _ = self._metric.predict_video_source(pairs)
                losses.append(PERFECT - np.atleast_1d(jod.cpu().numpy()).astype(np.float64))
        return np.round(np.concatenate(losses), self.DIGITS)


def metric_version() -> str:
    """Return name and version of the metric: other versions give other losses, so results name it."""
    return f"ColorVideoVDP {metadata.version('cvvdp')}"


def _colorvideovdp() -> ModuleType:
    with _LOCK:
        try:
            from vcage.video import colorvideovdp
        except ImportError as error:
            raise MissingDependency(f"ColorVideoVDP cannot be imported: {error}", command=SET_UP) from error
    return colorvideovdp


def require_display(name: str) -> None:
    """Require that ColorVideoVDP has a display model of that name, without loading it, which takes a second.

    Raises:
        MissingDependency: pycvvdp is not installed.
        UnknownName: it has not; lists those it has.
        UsageError: it takes another colour space than sRGB.
    """
    package = find_spec("pycvvdp")
    if package is None or package.origin is None:
        raise MissingDependency("ColorVideoVDP is not installed", command=SET_UP)
    own = Path(package.origin).parent / "vvdp_data"
    folders = [Path(os.environ.get("CVVDP_PATH", own)), own]
    found = next((folder / DISPLAYS for folder in folders if (folder / DISPLAYS).is_file()), None)
    if found is None:
        raise MissingDependency(f"ColorVideoVDP has no {DISPLAYS}", command=SET_UP)
    displays = json.loads(found.read_text())
    if name not in displays:
        raise UnknownName("display", name, sorted(displays))
    if (space := displays[name].get("colorspace", SRGB)) != SRGB:
        raise UsageError(f"the display {name!r} takes {space}, and the pictures are {SRGB}", hint=f"take {DISPLAY}")


@contextmanager
def _quick(torch: Any) -> Iterator[None]:
    """Use one thread of torch: the order of its sums, and so the last digits, depend on their number.

    Also disable oneDNN, whose convolution of one channel with a few numbers takes longer than all the rest: measured,
    36 in place of 66 ms a picture of 320x240 on one core, the same losses to the fifth decimal.
    """
    threads, (onednn, *_) = torch.get_num_threads(), torch.backends.mkldnn.set_flags(False)
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(threads)
        torch.backends.mkldnn.set_flags(onednn)
