"""Open boxes and trays: receptacles with straight walls."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, solids
from vcage.objects.builders.mappings import from_front, tiled
from vcage.objects.builders.parts import BuiltObject, Part, paint, variant_rng
from vcage.objects.textures import materials, prints


def packaging_box(variant: str) -> BuiltObject:
    """An open cardboard box, 0.22 × 0.18 m inside, with the long flaps folded down outside."""
    rng = variant_rng("packaging_box", variant)
    colour = {"brown": (190, 148, 100), "white": (228, 226, 220)}[variant]
    inner, wall, floor, height = (0.22, 0.18), 0.004, 0.004, 0.044
    flap = 0.004
    shell = _open_box(inner, wall, floor, height)
    board = materials.cardboard(rng, colour)
    parts = [paint(shell, board, tiled(0.12), roughness=0.9)]
    hulls = pieces.tray(inner, wall, floor, height)
    for side in (-1, 1):
        middle = side * (inner[1] / 2 + wall + flap / 2)
        leaf = solids.box((inner[0] - 0.01, flap, height - 0.014), (0, middle, 0.013))
        parts.append(paint(leaf, materials.cardboard(rng, colour), tiled(0.12), roughness=0.9))
        hulls.append(leaf)
    parts.append(_sign("THIS SIDE UP", 0.1, 0.026, (0, -inner[1] / 2 - wall - flap, 0.019), colour, (70, 50, 34)))
    return BuiltObject(parts, hulls, mass=0.16, friction=0.6)


def bread_box(variant: str) -> BuiltObject:
    """An open wooden box, 0.26 × 0.20 m inside, lined with a checked cloth."""
    rng = variant_rng("bread_box", variant)
    colours = {"oak": materials.OAK, "walnut": materials.WALNUT}[variant]
    inner, wall, floor, height = (0.26, 0.20), 0.009, 0.008, 0.048
    shell = _open_box(inner, wall, floor, height, rounding=0.003)
    cloth = solids.box((inner[0] - 0.004, inner[1] - 0.004, 0.001), (0, 0, floor - 0.0002))
    parts = [
        paint(shell, materials.wood(rng, colours), tiled(0.14), roughness=0.65),
        paint(cloth, _checked_cloth(rng), tiled(0.08), roughness=0.95),
        _sign("BREAD", 0.1, 0.026, (0, -inner[1] / 2 - wall, 0.015), colours[1], (62, 36, 20)),
    ]
    hulls = pieces.tray(inner, wall, floor + 0.0008, height)
    return BuiltObject(parts, hulls, mass=0.75, friction=0.6)


def tray(variant: str) -> BuiltObject:
    """A serving tray with a low lip and two grips."""
    rng = variant_rng("tray", variant)
    inner, wall, floor, height = (0.28, 0.19), 0.007, 0.005, 0.02
    shell = _open_box(inner, wall, floor, height, rounding=0.012)
    hulls = pieces.tray(inner, wall, floor, height)
    grips = []
    for side in (-1, 1):
        middle = side * (inner[0] / 2 + wall / 2)
        grips.append(solids.rounded_box((0.012, 0.085, 0.014), 0.004, (middle, 0, height - 0.002)))
    body = solids.union(shell, *grips)
    hulls += [grip.convex_hull for grip in grips]
    if variant == "wood":
        part = paint(body, materials.wood(rng, materials.BEECH), tiled(0.16), roughness=0.6)
    else:
        part = paint(body, materials.plastic(rng, (74, 92, 108)), tiled(0.1), roughness=0.5)
    return BuiltObject([part], hulls, mass=0.6, friction=0.6)


def basket(variant: str) -> BuiltObject:
    """A low woven basket, 0.20 × 0.15 m inside."""
    rng = variant_rng("basket", variant)
    colour = {"natural": (184, 138, 84), "grey": (150, 150, 148)}[variant]
    inner, wall, floor, height = (0.20, 0.15), 0.007, 0.006, 0.055
    shell = _open_box(inner, wall, floor, height - 0.004, rounding=0.006)
    outer = np.array(inner) + 2 * wall
    band = solids.prism(solids.rounded_rectangle(outer + 0.004, 0.01), 0.008, height - 0.008)
    band = solids.cut(band, solids.prism(solids.rounded_rectangle(inner, 0.006), 0.1))
    parts = [
        paint(shell, materials.wicker(rng, colour), tiled(0.08), roughness=0.9),
        paint(band, materials.wicker(rng, tuple(int(0.8 * c) for c in colour), weave=16), tiled(0.08), roughness=0.9),
    ]
    hulls = pieces.tray(inner, wall, floor, height)
    return BuiltObject(parts, hulls, mass=0.3, friction=0.7)


def _open_box(
    inner: tuple[float, float], wall: float, floor: float, height: float, rounding: float = 0.0
) -> solids.Solid:
    """A box without a lid; ``rounding`` is the radius of its upright edges."""
    outer = (inner[0] + 2 * wall, inner[1] + 2 * wall)
    if rounding == 0:
        return solids.cut(solids.box((*outer, height)), solids.box((*inner, 1.0), (0, 0, floor)))
    hollow = solids.prism(solids.rounded_rectangle(inner, max(rounding - wall, 0.002)), 1.0, floor)
    return solids.cut(solids.prism(solids.rounded_rectangle(outer, rounding), height), hollow)


def _sign(
    words: str, width: float, height: float, bottom: tuple[float, float, float], ground: tuple, ink: tuple
) -> Part:
    """Words printed on the front: a plate of half a millimetre."""
    picture = prints.canvas(round(128 * width / height), 128, ground)
    picture = prints.text(picture, words, (0.5, 0.5), 0.5, ink)
    return paint(solids.box((width, 0.0008, height), bottom), picture, from_front(), roughness=0.9)


def _checked_cloth(rng: np.random.Generator) -> np.ndarray:
    """White linen with crossing red stripes."""
    cloth = materials.felt(rng, (250, 246, 238), 256).astype(np.float32)
    stripe = (np.arange(256) // 32) % 2 == 0
    tint = np.array([0.86, 0.5, 0.46])
    cloth[stripe] *= tint
    cloth[:, stripe] *= tint
    return np.clip(cloth, 0, 255).astype(np.uint8)


BUILDERS = {"basket": basket, "bread_box": bread_box, "packaging_box": packaging_box, "tray": tray}
