"""The loss of a compressed picture, in just-objectionable differences (JOD) of ColorVideoVDP.

R. Mantiuk et al., "ColorVideoVDP", 2024, https://github.com/gfxdisp/ColorVideoVDP. Equal pictures score 10 JOD, so the
loss is 10 − JOD (paper, section III-D). The meaning of a score depends on the display model: it is part of the result.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from vcage.base.commands import vcage_command
from vcage.base.errors import MissingDependency, UnknownName, UsageError
from vcage.video.colorvideovdp import Display, StillMetric

DISPLAY = "standard_fhd"

SRGB = "sRGB"
"""The colour space of recordings, and of display models that name none."""

FORM = {
    "masking_model": "mult-mutual",
    "contrast": "weber_g1",
    "csf": "weber_fixed_size",
    "xchannel_masking": "on",
    "dclamp_type": "soft",
}
"""The form that :mod:`vcage.video.colorvideovdp` computes, of those that the parameters of the package can name."""

SET_UP = vcage_command("setup", "cvvdp")


class JodMetric:
    """ColorVideoVDP for a display.

    Args:
        display: name of a display model of ColorVideoVDP.

    Raises:
        MissingDependency: cvvdp is not installed, or in another form than :data:`FORM`.
        UnknownName: there is no such display.
        UsageError: the display does not show sRGB.
    """

    DIGITS: ClassVar[int] = 5
    """Decimals of a loss; finer ones differ from machine to machine."""

    def __init__(self, display: str = DISPLAY):
        model = require_display(display)
        parameters = _read("cvvdp_parameters.json")
        for name, known in FORM.items():
            if (given := parameters.get(name)) != known:
                raise MissingDependency(
                    f"this ColorVideoVDP cannot be computed here: its {name} is {given!r}, not {known!r}",
                    command=SET_UP,
                )
        self.display = display
        sensitivity = _read(f"csf_lut_{parameters['csf']}.json")
        self._metric = StillMetric(Display.of(model, _read("color_spaces.json")[SRGB]), parameters, sensitivity)

    def loss(self, test: NDArray[np.uint8], reference: NDArray[np.uint8]) -> NDArray[np.float64]:
        """Return the loss of each of N pictures against its reference, both (N, H, W, 3) uint8 RGB.

        Returns:
            (N,) JOD, 0 for equal pictures.
        """
        if test.shape != reference.shape:
            raise ValueError(f"test is {test.shape}, reference {reference.shape}")
        return np.round([self._metric.loss(*pair) for pair in zip(test, reference, strict=True)], self.DIGITS)


def metric_version() -> str:
    """Return name and version of the metric: other versions give other losses, so results name it."""
    return f"ColorVideoVDP {metadata.version('cvvdp')}"


def require_display(name: str) -> Mapping[str, Any]:
    """Return ColorVideoVDP's display model of that name.

    Raises:
        MissingDependency: cvvdp is not installed.
        UnknownName: there is none; lists those that are.
        UsageError: it takes another colour space than sRGB.
    """
    displays = _read("display_models.json")
    if name not in displays:
        raise UnknownName("display", name, sorted(displays))
    if (space := displays[name].get("colorspace", SRGB)) != SRGB:
        raise UsageError(f"the display {name!r} takes {space}, and the pictures are {SRGB}", hint=f"take {DISPLAY}")
    return displays[name]


def _read(name: str) -> dict[str, Any]:
    """Return one of the package's files; where ``CVVDP_PATH`` has one of that name, this one.

    Raises:
        MissingDependency: cvvdp is not installed, or lacks the file.
    """
    package = find_spec("pycvvdp")  # which is not imported, for it takes PyTorch
    if package is None or package.origin is None:
        raise MissingDependency("ColorVideoVDP is not installed", command=SET_UP)
    own = Path(package.origin).parent / "vvdp_data"
    for folder in (Path(os.environ.get("CVVDP_PATH", own)), own):
        if (folder / name).is_file():
            return json.loads((folder / name).read_text())
    raise MissingDependency(f"ColorVideoVDP has no {name}", command=SET_UP)
