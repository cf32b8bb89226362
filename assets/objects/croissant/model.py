"""A crescent of rolled dough, tips towards the front."""

from __future__ import annotations

import numpy as np

from assets.textures.foods import PALE
from vcage.objects.modelling import pieces, solids
from vcage.objects.modelling.mappings import along
from vcage.objects.modelling.noise import blend, clouds, over
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("croissant", variant)
    turn = np.radians(np.linspace(12, 168, 45))
    share = np.linspace(-1, 1, 45)
    envelope = 0.30 + 0.70 * np.cos(share * np.pi / 2) ** 0.8
    steps = np.abs(share) * 4.2
    ridges = 1 - 0.13 * (steps - np.floor(steps)) * (np.abs(share) < 0.97)
    scale = envelope * ridges
    scale[[0, -1]] *= 0.35
    half_height = 0.021
    angle = np.arange(24) * 2 * np.pi / 24
    section = np.stack([np.cos(angle) * 0.024, np.maximum(np.sin(angle) * half_height, -0.75 * half_height)], axis=1)
    path = np.stack([0.058 * np.cos(turn), 0.052 * np.sin(turn), 0.75 * half_height * scale], axis=1)
    roll = solids.sweep(path, section, scale)
    crust = _croissant_crust(rng, dark=variant == "dark")
    part = paint(roll, crust, along(path), roughness=0.42, crease=50)
    rings = [_ring_of(roll, i, 24) for i in (0, 1, 6, 11, 16, 22, 28, 33, 38, 43, 44)]
    return BuiltObject([part], pieces.chain(rings), mass=0.06, friction=0.8)


def _ring_of(swept: solids.Solid, index: int, count: int) -> np.ndarray:
    """Every other point of a section of a swept solid."""
    return np.asarray(swept.vertices)[index * count : (index + 1) * count : 2]


def _croissant_crust(rng: np.random.Generator, dark: bool = False) -> np.ndarray:
    """Rolled dough: columns run along the roll, rows up from the bottom; each turn is dark at its edge."""
    shape = (128, 512)
    share = np.linspace(-1, 1, shape[1])
    steps = np.abs(share) * 4.2
    edge = (steps - np.floor(steps))[None]
    gold, brown = ((196, 122, 52), (110, 58, 22)) if dark else ((222, 160, 84), (158, 92, 38))
    mottle = clouds(rng, shape, (3, 12)) - 0.5
    layers = 0.5 + 0.5 * np.sin(edge * 24)
    picture = blend(gold, brown, 0.12 + 0.75 * edge**3 + 0.7 * mottle + 0.1 * layers)
    return over(picture, PALE, np.clip(0.25 - edge, 0, 1) * 2.2 * (0.6 + mottle))
