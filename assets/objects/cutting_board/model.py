"""A thick cutting board on four feet, 0.19 × 0.15 m, with a grip to the right."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"beech": materials.BEECH, "walnut": materials.WALNUT, "bamboo": ((196, 160, 96), (226, 198, 138))}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("cutting_board", variant)
    colours = COLOURS[variant]
    size, foot, top = np.array([0.19, 0.15]), 0.006, 0.025
    blade = solids.prism(solids.rounded_rectangle(size, 0.016, 6), top - foot, foot)
    groove = solids.cut(
        solids.prism(solids.rounded_rectangle(size - 0.018, 0.012, 6), 0.01, top - 0.0025),
        solids.prism(solids.rounded_rectangle(size - 0.03, 0.008, 6), 0.02, top - 0.005),
    )
    outline = _grip_outline(size[0] / 2)
    grip = solids.prism(outline, top - foot - 0.002, foot)
    hole = solids.prism(solids.circle(0.0065, 24, (size[0] / 2 + 0.062, 0)), 0.1)
    board = solids.cut(solids.union(blade, grip), groove, hole)
    rubber = materials.plastic(rng, (52, 50, 50))
    parts = [paint(board, materials.wood(rng, colours, boards=6), tiled(0.17), roughness=0.65)]
    root, rest = outline[[0, 1, -2, -1]], outline[1:-1]
    hulls = [blade, *(pieces.hull(_upright(outline_, foot, top - 0.002)) for outline_ in (root, rest))]
    for x, y in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
        knob = solids.revolved([(0, 0), (0.0075, 0), (0.0085, 0.0015), (0.0085, foot + 0.0005), (0, foot + 0.0005)], 16)
        knob = solids.moved(knob, (x * (size[0] / 2 - 0.02), y * (size[1] / 2 - 0.02), 0))
        parts.append(paint(knob, rubber, tiled(0.05), roughness=0.9))
        hulls.append(knob.convex_hull)
    return BuiltObject(parts, hulls, mass=0.34, friction=0.7)


def _grip_outline(start: float) -> np.ndarray:
    """(n, 2) counter-clockwise: a grip to the right from ``start``, with fillets towards the board."""
    end = solids.arc((start + 0.062, 0), 0.0185, -85, 85, 12)
    return np.concatenate(
        [[(start - 0.004, -0.024), (start + 0.012, -0.0175)], end, [(start + 0.012, 0.0175), (start - 0.004, 0.024)]]
    )


def _upright(outline: np.ndarray, low: float, high: float) -> np.ndarray:
    """Corners (2n, 3) of a prism over an outline."""
    return np.concatenate([np.column_stack([outline, np.full(len(outline), z)]) for z in (low, high)])
