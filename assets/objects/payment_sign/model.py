"""A thick acrylic panel with a square payment code, upright in a foot."""

from __future__ import annotations

import numpy as np

from assets.textures.labels import payment_code, stamped
from assets.textures.till_faces import PAPER, framed
from vcage.objects.modelling import materials, prints, solids
from vcage.objects.modelling.mappings import six_sides, tiled
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "blue": ((34, 98, 196), "ZIPPA"),
    "green": ((30, 146, 86), "PAYLEAF"),
    "orange": ((232, 116, 34), "QUIKO"),
}
"""Variant → ground, brand."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("payment_sign", variant)
    ground, brand = VARIANTS[variant]
    size, foot = (0.1, 0.011, 0.141), 0.016
    panel = solids.rounded_box(size, 0.0012, (0, 0, foot - 0.006), steps=2)
    base = solids.rounded_box((0.108, 0.06, foot), 0.004)
    poster = _payment_poster(rng, ground, brand)
    back = prints.text(prints.canvas(440, 620, ground), brand, (0.5, 0.5), 0.1, (255, 255, 255))
    glass = (196, 222, 224)
    parts = [
        paint(panel, prints.atlas({"front": poster, "back": back}, glass, (440, 620)), six_sides(), roughness=0.12),
        paint(base, materials.wood(rng, materials.BEECH), tiled(0.12), roughness=0.6),
    ]
    hulls = [solids.box((size[0], size[1], size[2] - 0.006), (0, 0, foot)), base.convex_hull]
    return BuiltObject(parts, hulls, mass=0.35, friction=0.6)


def _payment_poster(rng: np.random.Generator, ground: Colour, brand: str) -> np.ndarray:
    """The front of a payment sign: a heading, a square code on white, and the name of the service."""
    picture = prints.canvas(440, 620, ground)
    picture = prints.text(picture, "SCAN TO PAY", (0.5, 0.1), 0.085, (255, 255, 255))
    code = framed(payment_code(rng), (255, 255, 255), 0.05)
    picture = stamped(picture, code, (0.5, 0.49))
    picture = prints.rectangle(picture, (0, 0.82), (1, 1), PAPER)
    return prints.text(picture, brand, (0.5, 0.905), 0.09, ground)
