"""A coupe plate, 0.21 m across, flat over 0.18 m, with a steep rim that fingers can close on."""

from __future__ import annotations

from assets.textures.kitchen import GLAZES
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_above
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("plate", variant)
    profile = [(0, 0), (0.078, 0), (0.082, 0.0015), (0.094, 0.003), (0.0995, 0.0075), (0.1045, 0.026), (0.1035, 0.0272)]
    profile += [(0.1005, 0.0268), (0.0955, 0.0095), (0.0915, 0.0066), (0, 0.006)]
    dish = solids.revolved(profile, 56)
    glaze = materials.plastic(rng, GLAZES[variant], 256)
    line = (58, 92, 148) if variant == "white" else (226, 226, 218)
    glaze = prints.disc(prints.disc(glaze, (0.5, 0.5), 0.445, line), (0.5, 0.5), 0.425, GLAZES[variant])
    hulls = [pieces.stack([(0.079, 0), (0.0935, 0.0028), (0.0935, 0.0066)])]
    hulls += pieces.ring([(0.0915, 0.0064), (0.0935, 0.003), (0.0995, 0.0075), (0.0955, 0.0095)])
    hulls += pieces.ring([(0.0955, 0.0095), (0.0995, 0.0075), (0.1045, 0.026), (0.1035, 0.0272), (0.1005, 0.0268)])
    return BuiltObject([paint(dish, glaze, from_above(), roughness=0.25)], hulls, mass=0.45, friction=0.6)
