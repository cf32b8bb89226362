"""Nesting: a round container stands in another, on its floor or by its own side on the other's rim.

The box around a bowl is wider than the opening of a bowl of its kind, so boxes cannot show that it fits. The shapes
can: one is lowered into the middle of the other until they touch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.objects.convex import Convex
from vcage.objects.openings import Opening


@dataclass(frozen=True)
class NestingSettings:
    """Settings of the measurement.

    Args:
        cell_m: edge of a grid cell.
        touch_m: parts of the two that are nearer than this touch.
        least_depth_m: depth of the inner one's bottom below the rim; less could slide off.
        widest_gap_rad: largest angle around the middle without a touch; with more it would tip.
    """

    cell_m: float = 0.002
    touch_m: float = 0.0015
    least_depth_m: float = 0.01
    widest_gap_rad: float = np.radians(100)


SETTINGS = NestingSettings()


def nested_height(content: Sequence[Convex], holder: Sequence[Convex], opening: Opening) -> float | None:
    """Bottom of a round object that nests in an opening, in the frame of the opening, metres; None where it does not.

    Args:
        content: the inner one's shape, standing upright over the origin.
        holder: the shape that has the opening.
        opening: of the outer one.
    """
    cells = _cells(content)
    below, _ = _heights(content, cells)
    _, top = _heights(holder, cells + opening.centre)
    apart = top - below
    met = np.isfinite(apart)
    if not met.any():
        return None
    height = float(apart[met].max())
    touching = cells[met & (apart > height - SETTINGS.touch_m)]
    deep = height <= opening.rim - SETTINGS.least_depth_m
    return height if deep and _all_around(touching) else None


def _cells(content: Sequence[Convex]) -> np.ndarray:
    """(n, 2) middles of the grid cells around an object's own middle, metres."""
    half = max(float(np.abs(piece.vertices[:, :2]).max()) for piece in content)
    line = np.arange(-half, half + SETTINGS.cell_m, SETTINGS.cell_m)
    x, y = np.meshgrid(line, line)
    return np.stack([x.ravel(), y.ravel()], axis=1)


def _heights(pieces: Sequence[Convex], cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n,) lowest and highest z of material over each cell; infinite and minus infinite where there is none."""
    lowest, highest = np.full(len(cells), np.inf), np.full(len(cells), -np.inf)
    for piece in pieces:
        slope = piece.normals[:, 2]
        room = piece.offsets - cells @ piece.normals[:, :2].T  # (n, m)
        up, down = slope > 1e-9, slope < -1e-9
        high = (room[:, up] / slope[up]).min(axis=1)
        low = (room[:, down] / slope[down]).max(axis=1)
        there = (low < high) & (room[:, ~up & ~down] >= 0).all(axis=1)
        lowest[there] = np.minimum(lowest, low)[there]
        highest[there] = np.maximum(highest, high)[there]
    return lowest, highest


def _all_around(touching: np.ndarray) -> bool:
    """True where the touching cells (n, 2) leave no wide gap around the middle."""
    angles = np.sort(np.arctan2(touching[:, 1], touching[:, 0]))
    gaps = np.diff(np.concatenate([angles, angles[:1] + 2 * np.pi]))
    return bool(gaps.max() < SETTINGS.widest_gap_rad)
