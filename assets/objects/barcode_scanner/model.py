"""A cordless pistol scanner that lies on its side: the window looks left, the handle points to the front."""

from __future__ import annotations

import numpy as np

from assets.textures.labels import INK
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_above, from_front, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "black": ((46, 48, 52), (70, 72, 78), (200, 50, 44)),
    "yellow": ((60, 62, 66), (246, 196, 40), (246, 196, 40)),
    "white": ((228, 228, 224), (96, 104, 112), (60, 120, 190)),
}
"""Variant → colour, guard, trigger."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("barcode_scanner", variant)
    colour, guard, trigger = VARIANTS[variant]
    head_outline = [(-0.052, 0.018), (0.03, 0.022), (0.052, 0.028), (0.058, 0.042), (0.05, 0.056), (-0.052, 0.064)]
    head = _pillow(head_outline, 0.042, 0.006)
    bumper = _pillow([(-0.066, 0.013), (-0.046, 0.015), (-0.046, 0.066), (-0.066, 0.069)], 0.044, 0.005)
    handle = _pillow([(0.016, 0.03), (0.032, -0.084), (0.066, -0.078), (0.051, 0.032)], 0.036, 0.007)
    lever = _pillow([(0.004, 0.022), (0.013, -0.012), (0.022, -0.01), (0.02, 0.022)], 0.016, 0.002, z=0.012)
    window = solids.box((0.0012, 0.042, 0.026), (-0.0663, 0.041, 0.009))
    glass = prints.canvas(64, 64, (70, 8, 12))
    glass = prints.rectangle(glass, (0, 0.46), (1, 0.56), (255, 60, 50))
    label = prints.canvas(512, 214, colour)
    label = prints.text(label, "SCANZO", (0.54, 0.53), 0.24, (236, 236, 232) if variant != "white" else (50, 60, 70))
    label = prints.rectangle(label, (0.12, 0.3), (0.24, 0.82), (250, 250, 248))
    label = _bars(label, (0.135, 0.36), (0.225, 0.76))
    label = prints.disc(label, (0.87, 0.53), 0.09, (80, 220, 110))
    grip = materials.felt(rng, tuple(int(0.8 * c) for c in colour), 128)
    parts = [
        paint(head, label, from_above(), roughness=0.5),
        paint(bumper, materials.plastic(rng, guard), tiled(0.05), roughness=0.6),
        paint(handle, grip, tiled(0.05), roughness=0.8),
        paint(lever, materials.plastic(rng, trigger), tiled(0.05), roughness=0.5),
        paint(window, glass, from_front(), roughness=0.1),
    ]
    return BuiltObject(parts, [head, bumper, handle, lever], mass=0.19, friction=0.7)


def _pillow(outline: list[tuple[float, float]], height: float, bevel: float, z: float = 0.0) -> solids.Solid:
    """A convex outline raised by ``height`` from ``z``, narrower by ``bevel`` at its top and bottom."""
    points = np.asarray(outline, dtype=np.float64)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    inner = middle + (points - middle) * (1 - 2 * bevel / np.ptp(points, axis=0))
    mid = middle + (points - middle) * (1 - 0.6 * bevel / np.ptp(points, axis=0))
    levels = [(0, inner), (0.3 * bevel, mid), (bevel, points), (height - bevel, points)]
    levels += [(height - 0.3 * bevel, mid), (height, inner)]
    return pieces.hull(*[np.column_stack([ring, np.full(len(ring), z + level)]) for level, ring in levels])


def _bars(picture: np.ndarray, lower: tuple[float, float], upper: tuple[float, float]) -> np.ndarray:
    """The picture with the sign for a bar code, upright stripes, between two corners."""
    ends = np.cumsum([0, 3, 2, 1, 2, 1, 1, 3, 2, 1, 1, 2, 2]) / 21
    for start, end in zip(ends[:-1:2], ends[1::2], strict=True):
        x0, x1 = (lower[0] + share * (upper[0] - lower[0]) for share in (start, end))
        picture = prints.rectangle(picture, (x0, lower[1]), (x1, upper[1]), INK)
    return picture
