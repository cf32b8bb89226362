"""Breads and pastries: lumpy things with painted crusts."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import lumps, pieces, solids
from vcage.objects.builders.mappings import along, around, from_above, tiled
from vcage.objects.builders.parts import BuiltObject, Mapping, paint, variant_rng
from vcage.objects.textures import foods


def baguette_piece(variant: str) -> BuiltObject:
    """The end of a baguette along x: the right end round, the left one cut."""
    rng = variant_rng("baguette_piece", variant)
    x = np.concatenate([np.linspace(-0.065, 0.03, 14), 0.03 + 0.035 * np.sin(np.linspace(0.12, 1, 9) * np.pi / 2)])
    round_end = np.sqrt(np.clip(1 - ((x - 0.03) / 0.0352).clip(0) ** 2, 0.004, 1))
    half_width, half_height = 0.026, 0.023
    angle = np.arange(28) * 2 * np.pi / 28
    section = np.stack(
        [np.cos(angle) * half_width, np.maximum(np.sin(angle) * half_height, -0.7 * half_height)], axis=1
    )
    path = np.stack([x, np.zeros_like(x), 0.7 * half_height * round_end], axis=1)
    loaf = solids.displaced(solids.sweep(path, section, round_end), 0.0006, 0.02, rng)
    loaf = solids.above(loaf, 0.0008)
    slice_ = solids.prism(section * 0.95 + (0, 0.7 * half_height), 0.0012)
    slice_ = solids.moved(slice_, (-0.066, 0, 0), turn=120, axis=(1, 1, 1))
    parts = [
        paint(
            loaf, foods.baguette_crust(rng, dark=variant == "dark"), around(0, (0.0, 0.016)), roughness=0.8, crease=60
        ),
        paint(slice_, foods.crumb(rng), tiled(0.05), roughness=0.95),
    ]
    return BuiltObject(parts, [*pieces.slabs(loaf, 3), slice_.convex_hull], mass=0.09, friction=0.8)


def croissant(variant: str) -> BuiltObject:
    """A crescent of rolled dough, tips towards the front."""
    rng = variant_rng("croissant", variant)
    turn = np.radians(np.linspace(12, 168, 45))
    share = np.linspace(-1, 1, 45)
    envelope = 0.30 + 0.70 * np.cos(share * np.pi / 2) ** 0.8
    steps = np.abs(share) * 4.2
    ridges = 1 - 0.13 * (steps - np.floor(steps)) * (np.abs(share) < 0.97)
    scale = envelope * ridges
    scale[[0, -1]] *= 0.35
    half_height = 0.021
    angle = np.arange(24) * 2 * np.pi / 24
    section = np.stack([np.cos(angle) * 0.024, np.maximum(np.sin(angle) * half_height, -0.75 * half_height)], axis=1)
    path = np.stack([0.058 * np.cos(turn), 0.052 * np.sin(turn), 0.75 * half_height * scale], axis=1)
    roll = solids.sweep(path, section, scale)
    crust = foods.croissant_crust(rng, dark=variant == "dark")
    part = paint(roll, crust, along(path), roughness=0.42, crease=50)
    rings = [_ring_of(roll, i, 24) for i in (0, 1, 6, 11, 16, 22, 28, 33, 38, 43, 44)]
    return BuiltObject([part], pieces.chain(rings), mass=0.06, friction=0.8)


def bread_roll(variant: str) -> BuiltObject:
    """A round floured roll of 0.066 m with a deep cross cut into its top."""
    rng = variant_rng("bread_roll", variant)
    middle = 0.0165
    lump = solids.displaced(solids.ellipsoid((0.0325, 0.0325, 0.0245), (0, 0, middle), 40), 0.0007, 0.03, rng)
    lump = solids.above(lump, 0.0)
    crumb = solids.moved(lump, (0, 0, -middle))
    crumb.apply_scale(0.89)
    crumb = solids.moved(crumb, (0, 0, middle))
    cuts = [solids.moved(solids.box((0.05, 0.0055, 0.05), (0, 0, 0.022)), turn=turn) for turn in (45, 135)]
    parts = [
        paint(
            solids.cut(lump, *cuts),
            foods.roll_crust(rng, seeds=variant == "poppy"),
            lumps.over_dome((0, 0, 0.012)),
            roughness=0.9,
        ),
        paint(crumb, foods.crumb(rng), tiled(0.06), roughness=0.95),
    ]
    return BuiltObject(parts, [pieces.coarse(lump.vertices)], mass=0.055, friction=0.8)


def toast_slice(variant: str) -> BuiltObject:
    """A thick slice of a small tin loaf, lying on its cut face."""
    rng = variant_rng("toast_slice", variant)
    outline = np.concatenate(
        [
            [(-0.029, -0.034), (0.029, -0.034), (0.030, -0.030), (0.030, 0.010)],
            solids.arc((0.018, 0.020), 0.0145, -20, 80, 6),
            solids.arc((-0.018, 0.020), 0.0145, 100, 200, 6),
            [(-0.030, 0.010), (-0.030, -0.030)],
        ]
    )
    height = 0.018
    crumb = solids.prism(outline * 0.93, height + 0.0008, -0.0004)
    crust = solids.prism(outline, height)
    parts = [
        paint(crust, foods.plain_crust(rng), tiled(0.06), roughness=0.85),
        paint(crumb, foods.crumb(rng, toasted=variant == "toasted"), from_above(), roughness=0.95),
    ]
    top = [(x, y, z) for x, y in outline for z in (-0.0004, height + 0.0004)]
    return BuiltObject(parts, [pieces.hull(top)], mass=0.03, friction=0.8)


def bagel(variant: str) -> BuiltObject:
    """A shiny brown ring of bread with a wide hole, perhaps with sesame seeds."""
    rng = variant_rng("bagel", variant)
    outer, tube = 0.0345, (0.0105, 0.0125)
    crust = foods.bagel_crust(rng, seeds=variant == "sesame")
    mapping = lumps.over_ring(outer - tube[0], 0.85 * tube[1])
    return _ring_pastry([(crust, 0.32, 0.0)], rng, outer, tube, mapping)


def donut(variant: str) -> BuiltObject:
    """A doughnut with icing and sprinkles."""
    rng = variant_rng("donut", variant)
    icing = {"pink": (240, 140, 170), "chocolate": (78, 44, 28)}[variant]
    dough = foods.plain_crust(rng, (214, 158, 92))
    return _ring_pastry(
        [(dough, 0.8, 0.0), (foods.sprinkles(rng, icing), 0.25, 0.0165)], rng, outer=0.032, tube=(0.0118, 0.0125)
    )


def _ring_pastry(
    coats: list[tuple[np.ndarray, float, float]],
    rng: np.random.Generator,
    outer: float,
    tube: tuple[float, float],
    mapping: Mapping | None = None,
) -> BuiltObject:
    """A torus with a flat bottom; each further coat (texture, roughness, from height) is a skin over the top."""
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


def _ring_of(swept: solids.Solid, index: int, count: int) -> np.ndarray:
    """Every other point of a section of a swept solid."""
    return np.asarray(swept.vertices)[index * count : (index + 1) * count : 2]


BUILDERS = {
    "bagel": bagel,
    "baguette_piece": baguette_piece,
    "bread_roll": bread_roll,
    "croissant": croissant,
    "donut": donut,
    "toast_slice": toast_slice,
}
