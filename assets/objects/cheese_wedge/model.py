"""A wedge of cheese, 0.105 m long and 0.045 m high: the tip to the left, the rind to the right."""

from __future__ import annotations

import numpy as np

from assets.shapes.wedge import bevelled, wedge
from assets.textures import foods
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "emmental": ((246, 206, 92), (214, 160, 60), None),
    "gouda": ((246, 190, 84), (184, 32, 30), None),
    "blue": ((240, 234, 212), (196, 184, 156), (74, 96, 116)),
}
"""Variant → colour, rind, veins."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("cheese_wedge", variant)
    colour, rind, veins = VARIANTS[variant]
    outline = wedge(0.1, 17.0)
    body = bevelled(outline, 0.0, 0.045)
    if variant != "blue":
        body = solids.cut(body, *_holes(rng, small=variant == "gouda"))
    skin = solids.cut(
        solids.prism(wedge(0.105, 17.0), 0.0447, 0.0001),
        solids.prism(wedge(0.1, 17.6), 0.1, -0.01),
        solids.box((0.2, 0.2, 0.2), (-0.07, 0, -0.1)),
    )
    face, bubbles = _split_by_hull(body)
    parts = [
        paint(face, foods.cheese(rng, colour, veins), tiled(0.09), roughness=0.5),
        paint(skin, materials.plastic(rng, rind), tiled(0.05), roughness=0.35 if variant == "gouda" else 0.7),
    ]
    if len(bubbles.faces):
        shade = tuple(int(0.8 * c) for c in colour)
        parts.append(paint(bubbles, foods.cheese(rng, shade), tiled(0.09), roughness=0.6))
    return BuiltObject(parts, [body.convex_hull, pieces.coarse(skin.vertices)], mass=0.2, friction=0.8)


def _split_by_hull(body: solids.Solid) -> tuple[solids.Solid, solids.Solid]:
    """The faces on a body's convex hull, and those in its hollows."""
    hull = body.convex_hull
    depth = (body.triangles_center @ hull.face_normals.T - (hull.triangles_center * hull.face_normals).sum(axis=1)).max(
        axis=1
    )
    outside, inside = body.copy(), body.copy()
    outside.update_faces(depth > -1e-5)
    inside.update_faces(depth <= -1e-5)
    return outside, inside


def _holes(rng: np.random.Generator, small: bool) -> list[solids.Solid]:
    """Bubbles in the two cut sides and the top of a wedge."""
    out = []
    for i in range(18 if small else 24):
        radius = rng.uniform(0.0012, 0.0024) if small else rng.uniform(0.003, 0.0065)
        along, up = rng.uniform(0.025, 0.09), rng.uniform(0.008, 0.038)
        side = np.tan(np.radians(17.0)) * along
        place = [
            (-0.05 + along, side, up),
            (-0.05 + along, -side, up),
            (-0.05 + along, rng.uniform(-0.6, 0.6) * side, 0.045),
        ]
        flat = 0.75 if not small else 0.9
        out.append(solids.ellipsoid((radius, radius * flat, radius * 0.9), np.array(place[i % 3]), 14))
    return out
