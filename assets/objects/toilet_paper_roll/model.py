"""A half-used roll that stands upright, with its cardboard core and a loose end."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import around, from_above, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"white": (246, 245, 241), "natural": (216, 190, 152)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("toilet_paper_roll", variant)
    colour = COLOURS[variant]
    outer, inner, height = 0.0335, 0.0205, 0.096
    paper = [(inner + 0.0015, 0), (outer - 0.001, 0), (outer, 0.001), (outer, height - 0.001), (outer - 0.001, height)]
    side = solids.revolved([*paper, (inner + 0.0015, height)], 48)
    flat = np.abs(side.face_normals[:, 2]) > 0.5
    ends, wrap = side.copy(), side.copy()
    ends.update_faces(flat)
    wrap.update_faces(~flat)
    core = [(inner, 0), (inner + 0.0016, 0), (inner + 0.0016, height + 0.0004), (inner, height + 0.0004)]
    angle = np.radians(np.linspace(-120, -84, 7))  # the loose end of the paper, in front
    sheet = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    reach = np.linspace(outer - 0.0003, outer + 0.0012, 7)[:, None]
    leaf = solids.prism(np.concatenate([sheet * (reach + 0.0004), (sheet * (reach - 0.0004))[::-1]]), 0.09, 0.003)
    pattern = packaging.quilted(rng, colour)
    parts = [
        paint(wrap, pattern, around(), roughness=0.95),
        paint(ends, packaging.windings(colour, 16, 0.72), from_above(), roughness=0.95),
        paint(leaf, pattern, tiled(0.1), roughness=0.95),
        paint(solids.revolved(core, 40), materials.cardboard(rng, (172, 136, 96)), tiled(0.1), roughness=0.9),
    ]
    hulls = pieces.ring([(inner, 0), (outer, 0), (outer, height), (inner, height)])
    return BuiltObject(parts, hulls, mass=0.06, friction=0.8)
