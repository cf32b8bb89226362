"""An open cooking pot, 0.15 m across and 0.08 m high, with a lug on the left and on the right."""

from __future__ import annotations

import numpy as np

from assets.shapes.cookware import dark_part, steel_part
from assets.shapes.handle import sections_along
from assets.textures import kitchen
from vcage.objects.modelling import pieces, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.noise import shaded
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("pot", variant)
    radius, height, wall, floor = 0.075, 0.08, 0.004, 0.006
    profile = [(0, 0), (radius - 0.007, 0), (radius - 0.002, 0.002), (radius, 0.007), (radius, height - 0.005)]
    profile += [(radius + 0.0022, height - 0.0035), (radius + 0.003, height - 0.0015), (radius + 0.0015, height)]
    profile += [(radius - wall, height), (radius - wall, floor + 0.004), (radius - wall - 0.004, floor), (0, floor)]
    outside, inside = solids.split_by_facing(solids.revolved(profile, 56))
    hulls = [pieces.stack([(radius - 0.007, 0), (radius - 0.002, 0.002), (radius - 0.001, floor)])]
    hulls += pieces.ring([(radius - wall, floor), (radius, floor), (radius + 0.0025, height), (radius - wall, height)])
    coat = {"red": (176, 36, 34), "blue": (40, 78, 128)}.get(variant)
    if coat is None:
        parts = [
            steel_part(outside, rng),
            paint(inside, _steel_bowl(rng), from_above(), roughness=0.3, metallic=0.5),
        ]
    else:
        white = kitchen.enamel(rng, (238, 236, 228), chips=False)
        parts = [
            paint(outside, kitchen.enamel(rng, coat), tiled(0.12), roughness=0.22),
            paint(inside, white, tiled(0.12), roughness=0.25),
        ]
    path = _lug_path(radius - 0.0065, 0.061)
    section = solids.circle(1.0, 12) * (0.0052, 0.0045)
    for side in (-1, 1):
        lug = solids.moved(solids.sweep(path, section), turn=0 if side > 0 else 180)
        parts.append(steel_part(lug, rng) if coat is None else dark_part(lug, rng))
        corners = np.array([(0.0052, 0.0045), (-0.0052, 0.0045), (-0.0052, -0.0045), (0.0052, -0.0045)])
        turned = path * (side, side, 1)
        hulls += pieces.chain(sections_along(turned[[0, 1, 3, 6, 9, 11, 14, 17, 19, 20]], corners, up=(0, 0, 1)))
    return BuiltObject(parts, hulls, mass=0.5, friction=0.6)


def _lug_path(start: float, z: float) -> np.ndarray:
    """(21, 3) a loop from the wall to the right and back, 0.05 m wide between its middle lines."""
    half, reach, bend = 0.0248, 0.034, 0.014
    corner = solids.arc((start + reach - bend, half - bend), bend, 90, 0, 9)
    back = np.concatenate([[(start, half)], corner])
    front = back[::-1] * (1, -1)
    flat = np.concatenate([back, [(start + reach, 0)], front])[::-1]
    return np.column_stack([flat, np.full(len(flat), z)])


def _steel_bowl(rng: np.random.Generator, size: int = 384) -> np.ndarray:
    """The inside of a steel pot seen from above: brushed in circles."""
    away = kitchen.from_centre(size)
    scratch = rng.random(size).astype(np.float32)
    tone = 0.84 + 0.16 * np.interp(away, np.linspace(0, 1.5, size), scratch)
    return shaded(np.full((size, size, 3), (198, 200, 203), dtype=np.uint8), tone)
