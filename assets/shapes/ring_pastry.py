"""Pastry in the shape of a ring."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import pieces, solids
from vcage.objects.modelling.mappings import from_above
from vcage.objects.modelling.parts import BuiltObject, Mapping, paint


def ring_pastry(
    coats: list[tuple[np.ndarray, float, float]],
    rng: np.random.Generator,
    outer: float,
    tube: tuple[float, float],
    mapping: Mapping | None = None,
) -> BuiltObject:
    """A torus with a flat bottom; each further coat (texture, roughness, from height) is a skin over the top.

    Args:
        coats: texture, roughness, and the height from which it covers, of the dough and of what is on it.
        rng: for unevenness.
        outer: radius of the whole ring, metres.
        tube: half width and half height of its section, metres.
        mapping: of all textures; from above when None.
    """
    parts = []
    flat = 0.85 * tube[1]
    for i, (texture, roughness, start) in enumerate(coats):
        grow = 0.0009 * i
        oval = solids.arc((outer - tube[0], flat), (tube[0] + grow, tube[1] + grow), -90, 255, 24)
        torus = solids.displaced(solids.revolved(oval, 40), 0.0004 if i == 0 else 0.0, 0.03, rng)
        parts.append(paint(solids.above(torus, start), texture, mapping or from_above(), roughness=roughness))
    middle, top = outer - tube[0], flat + tube[1] + 0.0009 * (len(coats) - 1)
    extra = 0.0009 * (len(coats) - 1)
    section = solids.arc((middle, flat), (tube[0] + extra, tube[1] + extra), -90, 240, 12)
    section[:, 1] = np.clip(section[:, 1], 0, top)
    return BuiltObject(parts, pieces.ring([tuple(p) for p in section], 12), mass=0.07, friction=0.8)
