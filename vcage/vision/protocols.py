"""What detectors, embedders and the critic see: pictures with their cameras, regions of them, and how an asset looks.

Pictures are (H, W, 3) uint8 RGB. Every implementation has a ``provider`` name, which is written into each file that
its answers touched.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from vcage.base.geometry import Camera


@dataclass(frozen=True)
class Detection:
    """One region of a picture that may be an object.

    Args:
        box: (4,) u0, v0, u1, v1 in pixels, half open.
        mask: (H, W) bool, or None when the detector gives boxes only.
        score: in [0, 1].
        label: the name the detector gave it, if any.
    """

    box: tuple[float, float, float, float]
    mask: np.ndarray | None
    score: float
    label: str | None = None


@dataclass(frozen=True)
class View:
    """A picture and the camera that took it."""

    picture: np.ndarray
    camera: Camera


@dataclass(frozen=True)
class Reference:
    """What an object looks like: the library's own render of the asset, alone, from straight above.

    Args:
        phrase: what to call it.
        picture: (h, w, 4) uint8 RGBA; alpha 0 where the object is not. Object x to the right, y up.
        metres_per_pixel: scale of the picture at the object's base.
        size: (3,) bounding box, metres.
    """

    phrase: str
    picture: np.ndarray
    metres_per_pixel: float
    size: tuple[float, float, float]


class Detector(Protocol):
    """Finds objects in a picture."""

    provider: str

    def detect(
        self, picture: np.ndarray, names: Sequence[str], background: np.ndarray | None = None
    ) -> list[Detection]:
        """Regions that may be objects, best first; ``names`` is the text prompt, ``background`` the empty table."""
        ...


class Embedder(Protocol):
    """Turns regions of a picture into feature vectors whose cosine says how alike they look."""

    provider: str

    def embed(self, picture: np.ndarray, regions: Sequence[Detection]) -> np.ndarray:
        """(len(regions), d) float64, rows of unit length."""
        ...
