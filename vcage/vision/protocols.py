"""Inputs of detectors, embedders and the critic: pictures with cameras, regions of pictures, looks of assets.

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

    @classmethod
    def of_mask(cls, mask: np.ndarray, score: float = 1.0) -> Detection:
        """The region that a mask (H, W), not empty, covers."""
        (rows,), (columns,) = np.nonzero(mask.any(axis=1)), np.nonzero(mask.any(axis=0))
        box = (float(columns[0]), float(rows[0]), float(columns[-1] + 1), float(rows[-1] + 1))
        return cls(box, mask, score)

    @property
    def centre(self) -> tuple[float, float]:
        """(u, v) of the middle of the box, pixels."""
        u0, v0, u1, v1 = self.box
        return (u0 + u1) / 2, (v0 + v1) / 2

    def pixels(self, shape: tuple[int, ...]) -> np.ndarray:
        """(H, W) bool: the mask, or the part of the box inside a picture of that shape where there is no mask.

        Empty when neither lies in the picture.
        """
        if self.mask is not None and self.mask.shape == tuple(shape[:2]) and self.mask.any():
            return self.mask
        mask = np.zeros(shape[:2], bool)
        if np.isfinite(self.box).all():
            u0, v0, u1, v1 = np.clip(self.box, 0, [shape[1], shape[0]] * 2)
            mask[int(v0) : int(np.ceil(v1)), int(u0) : int(np.ceil(u1))] = True
        return mask


@dataclass(frozen=True)
class View:
    """A picture and the camera that took it."""

    picture: np.ndarray
    camera: Camera


@dataclass(frozen=True)
class Reference:
    """The look of an object: the library's own render of the asset, alone, from straight above.

    Args:
        phrase: its name in sentences.
        picture: (h, w, 4) uint8 RGBA; alpha 0 beside the object. Object x to the right, y up.
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
        """Regions that may be objects, the best first; ``names`` is the text prompt, ``background`` the empty table."""
        ...


class Embedder(Protocol):
    """Turns regions of a picture into feature vectors; their cosine is the similarity of two looks."""

    provider: str

    def embed(self, picture: np.ndarray, regions: Sequence[Detection]) -> np.ndarray:
        """(len(regions), d) float64, rows of unit length."""
        ...
