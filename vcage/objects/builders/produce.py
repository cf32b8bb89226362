"""Vegetables and more fruit."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import lumps, pieces, solids
from vcage.objects.builders.mappings import around, tiled
from vcage.objects.builders.parts import BuiltObject, Part, paint, variant_rng
from vcage.objects.textures import foods, materials, skins

LEAF = (74, 124, 54)


def lemon(variant: str) -> BuiltObject:
    """A lemon of 0.077 m that lies along x on a small flat underside."""
    colour = {"ripe": (244, 206, 44), "unripe": (206, 202, 62)}[variant]
    return _citrus(variant_rng("lemon", variant), colour, (1.0, 1.0), mass=0.11)


def lime(variant: str) -> BuiltObject:
    """A lime: a smaller, rounder lemon with dark green peel."""
    colour = {"green": (88, 140, 44), "pale": (150, 184, 74)}[variant]
    return _citrus(variant_rng("lime", variant), colour, (0.84, 0.74), mass=0.07)


def _citrus(
    rng: np.random.Generator, colour: tuple[int, int, int], scale: tuple[float, float], mass: float
) -> BuiltObject:
    """A lying citrus fruit with a nipple to the right; ``scale`` is across and along, 1 for a lemon."""
    knots = [(0.0025, -0.0375), (0.0065, -0.0365), (0.0105, -0.0335), (0.0195, -0.0255), (0.0258, -0.009)]
    knots += [(0.0265, 0.003), (0.0225, 0.0175), (0.0145, 0.027), (0.0085, 0.0315), (0.0065, 0.0355), (0.002, 0.0375)]
    body = lumps.lobed(lumps.smooth(np.array(knots) * scale, 34), count=36)
    body = lumps.lying(solids.displaced(body, 0.0003, 0.012, rng), 0.001)
    height = float(body.bounds[1, 2])
    knob = solids.revolved([(0, 0), (0.0026, 0), (0.002, 0.0016), (0, 0.002)], 10)
    knob = solids.moved(knob, (float(body.bounds[0, 0]) + 0.0008, 0, height / 2), turn=-90, axis=(0, 1, 0))
    parts = [
        paint(body, foods.peel(rng, colour), tiled(0.05), roughness=0.42),
        paint(knob, materials.plastic(rng, (112, 124, 60)), tiled(0.05), roughness=0.8),
    ]
    return BuiltObject(parts, pieces.slabs(body, 3), mass=mass, friction=0.7)


def pear(variant: str) -> BuiltObject:
    """A pear of 0.066 m across that stands upright, with its stem."""
    rng = variant_rng("pear", variant)
    low, high, blush = {
        "green": ((150, 168, 56), (190, 200, 92), (186, 150, 60)),
        "yellow": ((222, 184, 66), (240, 212, 106), (214, 120, 54)),
        "red": ((150, 44, 38), (188, 82, 52), (206, 150, 70)),
    }[variant]
    knots = [
        (0.004, 0.002),
        (0.013, 0),
        (0.024, 0.006),
        (0.032, 0.021),
        (0.0325, 0.032),
        (0.028, 0.048),
        (0.0205, 0.062),
    ]
    knots += [(0.0165, 0.074), (0.013, 0.082), (0.0065, 0.0865), (0.0025, 0.0855)]
    body = solids.displaced(lumps.lobed(lumps.smooth(knots, 32), 5, 0.006, 36), 0.0004, 0.03, rng)
    body = solids.above(body, float(body.bounds[0, 2]) + 0.0004)
    parts = [
        paint(body, skins.pear_skin(rng, low, high, blush), around(), roughness=0.45),
        _stem([(0, 0, 0.083), (0.0006, 0, 0.088), (0.0025, 0, 0.093), (0.0055, 0, 0.0965)], 0.0017, (88, 62, 36), rng),
    ]
    stem = pieces.coarse(parts[1].vertices, 24)
    return BuiltObject(parts, [*pieces.slabs(body, 4, axis=2), stem], mass=0.17, friction=0.7)


def tomato(variant: str) -> BuiltObject:
    """A tomato of 0.066 m with its green calyx."""
    rng = variant_rng("tomato", variant)
    low, high = {"red": ((186, 24, 20), (214, 46, 28)), "yellow": ((232, 160, 36), (246, 190, 60))}[variant]
    knots = [
        (0.002, 0.0015),
        (0.009, 0),
        (0.021, 0.005),
        (0.031, 0.018),
        (0.0328, 0.027),
        (0.029, 0.04),
        (0.02, 0.0485),
    ]
    knots += [(0.012, 0.0505), (0.006, 0.049), (0.002, 0.047)]
    profile = lumps.smooth(knots, 28)
    groove = np.interp(profile[:, 1], [0, 0.02, 0.035, 0.05], [0.02, 0.012, 0.03, 0.07])
    body = lumps.lobed(profile, 5, groove, 50)
    leaves = [_sepal(2 * np.pi * (i + 0.2) / 6, 0.019, 0.0485) for i in range(6)]
    stem = _stem([(0, 0, 0.046), (0.0004, 0, 0.051), (0.0016, 0, 0.056), (0.004, 0, 0.06)], 0.0022, LEAF, rng)
    green = materials.plastic(rng, LEAF)
    parts = [paint(body, skins.glossy_skin(rng, low, high, (206, 118, 40)), around(), roughness=0.22), stem]
    parts += [paint(leaf, green, tiled(0.03), roughness=0.8) for leaf in leaves]
    calyx = pieces.coarse(np.concatenate([leaf.vertices for leaf in leaves]))
    hulls = [lumps.standing(body, 0.01), calyx, pieces.coarse(stem.vertices, 24)]
    return BuiltObject(parts, hulls, mass=0.12, friction=0.7)


def potato(variant: str) -> BuiltObject:
    """A potato of 0.085 m, lying along x."""
    rng = variant_rng("potato", variant)
    low, high = {
        "brown": ((160, 118, 68), (206, 166, 108)),
        "red": ((142, 66, 58), (180, 98, 82)),
        "yellow": ((196, 156, 82), (232, 198, 126)),
    }[variant]
    knots = [(0.002, -0.043), (0.013, -0.041), (0.025, -0.031), (0.029, -0.013), (0.0285, 0.008), (0.026, 0.024)]
    knots += [(0.02, 0.035), (0.011, 0.0405), (0.002, 0.042)]
    body = lumps.lobed(lumps.smooth(knots, 26), count=32)
    body.apply_scale((0.86, 1.0, 1.0))
    body = lumps.lying(solids.displaced(body, 0.0018, 0.05, rng), 0.002)
    part = paint(body, skins.potato_skin(rng, low, high), tiled(0.08), roughness=0.9)
    return BuiltObject([part], pieces.slabs(body, 3), mass=0.14, friction=0.8)


def carrot(variant: str) -> BuiltObject:
    """A carrot along x: green stubs to the left, the tip to the right."""
    rng = variant_rng("carrot", variant)
    low, high = {"orange": ((222, 104, 24), (244, 140, 48)), "purple": ((82, 34, 66), (120, 54, 92))}[variant]
    x = np.array([-0.058, -0.056, -0.051, -0.04, -0.01, 0.02, 0.05, 0.072, 0.084, 0.092])
    radius = np.array([0.004, 0.0105, 0.0155, 0.0175, 0.0165, 0.0142, 0.0108, 0.0072, 0.0045, 0.0012])
    shape = lumps.smooth(np.column_stack([radius, x]), 40)
    shape[:, 0] *= 1 + 0.018 * np.sin(shape[:, 1] * 900) * (shape[:, 1] > -0.05)
    body = lumps.lobed(shape, count=24)
    body = solids.moved(body, turn=90, axis=(0, 1, 0))
    body.vertices[:, 2] += np.interp(body.vertices[:, 0], shape[:, 1], shape[:, 0])  # all of it touches the table
    body = solids.above(body, 0.0008)
    skin = skins.carrot_skin(rng, low, high)
    parts = [paint(body, skin, around(0, (0.0, 0.013)), roughness=0.55)]
    stems = []
    for i, (y, z) in enumerate(((0, 0.5), (-0.6, 0.25), (0.6, 0.2), (-0.3, 0.75), (0.35, 0.8))):
        reach = 0.034 - 0.004 * (i % 3)
        path = [(-0.054, 0.004 * y, 0.0175 + 0.003 * (z - 0.5)), (-0.066, 0.008 * y, 0.0175 + 0.008 * (z - 0.4))]
        path += [(-0.058 - reach, 0.02 * y, 0.0155 + 0.016 * (z - 0.4))]
        stems.append(_stem(path, 0.0024, (84, 142, 56), rng, side=(0, 0, 1)))
    parts += stems
    tuft = pieces.coarse(np.concatenate([stem.vertices for stem in stems]))
    return BuiltObject(parts, [*pieces.slabs(body, 5), tuft], mass=0.09, friction=0.7)


def bell_pepper(variant: str) -> BuiltObject:
    """A bell pepper with four lobes, 0.068 m across, standing on them."""
    rng = variant_rng("bell_pepper", variant)
    low, high = {
        "red": ((178, 18, 22), (206, 34, 28)),
        "yellow": ((240, 182, 24), (252, 206, 48)),
        "green": ((52, 112, 40), (86, 148, 56)),
    }[variant]
    knots = [
        (0.002, 0.006),
        (0.008, 0.0035),
        (0.016, 0),
        (0.024, 0.003),
        (0.0285, 0.012),
        (0.032, 0.032),
        (0.034, 0.052),
    ]
    knots += [(0.032, 0.062), (0.025, 0.0685), (0.016, 0.0675), (0.009, 0.0625), (0.002, 0.061)]
    profile = lumps.smooth(knots, 34)
    body = lumps.lobed(profile, 4, np.interp(profile[:, 1], [0, 0.012, 0.05, 0.068], [0.16, 0.1, 0.09, 0.16]), 56)
    body = solids.above(solids.displaced(body, 0.0008, 0.05, rng), float(body.bounds[0, 2]) + 0.0008)
    calyx = solids.revolved([(0, 0.058), (0.011, 0.0615), (0.0125, 0.0645), (0.006, 0.0655), (0, 0.066)], 16)
    stem = _stem([(0, 0, 0.063), (0.0006, 0, 0.07), (0.002, 0, 0.078), (0.005, 0, 0.084)], 0.0042, LEAF, rng)
    parts = [
        paint(body, skins.glossy_skin(rng, low, high), around(), roughness=0.18),
        paint(calyx, materials.plastic(rng, LEAF), tiled(0.03), roughness=0.7),
        stem,
    ]
    hulls = [lumps.standing(body, 0.019), pieces.coarse(stem.vertices, 24)]
    return BuiltObject(parts, hulls, mass=0.15, friction=0.6)


def _stem(
    path: list[tuple[float, float, float]],
    radius: float,
    colour: tuple[int, int, int],
    rng: np.random.Generator,
    side: tuple[float, float, float] = (0, 1, 0),
) -> Part:
    """A stalk along a path, thicker at its cut end; ``side`` is any direction that the path never takes."""
    scales = np.linspace(0.85, 1.15, len(path))
    solid = solids.sweep(np.array(path), solids.circle(radius, 10), scales, up=side)
    return paint(solid, materials.plastic(rng, colour), tiled(0.05), roughness=0.85)


def _sepal(turn: float, reach: float, z: float) -> solids.Solid:
    """A pointed leaf from the z axis outwards that first hugs the fruit and then lifts its tip."""
    share = np.array([0.1, 0.35, 0.65, 1.0])
    rise = np.array([0.001, 0.0028, 0.0022, 0.0026])
    path = np.column_stack([np.cos(turn) * share * reach, np.sin(turn) * share * reach, z + rise])
    section = np.array([(-0.0032, 0), (0, -0.0008), (0.0032, 0), (0, 0.0008)])
    return solids.sweep(path, section, [0.7, 1.0, 0.75, 0.08])


BUILDERS = {
    "bell_pepper": bell_pepper,
    "carrot": carrot,
    "lemon": lemon,
    "lime": lime,
    "pear": pear,
    "potato": potato,
    "tomato": tomato,
}
