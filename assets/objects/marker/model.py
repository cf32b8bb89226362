"""A fat whiteboard marker that lies along x, cap to the right with the clip on top."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

INKS = {"black": (34, 34, 38), "red": (196, 32, 38), "blue": (28, 74, 176), "green": (24, 130, 66)}


def build(variant: str) -> BuiltObject:
    ink, rng = INKS[variant], variant_rng("marker", variant)
    radius, length = 0.009, 0.13
    plastic = materials.plastic(rng, ink)

    def lying(profile: list[tuple[float, float]]) -> solids.Solid:
        return solids.moved(solids.revolved(profile, 24), (0, 0, radius), turn=90, axis=(0, 1, 0))

    half = length / 2
    barrel = lying([(0, -half + 0.006), (0.0084, -half + 0.006), (0.0084, 0.018), (0, 0.018)])
    plug = lying([(0, -half), (0.006, -half), (0.0082, -half + 0.002), (0.0082, -half + 0.008), (0, -half + 0.008)])
    cap = lying([(0, 0.016), (radius, 0.016), (radius, half - 0.006), (0.0065, half), (0, half)])
    clip = solids.rounded_box((0.034, 0.005, 0.0028), 0.0012, (half - 0.024, 0, 2 * radius - 0.0006))
    parts = [
        paint(barrel, _marker_label(ink), around(0, (0, radius)), roughness=0.4),
        paint(plug, plastic, tiled(0.05), roughness=0.35),
        paint(solids.union(cap, clip), plastic, tiled(0.05), roughness=0.35),
    ]
    octagon = pieces.stack([(radius, -half), (radius, half)], sides=8)
    octagon = solids.moved(octagon, (0, 0, radius), turn=90, axis=(0, 1, 0))
    return BuiltObject(parts, [octagon, clip.convex_hull], mass=0.022, friction=0.8)


def _marker_label(ink: tuple[int, int, int]) -> np.ndarray:
    """The print around the barrel: rows run along the barrel's axis, columns around it."""
    label = prints.canvas(256, 384, (244, 244, 242))
    label = prints.rectangle(label, (0, 0), (1, 0.14), ink)
    label = prints.rectangle(label, (0, 0.70), (1, 1), ink)
    label = prints.rectangle(label, (0.3, 0.16), (0.7, 0.68), ink)
    return prints.text(label, "BOARD", (0.5, 0.42), 0.15, (255, 255, 255), turn=90)
