"""A low round jar of face cream with a screw lid."""

from __future__ import annotations

from assets.textures import packaging
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, from_above
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "white": ((246, 244, 240), (212, 176, 112), (150, 116, 60)),
    "blue": ((28, 62, 140), (240, 242, 246), (246, 248, 250)),
    "rose": ((240, 204, 204), (248, 246, 244), (166, 84, 96)),
}
"""Variant → ground, lid, ink."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("cream_jar", variant)
    ground, lid, ink = VARIANTS[variant]
    radius, seam, height = 0.0315, 0.028, 0.047
    jar = [(0, 0), (radius - 0.004, 0), (radius - 0.001, 0.002), (radius, 0.005), (radius, seam - 0.002)]
    jar += [(radius - 0.0015, seam), (0, seam)]
    cap = [(0, seam), (radius, seam), (radius + 0.001, seam + 0.001), (radius + 0.001, height - 0.003)]
    cap += [(radius - 0.0005, height - 0.0008), (radius - 0.003, height), (0, height)]
    lines = [("VELLIA", 0.4, 0.14, 0.26, ink), ("face cream", 0.72, 0.13, 0.16, ink)]
    label = packaging.label((768, 112), ground, lines)
    top = materials.plastic(rng, lid, 256)
    mark = (110, 80, 36) if variant == "white" else ink if variant == "rose" else ground
    top = prints.disc(prints.disc(top, (0.5, 0.5), 0.42, mark), (0.5, 0.5), 0.405, lid)
    top = packaging.fitted(top, "VELLIA", (0.5, 0.45), (0.5, 0.14), mark)
    top = packaging.fitted(top, "face cream", (0.5, 0.61), (0.36, 0.07), mark)
    parts = [
        paint(solids.revolved(jar, 48), label, around(), roughness=0.25),
        paint(solids.revolved(cap, 48), top, from_above(), roughness=0.3),
    ]
    hulls = [
        pieces.stack([(radius - 0.003, 0), (radius, 0.004), (radius, seam)]),
        pieces.stack([(radius + 0.001, seam), (radius + 0.001, height - 0.002), (radius - 0.002, height)]),
    ]
    return BuiltObject(parts, hulls, mass=0.16, friction=0.6)
