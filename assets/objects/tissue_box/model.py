"""A slim box of tissues, the first one standing out of the slot."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import pieces, prints, solids
from vcage.objects.modelling.mappings import six_sides, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "blue": ((150, 196, 226), (246, 248, 250), (34, 84, 140)),
    "floral": ((250, 236, 226), (226, 120, 140), (150, 60, 84)),
    "green": ((170, 206, 164), (250, 250, 240), (48, 104, 66)),
}
"""Variant → ground, bloom, ink."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("tissue_box", variant)
    ground, bloom, ink = VARIANTS[variant]
    size = (0.17, 0.066, 0.066)
    face = packaging.label((512, 200), ground, [], [(0.84, 0.87, ink)])
    for _ in range(26):
        x, y, reach = rng.uniform(0, 1), rng.uniform(0, 0.76), rng.uniform(0.035, 0.075)
        for turn in np.arange(5) * 2 * np.pi / 5:
            petal = (x + reach * np.cos(turn) * 200 / 512, y + reach * np.sin(turn))
            face = prints.disc(face, petal, 0.62 * reach, bloom)
        face = prints.disc(face, (x, y), 0.4 * reach, (246, 206, 90))
    front = prints.rectangle(face, (0.28, 0.28), (0.72, 0.68), bloom if variant != "floral" else ground)
    front = packaging.fitted(front, "TISSUES", (0.5, 0.46), (0.36, 0.2), ink)
    front = packaging.fitted(front, "soft & strong", (0.5, 0.61), (0.26, 0.08), ink)
    top = face.copy()
    for colour, wide, tall in ((ink, 0.29, 0.31), ((236, 240, 242), 0.275, 0.27)):
        slot = solids.circle(1.0, 40) * (wide, tall) + 0.5
        top = packaging.polygon(top, [tuple(p) for p in slot], colour)
    picture = prints.atlas({"front": front, "back": front, "top": top, "left": face, "right": face}, ground, (512, 200))
    box = solids.rounded_box(size, 0.0015, steps=2)
    tuft = _tuft(size[2])
    parts = [
        paint(box, picture, six_sides(), roughness=0.6),
        paint(tuft, packaging.quilted(rng, (252, 252, 250)), tiled(0.08), roughness=0.95, crease=25),
    ]
    return BuiltObject(parts, [solids.box(size), pieces.coarse(tuft.vertices)], mass=0.14, friction=0.6)


def _tuft(z: float) -> solids.Solid:
    """A pulled-up tissue that rises from the height ``z``: a creased flame, wide along x."""
    angle = np.arange(28) * 2 * np.pi / 28
    folds = 1 + 0.16 * np.cos(5 * angle + 0.6) + 0.08 * np.cos(9 * angle)
    rings = []
    for share in np.linspace(0, 1, 6):
        wide = 0.023 + 0.005 * np.sin(np.pi * share) - 0.009 * share
        deep = 0.009 + 0.003 * np.sin(np.pi * share) - 0.006 * share
        lift = z - 0.001 + 0.026 * share + 0.0025 * share * np.cos(3 * angle)
        rings.append(np.column_stack([np.cos(angle) * folds * wide, np.sin(angle) * folds * deep, lift]))
    return solids.closed_rings(rings)
