"""A squeeze bottle of ketchup, oval, 0.168 m high, with a flip cap."""

from __future__ import annotations

import numpy as np

from assets.shapes import lumps
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "classic": ((186, 26, 22), (244, 242, 236), "TOMATO"),
    "spicy": ((150, 16, 18), (36, 34, 34), "HOT & SPICY"),
    "organic": ((196, 40, 26), (66, 134, 62), "ORGANIC"),
}
"""Variant → colour, cap colour, small."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("ketchup_bottle", variant)
    colour, cap_colour, small = VARIANTS[variant]
    half, depth = 0.031, 0.023
    knots = [
        (0.9, 0),
        (0.985, 0.003),
        (1.0, 0.01),
        (1.0, 0.04),
        (0.93, 0.068),
        (0.97, 0.092),
        (0.95, 0.106),
        (0.74, 0.122),
    ]
    knots += [(0.5, 0.13), (0.46, 0.134)]
    levels = lumps.smooth(knots, 26)
    oval = solids.circle(1.0, 40)
    rings = [np.column_stack([oval * _oval_size(s, half, depth), np.full(40, z)]) for s, z in levels]
    body = solids.closed_rings(rings)
    cap = [
        (0, 0.129),
        (0.0185, 0.129),
        (0.0195, 0.131),
        (0.0185, 0.151),
        (0.0165, 0.154),
        (0.0095, 0.156),
        (0.0075, 0.165),
    ]
    cap += [(0.0055, 0.168), (0, 0.168)]
    label = _ketchup_label(small, colour, cap_colour)
    wrap = solids.closed_rings([ring * (1.012, 1.016, 1) for ring in rings[6:15]])
    parts = [
        paint(body, materials.plastic(rng, colour), tiled(0.1), roughness=0.22),
        paint(wrap, label, around(), roughness=0.45),
        paint(solids.revolved(cap, 36), materials.plastic(rng, cap_colour), tiled(0.05), roughness=0.4),
    ]
    hulls = pieces.chain([rings[i] * (1.008, 1.01, 1) if 6 <= i < 15 else rings[i] for i in (0, 8, 13, 19, 25)])
    hulls[0] = pieces.hull(*rings[:8:2], rings[8] * (1.008, 1.01, 1))
    hulls.append(pieces.stack([(0.0185, 0.129), (0.0195, 0.131), (0.0185, 0.151), (0.0165, 0.154)]))
    hulls.append(pieces.stack([(0.0105, 0.153), (0.0075, 0.165), (0.0055, 0.168)], 8))
    return BuiltObject(parts, hulls, mass=0.42, friction=0.6)


def _ketchup_label(small: str, colour: Colour, accent: Colour) -> np.ndarray:
    """White with a red band, the word, and a tomato; in front and at the back."""
    label = prints.canvas(768, 250, (250, 246, 236))
    accent = accent if sum(accent) < 600 else (196, 150, 60)
    for low, high in ((0.0, 0.05), (0.95, 1.0)):
        label = prints.rectangle(label, (0, low), (1, high), accent)
    for x in (0.25, 0.75):
        label = prints.text(label, "KETCHUP", (x, 0.26), 0.19, colour)
        label = prints.text(label, small, (x, 0.85), 0.11, accent)
        label = prints.disc(label, (x, 0.58), 0.15, (210, 40, 30))
        label = prints.disc(label, (x - 0.02, 0.52), 0.03, (244, 170, 150))
        label = prints.rectangle(label, (x - 0.022, 0.42), (x + 0.022, 0.45), (60, 130, 50))
        label = prints.rectangle(label, (x - 0.004, 0.38), (x + 0.004, 0.45), (60, 130, 50))
    return np.roll(label, 192, axis=1)


def _oval_size(scale: float, half: float, depth: float) -> np.ndarray:
    """Half widths of a bottle's section, never flatter than its neck is round."""
    return np.array([half * scale, max(depth * scale, min(half * scale, 0.0165))])
