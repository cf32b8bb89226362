"""Heaps: balls that lie loose in a vessel, each dropped after the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.objects.convex import Convex
from vcage.objects.openings import Opening


@dataclass(frozen=True)
class HeapSettings:
    """How places in a heap are found.

    Args:
        tries: places seen from above that are tried for each ball, of which the lowest is taken.
        step_m: of the heights that are tried.
        gap_m: between two balls, and to the walls.
    """

    tries: int = 40
    step_m: float = 0.001
    gap_m: float = 0.0005


SETTINGS = HeapSettings()


def heap(
    vessel: Sequence[Convex], opening: Opening, radii: Sequence[float], rng: np.random.Generator
) -> list[np.ndarray] | None:
    """(3,) middles of balls in a vessel, in its frame, metres; None where they do not all lie below its rim.

    Args:
        vessel: its shape.
        opening: the room in it.
        radii: of the balls, metres.
        rng: of the places that are tried.
    """
    found: list[np.ndarray] = []
    for number, radius in enumerate(radii):
        places = _lowest(vessel, opening, radius, list(zip(found, radii[:number], strict=True)), rng)
        if not len(places):
            return None
        found.append(places[places[:, 2].argmin()])
    return found


def _lowest(
    vessel: Sequence[Convex],
    opening: Opening,
    radius: float,
    there: Sequence[tuple[np.ndarray, float]],
    rng: np.random.Generator,
) -> np.ndarray:
    """(n, 3) lowest middles to which a ball falls from above at some places, with all of it below the rim."""
    side = np.array(opening.size) / 2
    across = np.array(opening.centre) + rng.uniform(-side, side, (SETTINGS.tries, 2))
    heights = np.arange(opening.rim - radius, opening.floor + radius, -SETTINGS.step_m)
    if not len(heights):
        return np.empty((0, 3))
    points = np.concatenate(
        [
            np.repeat(across[:, None], len(heights), axis=1),
            np.broadcast_to(heights[:, None], (len(across), len(heights), 1)),
        ],
        axis=2,
    )
    room = np.min([piece.outside(points) for piece in vessel], axis=0) - radius
    for middle, other in there:
        room = np.minimum(room, np.linalg.norm(points - middle, axis=2) - radius - other)
    falls = np.logical_and.accumulate(room >= SETTINGS.gap_m, axis=1).sum(axis=1)
    reached = np.flatnonzero(falls)
    return points[reached, falls[reached] - 1]
