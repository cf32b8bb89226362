"""A toddler's shoe, 0.126 m long: an upper that rises from the toe to the collar, a sole, and a strap."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"red": (190, 44, 46), "blue": (48, 86, 158), "grey": (122, 124, 130)}

LENGTH, SOLE = 0.126, 0.012
"""Of the whole; height of the sole, metres."""

ALONG, HALF, TOP = (
    (-1.0, -0.94, -0.75, -0.4, -0.1, 0.2, 0.6, 0.9, 1.0),
    (0.006, 0.0165, 0.0255, 0.0275, 0.0235, 0.0235, 0.025, 0.0185, 0.009),
    (0.02, 0.027, 0.034, 0.038, 0.047, 0.058, 0.061, 0.063, 0.061),
)
"""Share of half the length from the middle (toe: -1) → half the width and the height there, metres."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("shoe", variant)
    colour = COLOURS[variant]
    upper = solids.closed_rings(_upper())
    opening = [solids.ellipsoid((0.0165, 0.027, 0.022), (0, 0.031, 0.066))]
    lining = solids.closed_rings(_scaled(_upper(), 0.86))
    collar = solids.cut(upper, *opening)
    outline = np.concatenate([_edge(1.06, -1), _edge(1.06, 1)[::-1]])
    sole = solids.prism(outline, SOLE)
    strap = solids.sweep(_strap(), np.array([(-0.008, 0), (0.008, 0), (0.008, 0.003), (-0.008, 0.003)]))
    white = materials.plastic(rng, (240, 238, 232), 128)
    dark = tuple(int(0.55 * c) for c in colour)
    parts = [
        paint(collar, materials.felt(rng, colour, 128), tiled(0.05), roughness=0.85, crease=45),
        paint(solids.above(lining, SOLE), materials.felt(rng, (206, 196, 178), 128), tiled(0.05), roughness=0.95),
        paint(sole, white, tiled(0.05), roughness=0.7),
        paint(strap, materials.felt(rng, dark, 128), tiled(0.04), roughness=0.8),
    ]
    rings = _upper()
    hulls = [pieces.coarse(np.concatenate(part), 60) for part in (rings[:8], rings[7:15], rings[14:])]
    hulls += [pieces.coarse(part.vertices, 60) for part in (sole, strap)]
    return BuiltObject(parts, hulls, mass=0.13, friction=0.9)


def _stations(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Shares of half the length from the middle, half the widths and heights there."""
    at = np.sort(np.concatenate([np.linspace(-1, 1, count), ALONG[1:-1]]))
    return at, np.interp(at, ALONG, HALF), np.interp(at, ALONG, TOP)


def _upper(points: int = 22) -> np.ndarray:
    """(stations, points, 3) outlines across the shoe: flat below, with a rounded back."""
    angle = np.linspace(0, np.pi, points - 2)
    side, top = (np.sign(f) * np.abs(f) ** 0.7 for f in (np.cos(angle), np.sin(angle)))
    rings = []
    for t, half, height in zip(*_stations(15), strict=True):
        x = np.concatenate([[-half * 0.97], [half * 0.97], half * side])
        z = np.concatenate([[SOLE - 0.001] * 2, SOLE + 0.003 + (height - SOLE - 0.003) * top])
        rings.append(np.column_stack([x, np.full(points, t * LENGTH / 2 * 0.97), z]))
    return np.array(rings)


def _scaled(rings: np.ndarray, share: float) -> np.ndarray:
    """Rings nearer to the middle of the shoe at the sides, a little lower at the top."""
    return rings * [share, share, 0.93]


def _edge(share: float, side: int) -> np.ndarray:
    """(n, 2) one side of the sole from toe to heel."""
    at, half, _ = _stations(25)
    return np.column_stack([-side * half * share, at * LENGTH / 2])


def _strap() -> np.ndarray:
    """(n, 3) the way of a strap over the instep."""
    angle = np.linspace(0.12, np.pi - 0.12, 13)
    x, z = 0.0248 * np.cos(angle), SOLE + 0.0325 * np.abs(np.sin(angle)) ** 0.7
    return np.column_stack([x, np.full(len(angle), -0.009), z])
