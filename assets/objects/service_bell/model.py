"""A counter bell: a domed shell on a round foot, and a button on top that sinks in by 6 mm."""

from __future__ import annotations

import numpy as np

from assets.shapes.push_button import button_joint
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, MovingPart, paint, variant_rng

VARIANTS = {
    "silver": ((206, 209, 214), (40, 40, 44)),
    "brass": ((212, 172, 90), (70, 42, 28)),
    "red": ((184, 36, 38), (206, 208, 212)),
}
"""Variant → colour, foot."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("service_bell", variant)
    colour, foot = VARIANTS[variant]
    base = solids.revolved([(0, 0), (0.033, 0), (0.034, 0.001), (0.034, 0.007), (0.032, 0.009), (0, 0.009)], 48)
    neck = solids.revolved([(0, 0.008), (0.026, 0.008), (0.026, 0.014), (0, 0.014)], 36)
    crown = solids.arc((0.012, 0.0275), (0.0195, 0.0185), 0, 82, 9)
    rim = [(0, 0.0115), (0.0325, 0.0115), (0.0325, 0.0135), (0.0315, 0.015)]
    dome = solids.revolved(np.concatenate([rim, crown, [(0, 0.0463)]]), 48)
    collar = solids.revolved([(0, 0.0455), (0.0085, 0.0455), (0.0085, 0.048), (0.0075, 0.049), (0, 0.049)], 28)
    parts = [
        paint(solids.union(base, neck), materials.plastic(rng, foot), tiled(0.05), roughness=0.5),
        paint(dome, materials.polished(colour), around(), roughness=0.15, metallic=0.5),
        paint(collar, materials.brushed(rng), tiled(0.05), roughness=0.2, metallic=0.5),
    ]
    shell = [(r, z) for r, z in [(0.0325, 0.0115), (0.0315, 0.015), *crown[::2]]]
    hulls = [
        pieces.stack([(0.034, 0), (0.034, 0.007), (0.032, 0.009)]),
        pieces.stack([(0.026, 0.009), (0.026, 0.0115)]),
        pieces.stack(shell),
        pieces.stack([(0.0085, 0.0455), (0.0085, 0.049)]),
    ]
    return BuiltObject(parts, hulls, mass=0.4, friction=1.0, moving=[_button(rng, foot)])


def _button(rng: np.random.Generator, colour: Colour) -> MovingPart:
    """A short plunger with a round top."""
    stem = solids.revolved([(0, 0.0495), (0.0045, 0.0495), (0.0045, 0.058), (0, 0.058)], 24)
    head = [(0, 0.0565), (0.0068, 0.0565), (0.0075, 0.058), (0.007, 0.0605), (0.005, 0.062), (0, 0.0625)]
    parts = [
        paint(stem, materials.brushed(rng), tiled(0.05), roughness=0.2, metallic=0.5),
        paint(solids.revolved(head, 28), materials.plastic(rng, colour), tiled(0.05), roughness=0.3),
    ]
    hulls = [
        pieces.stack([(0.0045, 0.05), (0.0045, 0.057)], 12),
        pieces.stack([(0.0068, 0.0565), (0.0075, 0.058), (0.007, 0.0605), (0.005, 0.0625)]),
    ]
    return MovingPart("button", parts, hulls, mass=0.005, joint=button_joint((0.0, 0.0, 0.055), 0.006))
