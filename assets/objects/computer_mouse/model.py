"""A wireless mouse with its buttons to the back, as a user in front of the table holds it."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "black": ((48, 49, 53), (30, 30, 33)),
    "white": ((236, 236, 232), (196, 198, 200)),
    "blue": ((52, 96, 172), (34, 44, 66)),
}
"""Variant → colour, grip."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("computer_mouse", variant)
    colour, grip = VARIANTS[variant]
    shell = solids.closed_rings(_mouse_rings())
    seam = tuple(int(c * 0.45) for c in colour)
    picture = prints.canvas(320, 560, colour)
    picture = prints.rectangle(picture, (0, 0), (0.13, 1), grip)
    picture = prints.rectangle(picture, (0.87, 0), (1, 1), grip)
    picture = prints.rectangle(picture, (0.492, 0), (0.508, 0.44), seam)
    picture = prints.rectangle(picture, (0.13, 0.43), (0.87, 0.44), seam)
    picture = prints.rectangle(picture, (0.43, 0.09), (0.57, 0.31), seam)
    picture = prints.text(picture, "orbi", (0.5, 0.78), 0.06, grip if variant != "black" else (120, 122, 128))
    wheel = solids.revolved([(0, -0.0035), (0.0105, -0.0035), (0.0115, 0), (0.0105, 0.0035), (0, 0.0035)], 28)
    wheel = solids.moved(wheel, (0, 0.034, 0.0235), turn=90, axis=(0, 1, 0))
    parts = [
        paint(shell, picture, from_above(), roughness=0.45, crease=50),
        paint(wheel, materials.plastic(rng, (70, 72, 78)), tiled(0.01), roughness=0.9),
    ]
    hulls = [pieces.coarse(shell.vertices, 120), pieces.coarse(wheel.vertices, 30)]
    return BuiltObject(parts, hulls, mass=0.1, friction=0.8)


def _mouse_rings(stations: int = 17, points: int = 20) -> np.ndarray:
    """(stations, points, 3) outlines across the mouse: upright sides, a flat bottom, the back of the hand's arch."""
    along = np.sin(np.linspace(-1, 1, stations) * np.pi / 2) * 0.985
    angle = np.linspace(0, np.pi, points - 2)
    side, top = (np.sign(f) * np.abs(f) ** 0.62 for f in (np.cos(angle), np.sin(angle)))
    rings = []
    for t in along:
        half = 0.031 * (1 - 0.06 * t) * (1 - abs(t) ** 3.2) ** 0.42
        height = 0.0385 * (1 - 0.34 * (t + 0.25) ** 2) * (1 - abs(t) ** 4) ** 0.5
        x = np.concatenate([[-half * 0.94], [half * 0.94], half * side])
        z = np.concatenate([[0, 0], 0.004 + (height - 0.004) * top])
        rings.append(np.column_stack([x, np.full(points, 0.0565 * t), z]))
    return np.array(rings)
