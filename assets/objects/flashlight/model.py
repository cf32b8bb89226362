"""A metal torch that stands on its lamp."""

from __future__ import annotations

from assets.textures import packaging
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"black": (48, 50, 54), "silver": (188, 192, 198), "red": (176, 34, 38)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("flashlight", variant)
    colour = COLOURS[variant]
    head = [(0, 0.001), (0.019, 0.001), (0.019, 0), (0.0225, 0), (0.0225, 0.004), (0.0218, 0.005), (0.0218, 0.026)]
    head += [(0.016, 0.041), (0, 0.041)]
    barrel = solids.revolved([(0, 0.04), (0.0145, 0.04), (0.0145, 0.112), (0, 0.112)], 36)
    rings = [solids.revolved(_washer(0.0158, z, 0.004), 36) for z in (0.043, 0.112)]
    tail = [(0, 0.112), (0.015, 0.112), (0.015, 0.131), (0.0135, 0.133), (0, 0.133)]
    knob = solids.revolved([(0, 0.1325), (0.0075, 0.1325), (0.0075, 0.1348), (0.006, 0.136), (0, 0.136)], 24)
    switch = solids.rounded_box((0.009, 0.004, 0.018), 0.0018, (0, -0.0145, 0.054))
    shade = tuple(int(0.8 * c) for c in colour)
    metal = materials.brushed(rng, colour)
    parts = [
        paint(solids.revolved(head, 40), metal, tiled(0.05, along=2), roughness=0.35, metallic=0.4),
        paint(barrel, packaging.knurled(rng, colour), tiled(0.03), roughness=0.45, metallic=0.3),
        paint(
            solids.union(*rings, solids.revolved(tail, 36)),
            materials.brushed(rng, shade),
            tiled(0.05),
            roughness=0.35,
            metallic=0.4,
        ),
        paint(knob, materials.plastic(rng, (214, 120, 30)), tiled(0.05), roughness=0.7),
        paint(switch, materials.plastic(rng, (214, 120, 30)), tiled(0.05), roughness=0.7),
    ]
    hulls = [
        pieces.stack([(0.0225, 0), (0.0225, 0.005), (0.0218, 0.026), (0.016, 0.041)]),
        pieces.stack([(0.015, 0.04), (0.0155, 0.1165), (0.015, 0.132)]),
        pieces.stack([(0.0075, 0.1315), (0.0075, 0.1348), (0.006, 0.136)], 12),
        switch.convex_hull,
    ]
    return BuiltObject(parts, hulls, mass=0.16, friction=0.7)


def _washer(radius: float, z: float, height: float) -> list[tuple[float, float]]:
    return [(0, z), (radius, z), (radius, z + height), (0, z + height)]
