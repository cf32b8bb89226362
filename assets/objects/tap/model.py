"""A mixer tap on a heavy round base, spout to the front; the lever on top turns about the vertical axis."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.lofts import across
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.parts import BuiltObject, MovingPart, paint, variant_rng
from vcage.schema.asset import Joint

VARIANTS = {
    "chrome": ((206, 209, 214), 0.5),
    "black": ((44, 45, 48), 0.1),
    "brass": ((198, 160, 86), 0.5),
}
"""Variant → colour, shine."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("tap", variant)
    colour, shine = VARIANTS[variant]
    metal = materials.plastic(rng, colour)  # polished: no brush marks
    foot = [(0, 0.004), (0.052, 0.004), (0.052, 0), (0.058, 0), (0.06, 0.002), (0.06, 0.016), (0.055, 0.02)]
    base = solids.revolved([*foot, (0, 0.02)], 48)
    pillar = [(0, 0.019), (0.028, 0.019), (0.028, 0.024), (0.022, 0.03), (0.021, 0.14), (0, 0.14)]
    bend = solids.arc((-0.052, 0.092), (0.066, 0.034), 5, 165, 15)
    path = np.column_stack([np.zeros(len(bend)), bend[:, 0], bend[:, 1]])
    path = np.concatenate([path, [(0, -0.1185, 0.088)]])
    spout = solids.sweep(path, solids.circle(0.0108, 18), up=(1, 0, 0))
    nozzle = solids.moved(solids.revolved([(0, 0), (0.0135, 0), (0.0135, 0.014), (0, 0.014)], 24), (0, -0.118, 0.078))
    hole = solids.moved(solids.revolved([(0, 0), (0.010, 0), (0.010, 0.001), (0, 0.001)], 24), (0, -0.118, 0.0775))
    stone = materials.speckled(rng, (84, 86, 90), (150, 152, 156), 0.12)
    parts = [
        paint(base, stone, tiled(0.08), roughness=0.5),
        paint(solids.revolved(pillar, 36), materials.polished(colour), around(), roughness=0.2, metallic=shine),
        paint(solids.union(spout, nozzle), metal, tiled(0.05), roughness=0.2, metallic=shine),
        paint(hole, materials.plastic(rng, (30, 30, 32)), tiled(0.05)),
    ]
    hulls = [
        pieces.stack([(0.06, 0), (0.06, 0.017), (0.055, 0.02)]),
        pieces.stack([(0.028, 0.02), (0.028, 0.024), (0.022, 0.03)]),
        pieces.stack([(0.0215, 0.028), (0.021, 0.14)]),
        *pieces.chain([_around(point, 0.0108) for point in path[[1, 4, 6, 8, 10, 12, 14]]]),
        pieces.stack([(0.0135, 0.0775), (0.0135, 0.094)], centre=(0.0, -0.118)),
    ]
    return BuiltObject(parts, hulls, mass=2.4, friction=1.0, moving=[_lever(rng, metal, shine)])


def _around(point: np.ndarray, radius: float) -> np.ndarray:
    """Corners of a small body around a point of the spout's middle line."""
    return pieces.coarse(solids.ellipsoid((radius,) * 3, point, 12).vertices, 40).vertices


def _lever(rng: np.random.Generator, metal: np.ndarray, shine: float) -> MovingPart:
    """A round cap with an upright blade that points to the front."""
    cap = solids.revolved(
        np.concatenate(
            [[(0, 0.1415), (0.0235, 0.1415)], solids.arc((0.0135, 0.152), (0.010, 0.010), 0, 80, 6), [(0, 0.163)]]
        ),
        36,
    )
    profile = np.concatenate(
        [
            [(0.018, 0.156), (0.020, 0.186)],
            solids.arc((0.012, 0.186), 0.008, 0, 90, 5),
            solids.arc((-0.046, 0.188), 0.006, 90, 180, 5),
            solids.arc((-0.046, 0.182), 0.006, 180, 250, 4),
            [(-0.026, 0.166), (-0.02, 0.156)],
        ]
    )
    blade = across(profile, 0.012)
    dots = [
        solids.moved(solids.ellipsoid((0.0008, 0.0032, 0.0032), count=16), (x, -0.036, 0.181)) for x in (-0.006, 0.006)
    ]
    parts = [
        paint(solids.union(cap, blade), metal, tiled(0.05), roughness=0.2, metallic=shine),
        paint(dots[0], materials.plastic(rng, (210, 44, 40)), tiled(0.05)),
        paint(dots[1], materials.plastic(rng, (44, 96, 210)), tiled(0.05)),
    ]
    hulls = [
        pieces.stack([(0.0235, 0.1415), (0.0235, 0.153), (0.019, 0.16), (0.0145, 0.1625)]),
        pieces.hull(blade.vertices),
    ]
    joint = Joint(
        kind="turn",
        origin=(0.0, 0.0, 0.15),
        axis=(0.0, 0.0, 1.0),
        lower=0.0,
        upper=1.2,
        damping=0.5,
        friction=0.15,
    )
    return MovingPart("lever", parts, hulls, mass=0.15, joint=joint)
