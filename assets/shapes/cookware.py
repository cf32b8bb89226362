"""Steel and dark plastic of cookware."""

from __future__ import annotations

import numpy as np

from assets.textures import kitchen
from vcage.objects.modelling import materials, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import Part, paint


def steel_part(solid: solids.Solid, rng: np.random.Generator) -> Part:
    """A solid of satin steel."""
    return paint(solid, kitchen.steel(rng), tiled(0.08), roughness=0.28, metallic=0.5)


def dark_part(solid: solids.Solid, rng: np.random.Generator) -> Part:
    """A solid of dark, heat-proof plastic."""
    return paint(solid, materials.plastic(rng, (38, 37, 38)), tiled(0.06), roughness=0.5)
