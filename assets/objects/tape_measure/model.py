"""A tape measure that stands upright, the hook of its tape at the left foot."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import lofts, materials, prints, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, Mapping, paint, variant_rng

VARIANTS = {"yellow": ((248, 198, 24), (40, 40, 44)), "red": ((200, 36, 40), (52, 54, 58))}
"""Variant → case, rubber."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("tape_measure", variant)
    case, rubber = VARIANTS[variant]
    wide, tall, thick = 0.07, 0.064, 0.036
    corner = solids.arc((wide / 2 - 0.03, tall - 0.03), 0.03, 0, 90, 9)
    foot = solids.arc((wide / 2 - 0.006, 0.006), 0.006, -90, 0, 4)
    nose = [(-wide / 2 + 0.02, tall), (-wide / 2 + 0.008, tall - 0.006), (-wide / 2, tall - 0.02), (-wide / 2, 0.0)]
    outline = np.concatenate([foot, corner, nose])  # x, z; counter-clockwise
    shell = lofts.along_y(outline[::-1, ::-1], thick)
    wrapped = np.maximum((outline - (0, tall / 2)) * 1.014 + (0, tall / 2), (-1.0, 0.0))
    band = lofts.along_y(wrapped[::-1, ::-1], 0.4 * thick)
    face = prints.disc(prints.canvas(320, 292, rubber), (0.52, 0.46), 0.4, case)
    face = prints.disc(face, (0.52, 0.46), 0.27, (246, 246, 240))
    face = prints.disc(face, (0.52, 0.46), 0.25, case)
    face = packaging.fitted(face, "5 m", (0.52, 0.44), (0.34, 0.16), rubber)
    face = packaging.fitted(face, "GAUGER", (0.52, 0.58), (0.3, 0.06), rubber)
    flat = np.abs(shell.face_normals[:, 1]) > 0.9
    sides, rim = shell.copy(), shell.copy()
    sides.update_faces(flat)
    rim.update_faces(~flat)
    mouth = solids.box((0.006, 0.02, 0.007), (-wide / 2 - 0.0025, 0, 0.003))
    blade = solids.box((0.014, 0.019, 0.0012), (-wide / 2 - 0.008, 0, 0.005))
    hook = solids.box((0.0015, 0.019, 0.0075), (-wide / 2 - 0.0155, 0, 0.0))
    button = solids.rounded_box((0.012, 0.014, 0.006), 0.002, (-0.018, 0, tall - 0.005))
    ticks = packaging.striped([(248, 214, 60), (30, 30, 32)], 20)
    parts = [
        paint(sides, face, _both_sides(), roughness=0.5),
        paint(rim, materials.plastic(rng, rubber), tiled(0.05), roughness=0.7, crease=25),
        paint(band, materials.plastic(rng, case), tiled(0.05), roughness=0.4, crease=25),
        paint(mouth, materials.plastic(rng, (28, 28, 30)), tiled(0.05), roughness=0.6),
        paint(blade, ticks, tiled(0.02), roughness=0.4),
        paint(hook, materials.brushed(rng), tiled(0.05), roughness=0.3, metallic=0.5),
        paint(button, materials.plastic(rng, (214, 40, 36)), tiled(0.05), roughness=0.5),
    ]
    return BuiltObject(parts, [shell.convex_hull, mouth, blade, hook, button.convex_hull], mass=0.2, friction=0.7)


def _both_sides() -> Mapping:
    """The picture as seen from the front, on the back as seen from there."""

    def mapping(corners: np.ndarray, normals: np.ndarray) -> np.ndarray:
        flat = corners[..., [0, 2]]
        low, high = flat.reshape(-1, 2).min(axis=0), flat.reshape(-1, 2).max(axis=0)
        uv = (flat - low) / (high - low)
        back = normals[:, 1] > 0
        uv[back, :, 0] = 1 - uv[back, :, 0]
        return uv

    return mapping
