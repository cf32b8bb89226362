"""Bent handles."""

from __future__ import annotations

import numpy as np


def sections_along(path: np.ndarray, section: np.ndarray, up: tuple[float, float, float]) -> list[np.ndarray]:
    """Sections (k, 3) at the points of a path: first coordinate to the side, second along ``up``.

    Args:
        path: (n, 3) metres.
        section: (k, 2) metres.
        up: direction of the second coordinate.
    """
    forward = np.gradient(path, axis=0)
    forward /= np.linalg.norm(forward, axis=1, keepdims=True)
    side = np.cross(forward, up)
    return list(
        path[:, None] + section[None, :, :1] * side[:, None] + section[None, :, 1:] * np.asarray(up, dtype=float)
    )
