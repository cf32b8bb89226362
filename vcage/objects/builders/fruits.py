"""Fruit."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, solids
from vcage.objects.builders.mappings import along, around, tiled
from vcage.objects.builders.parts import BuiltObject, paint, variant_rng
from vcage.objects.textures import foods, materials


def apple(variant: str) -> BuiltObject:
    """An apple of 0.066 m with a stem, standing on its five bumps."""
    rng = variant_rng("apple", variant)
    colours = {"red": ((168, 24, 28), (216, 84, 48)), "green": ((116, 164, 50), (170, 200, 92))}[variant]
    angle = np.radians(np.linspace(-90, 90, 25))
    radius = 0.033 * np.cos(angle) ** 0.62 * (1 + 0.06 * np.sin(angle))
    radius *= 0.033 / radius.max()
    z = 0.031 * np.sin(angle)
    dent = np.exp(-((radius / 0.011) ** 2))
    z = z - np.where(z > 0, 0.009, -0.005) * dent
    radius[[0, -1]] = 0
    body = solids.revolved(np.column_stack([radius, z]), 32)
    body.apply_translation((0, 0, -float(body.bounds[0, 2])))
    top = float(body.bounds[1, 2])
    stem_path = np.array(
        [(0, 0, top - 0.012), (0.0004, 0, top - 0.004), (0.0015, 0, top + 0.003), (0.0035, 0, top + 0.008)]
    )
    stem = solids.sweep(stem_path, solids.circle(0.0014, 8), (1, 0.9, 0.9, 1.2), up=(0, 1, 0))
    parts = [
        paint(body, foods.fruit_skin(rng, *colours, streaks=variant == "red"), around(), roughness=0.35),
        paint(stem, materials.plastic(rng, (92, 62, 36)), tiled(0.05), roughness=0.9),
    ]
    return BuiltObject(parts, [_standing(body, 0.014), stem.convex_hull], mass=0.16, friction=0.7)


def orange(variant: str) -> BuiltObject:
    """An orange or a tangerine, slightly flat at both poles."""
    rng = variant_rng("orange", variant)
    colour = {"orange": (238, 140, 30), "tangerine": (236, 110, 28)}[variant]
    flat = 0.031 if variant == "orange" else 0.027
    body = solids.ellipsoid((0.033, 0.033, flat), (0, 0, flat - 0.0012), 32)
    body = solids.above(body, 0.0)
    navel = solids.revolved([(0, 0), (0.003, 0), (0.0024, 0.0012), (0, 0.0014)], 10)
    navel = solids.moved(navel, (0, 0, float(body.bounds[1, 2]) - 0.0004))
    parts = [
        paint(body, foods.peel(rng, colour), tiled(0.06), roughness=0.5),
        paint(navel, materials.plastic(rng, (96, 120, 52)), tiled(0.05), roughness=0.8),
    ]
    return BuiltObject(parts, [_standing(body, 0.012)], mass=0.17, friction=0.7)


def banana(variant: str) -> BuiltObject:
    """A banana that lies on its side, bent towards the back."""
    rng = variant_rng("banana", variant)
    turn = np.radians(np.linspace(215, 325, 27))
    share = np.linspace(0, 1, 27)
    scale = np.interp(
        share, [0, 0.04, 0.12, 0.2, 0.45, 0.8, 0.93, 0.98, 1], [0.34, 0.3, 0.36, 0.78, 1, 0.92, 0.6, 0.3, 0.24]
    )
    radius = 0.0175
    section = solids.circle(radius, 20)
    section = section * (1 + 0.05 * np.cos(np.arange(20) * 5 * 2 * np.pi / 20))[:, None]
    section[:, 1] = np.maximum(section[:, 1], -0.88 * radius)
    path = np.stack([0.098 * np.cos(turn), 0.085 * np.sin(turn), 0.88 * radius * np.maximum(scale, 0.5)], axis=1)
    body = solids.sweep(path, section, scale)
    body.apply_translation((0, 0, -float(body.bounds[0, 2])))
    skin = foods.banana_skin(rng, ripe=variant == "ripe")
    rings = [np.asarray(body.vertices)[i * 20 : (i + 1) * 20] for i in (0, 2, 5, 8, 11, 14, 17, 20, 23, 26)]
    return BuiltObject([paint(body, skin, along(path), roughness=0.5, crease=55)], pieces.chain(rings), 0.12, 0.7)


def _standing(body: solids.Solid, foot: float) -> pieces.Piece:
    """A hull with a flat foot of the given radius, so that round things do not roll."""
    return pieces.hull(pieces.coarse(body.vertices).vertices, pieces.stack([(foot, 0), (foot, 0.001)]).vertices)


BUILDERS = {"apple": apple, "banana": banana, "orange": orange}
