"""A low stand with a pile of cards that lean back."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import six_sides, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("business_card_holder", variant)
    width, depth, front, back, lean = 0.098, 0.046, 0.016, 0.036, 0.35
    skin = {
        "wood": materials.wood(rng, materials.WALNUT),
        "black": materials.plastic(rng, (42, 42, 46)),
        "steel": materials.brushed(rng),
    }[variant]
    base = solids.rounded_box((width, depth, 0.007), 0.002)
    lip = solids.rounded_box((width, 0.006, front), 0.002, (0, -depth / 2 + 0.003, 0))
    rest = pieces.across(
        [(0.012, 0.004), (0.02, 0.004), (0.02 + lean * 0.008, back), (0.015 + lean * 0.008, back)], width
    )
    rest_low = solids.box((width, 0.008, 0.006), (0, 0.018, 0.003))
    low = np.array([(-0.016, 0.0068), (0.011, 0.0068)])
    rise = np.array([0.11, 0.99]) * 0.049
    cards = pieces.across([low[0], low[1], low[1] + rise, low[0] + rise], 0.088)
    face = packaging.fitted(
        prints.canvas(352, 200, (252, 251, 247)), "ADA MERTON", (0.42, 0.28), (0.6, 0.14), packaging.GRAPHITE
    )
    face = packaging.fitted(face, "architect", (0.28, 0.45), (0.28, 0.09), (120, 122, 128))
    face = prints.disc(face, (0.84, 0.3), 0.14, (40, 128, 150))
    for row in (0.66, 0.76, 0.86):
        face = prints.rectangle(face, (0.12, row), (0.5, row + 0.025), (150, 152, 158))
    edges = materials.page_edges(rng, (246, 244, 236))
    upright = edges.transpose(1, 0, 2)
    picture = prints.atlas(
        {"front": face, "back": face, "top": edges, "left": upright, "right": upright},
        (246, 244, 236),
        (352, 200),
    )
    metallic = 0.4 if variant == "steel" else 0.0
    parts = [
        paint(solids.union(base, lip, rest, rest_low), skin, tiled(0.1), roughness=0.4, metallic=metallic),
        paint(cards, picture, six_sides(), roughness=0.8),
    ]
    return BuiltObject(parts, [base.convex_hull, lip.convex_hull, rest, cards], mass=0.16, friction=0.6)
