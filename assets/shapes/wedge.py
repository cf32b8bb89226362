"""Slices of a round: cake and cheese."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import solids


def wedge(length: float, half_angle: float) -> np.ndarray:
    """Outline (n, 2), counter-clockwise: a slice of a round with its tip on the left at x = -0.05."""
    rim = solids.arc((-0.05, 0), length, -half_angle, half_angle, 12)
    return np.concatenate([[(-0.05, 0.0)], rim])


def bevelled(outline: np.ndarray, low: float, high: float, bevel: float = 0.0015) -> solids.Solid:
    """A prism over an outline with a bevelled upper edge.

    Args:
        outline: (n, 2), counter-clockwise, metres.
        low, high: of bottom and top.
        bevel: of the upper edge.
    """
    middle = outline.mean(axis=0)
    inset = middle + (outline - middle) * (1 - bevel / np.linalg.norm(outline - middle, axis=1).min())
    levels = ((outline, low), (outline, high - bevel), (inset, high))
    return solids.closed_rings([np.column_stack([o, np.full(len(o), z)]) for o, z in levels])
