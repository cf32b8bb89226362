"""A small desk fan, 0.14 m tall: a wire cage around four blades, on a stem and a round foot."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"white": (238, 237, 233), "black": (44, 45, 49), "mint": (132, 200, 184)}

AXIS, RADIUS, DEPTH = 0.092, 0.048, 0.034
"""Height of the blades' axis; radius and depth of the cage, metres."""

FOOT = ((0.042, 0.0), (0.042, 0.008), (0.036, 0.014))
"""Radius and height of the foot, from below, metres."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("fan", variant)
    colour = COLOURS[variant]
    coat = materials.plastic(rng, colour, 128)
    foot = solids.revolved([(0, 0), *FOOT, (0, 0.014)], 40)
    stem = solids.revolved([(0, 0.012), (0.009, 0.012), (0.007, AXIS - RADIUS + 0.006), (0, AXIS - RADIUS + 0.006)], 20)
    grey = materials.plastic(rng, (176, 180, 186) if sum(colour) > 200 else (110, 112, 118), 128)
    parts = [
        paint(solids.union(foot, stem), coat, tiled(0.06), roughness=0.35, crease=40),
        paint(solids.union(*_cage()), coat, tiled(0.06), roughness=0.35),
        paint(solids.union(*_blades()), grey, tiled(0.06), roughness=0.3),
    ]
    profile = [(RADIUS - 0.006, -DEPTH / 2), (RADIUS, -DEPTH / 4), (RADIUS, DEPTH / 4), (RADIUS - 0.006, DEPTH / 2)]
    cage = _to_front(pieces.stack(profile, 28))
    post = pieces.stack([(0.009, 0.012), (0.007, AXIS - RADIUS + 0.006)], 12)
    return BuiltObject(parts, [pieces.stack(list(FOOT), 24), post, cage], mass=0.3, friction=0.8)


def _to_front(solid: solids.Solid) -> solids.Solid:
    """Turn a part that is built around the vertical axis so that its top faces the front, at the height of the axis."""
    return solids.moved(solid, (0, 0, AXIS), turn=90, axis=(1, 0, 0))


def _torus(radius: float, along: float, wire: float) -> solids.Solid:
    """A ring of wire around the axis, ``along`` it."""
    return _to_front(solids.revolved(solids.circle(wire, 5, (radius, along)), 24))


def _cage() -> list[solids.Solid]:
    """Rings and spokes in front and behind, a broad hoop around, and the motor's housing."""
    rim = [(RADIUS - 0.0025, -0.006), (RADIUS, -0.006), (RADIUS, 0.006), (RADIUS - 0.0025, 0.006)]
    found = [_to_front(solids.revolved(rim, 36))]
    for sign in (-1, 1):
        for radius, along in ((0.016, DEPTH / 2 - 0.0015), (0.03, DEPTH / 2 - 0.002), (0.042, DEPTH / 2 - 0.0055)):
            found.append(_torus(radius, sign * along, 0.0013))
        for angle in np.arange(0, 360, 45):
            ends = [(0.01, DEPTH / 2 - 0.0015), (0.03, DEPTH / 2 - 0.002), (0.042, DEPTH / 2 - 0.0055), (0.0475, 0.004)]
            path = np.array([(r, 0.0, sign * z) for r, z in ends])
            spoke = solids.sweep(path, solids.circle(0.0012, 4), up=(0, 1, 0))
            found.append(_to_front(solids.moved(spoke, turn=float(angle), axis=(0, 0, 1))))
    cap = solids.revolved([(0, 0.011), (0.013, 0.011), (0.013, DEPTH / 2), (0, DEPTH / 2)], 24)
    back = solids.moved(cap, turn=180, axis=(1, 0, 0))
    return [*found, _to_front(cap), _to_front(back)]


def _blades() -> list[solids.Solid]:
    """Four slanted blades around a hub."""
    hub = solids.revolved([(0, -0.006), (0.011, -0.006), (0.011, 0.008), (0, 0.01)], 24)
    blade = solids.moved(solids.box((0.03, 0.022, 0.0016)), (0.025, 0, 0), turn=24, axis=(1, 0, 0))
    turned = (solids.moved(blade, turn=angle, axis=(0, 0, 1)) for angle in (20, 110, 200, 290))
    return [_to_front(solid) for solid in (hub, *turned)]
