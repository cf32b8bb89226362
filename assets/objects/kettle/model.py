"""A stove kettle with a fixed handle across the top and its spout to the right."""

from __future__ import annotations

import numpy as np

from assets.shapes import lumps
from assets.shapes.cookware import dark_part, steel_part
from assets.shapes.handle import sections_along
from assets.textures import kitchen
from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("kettle", variant)
    knots = [(0.058, 0), (0.067, 0.006), (0.07, 0.02), (0.068, 0.045), (0.058, 0.072), (0.046, 0.087), (0.038, 0.0925)]
    shape = lumps.smooth(knots, 18)
    body = solids.revolved(np.concatenate([[(0, 0)], shape, [(0, 0.0925)]]), 48)
    lid = [(0, 0.091), (0.037, 0.091), (0.037, 0.0935), (0.03, 0.098), (0.016, 0.1015), (0, 0.1025)]
    lid_hull = pieces.stack([(0.037, 0.0915), (0.037, 0.0935), (0.03, 0.098), (0.016, 0.1015)])
    knob = np.concatenate(
        [[(0, 0.1), (0.006, 0.1), (0.005, 0.106)], solids.arc((0, 0.112), (0.0105, 0.007), -40, 90, 8)]
    )
    spout_path = np.array([(0.05, 0, 0.036), (0.066, 0, 0.046), (0.08, 0, 0.06), (0.092, 0, 0.078), (0.103, 0, 0.088)])
    spout = solids.sweep(spout_path, solids.circle(0.0165, 20), [1.15, 1, 0.78, 0.62, 0.6], up=(0, 1, 0))
    mouth = solids.sweep(
        spout_path[-2:] + (spout_path[-1] - spout_path[-2]) * 0.6, solids.circle(0.0078, 16), up=(0, 1, 0)
    )
    arch = _arch()
    strap = _strap(arch, 0.0024, 0.0065)
    grip = solids.moved(solids.rounded_box((0.02, 0.02, 0.078), 0.008), (-0.039, 0, 0.163), turn=90, axis=(0, 1, 0))
    coat = {"red": (178, 32, 34), "mint": (150, 200, 182)}.get(variant)
    if coat is None:
        parts = [
            steel_part(body, rng),
            steel_part(solids.revolved(lid, 40), rng),
            steel_part(solids.cut(spout, mouth), rng),
        ]
    else:
        glaze = kitchen.enamel(rng, coat)
        shells = (body, solids.revolved(lid, 40), solids.cut(spout, mouth))
        parts = [paint(shell, glaze, tiled(0.12), roughness=0.2) for shell in shells]
    parts += [dark_part(solids.revolved(knob, 24), rng), steel_part(strap, rng)]
    parts.append(
        dark_part(grip, rng) if variant != "mint" else paint(grip, materials.wood(rng), tiled(0.06), roughness=0.6)
    )
    hulls = [pieces.stack([(0.058, 0), *[tuple(p) for p in shape[2::3]], (0.038, 0.0925)]), lid_hull]
    hulls += [pieces.stack([(0.006, 0.1), (0.0105, 0.112), (0.006, 0.118)])]
    rings = np.asarray(spout.vertices)[: 5 * 20].reshape(5, 20, 3)
    hulls += pieces.chain(list(rings[:, ::2]))
    corners = np.array([(0.0024, 0.0065), (-0.0024, 0.0065), (-0.0024, -0.0065), (0.0024, -0.0065)])
    hulls += pieces.chain(sections_along(arch[[0, 2, 5, 8, -9, -6, -3, -1]], corners, up=(0, 1, 0)))
    hulls.append(grip.convex_hull)
    return BuiltObject(parts, hulls, mass=0.45, friction=0.7)


def _arch() -> np.ndarray:
    """(n, 3) a kettle's handle in the xz plane from the left shoulder over the top to the right one."""
    right = np.concatenate([[(0.053, 0.074)], [(0.058, 0.105)], solids.arc((0.04, 0.141), (0.021, 0.022), -5, 90, 7)])
    left = right[::-1] * (-1, 1)
    flat = np.concatenate([right, [(0.0, 0.163)], left])[::-1]
    return np.column_stack([flat[:, 0], np.zeros(len(flat)), flat[:, 1]])


def _strap(path: np.ndarray, thickness: float, half_width: float) -> solids.Solid:
    """A flat strip along a path in the xz plane; half its thickness and half its width (along y) are given."""
    section = np.array(
        [(-thickness, -half_width), (thickness, -half_width), (thickness, half_width), (-thickness, half_width)]
    )
    return solids.sweep(path, section, up=(0, 1, 0))
