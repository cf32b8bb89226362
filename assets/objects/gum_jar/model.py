"""A clear jar full of chewing gum with a wide screw lid."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from assets.textures.labels import CODE_AT, coded
from assets.textures.product_faces import brand, darker
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, from_above
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "mint": ("MINT", (40, 150, 150), [(236, 246, 244), (206, 236, 230), (180, 224, 220)]),
    "fruit": ("FRUIT", (226, 70, 130), [(236, 84, 84), (250, 200, 60), (116, 190, 84), (84, 150, 220)]),
}
"""Variant → words, ground, colours."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("gum_jar", variant)
    words, ground, colours = VARIANTS[variant]
    radius, height, lid = 0.031, 0.088, 0.0215
    jar = [(0, 0), (radius - 0.003, 0), (radius, 0.003), (radius, height - lid - 0.006)]
    jar += [(radius - 0.004, height - lid + 0.002), (0, height - lid + 0.002)]
    low = height - lid
    cap = [(0, low), (radius - 0.001, low), (radius - 0.001, height - 0.0015), (radius - 0.003, height), (0, height)]
    ribbed = solids.cut(
        solids.revolved(cap, 48),
        *[
            solids.prism(solids.circle(0.0011, 6, (radius * np.cos(a), radius * np.sin(a))), 0.014, low + 0.002)
            for a in np.linspace(0, 2 * np.pi, 28, endpoint=False)
        ],
    )
    label_low, label_high = 0.011, 0.048
    band = [(0.02, label_low), (radius + 0.0003, label_low), (radius + 0.0003, label_high), (0.02, label_high)]
    label = prints.canvas(1280, 256, ground)
    label = prints.rectangle(label, (0, 0.05), (1, 0.09), (250, 250, 246))
    label = prints.rectangle(label, (0, 0.91), (1, 0.95), (250, 250, 246))
    for x in (0.0, 0.5, 1.0):
        label = brand(label, "BUBBO", (x, 0.34), 0.3, (255, 255, 250), darker(ground, 0.5))
        label = prints.text(label, f"{words} GUM", (x, 0.7), 0.18, (255, 255, 250))
    label = coded(label, ("gum_jar", variant), (CODE_AT, 0.5))
    top = materials.plastic(rng, (246, 246, 244), 256)
    top = prints.disc(top, (0.5, 0.5), 0.42, ground)
    top = brand(top, "GUM", (0.5, 0.5), 0.26, (255, 255, 250), darker(ground, 0.5))
    parts = [
        paint(solids.revolved(jar, 40), _sweets(rng, (768, 256), colours, 0.07), around(), roughness=0.12),
        paint(solids.revolved(band, 40), label, around(), roughness=0.5),
        paint(ribbed, top, from_above(), roughness=0.4),
    ]
    hulls = [
        pieces.stack([(radius - 0.003, 0), (radius + 0.0003, 0.003), (radius + 0.0003, low - 0.006), (0.028, low)]),
        pieces.stack([(radius - 0.001, low), (radius - 0.001, height - 0.001), (radius - 0.002, height)]),
    ]
    return BuiltObject(parts, hulls, mass=0.15, friction=0.6)


def _sweets(rng: np.random.Generator, size: tuple[int, int], colours: Sequence[Colour], share: float) -> np.ndarray:
    """A heap of round sweets behind clear plastic; ``share`` is a sweet's radius over the picture's height."""
    picture = prints.canvas(*size, darker(colours[0], 0.45))
    for _ in range(int(2.2 * size[0] / size[1] / share**2)):
        at = tuple(rng.random(2))
        colour = colours[rng.integers(len(colours))]
        picture = prints.disc(picture, at, 1.08 * share, darker(colour, 0.6))
        picture = prints.disc(picture, at, share, colour)
        shine = (at[0] - 0.3 * share * size[1] / size[0], at[1] - 0.35 * share)
        picture = prints.disc(picture, shine, 0.25 * share, darker(colour, 1.5))
    return picture
