"""Cheese, cake and muffins."""

from __future__ import annotations

import itertools

import numpy as np

from vcage.objects.builders import lumps, pieces, solids
from vcage.objects.builders.mappings import around, tiled
from vcage.objects.builders.parts import BuiltObject, Part, paint, variant_rng
from vcage.objects.textures import foods, materials, skins

CAKE_LAYERS = (0.0, 0.014, 0.0185, 0.0325, 0.037, 0.048)
"""Heights between sponge and filling by turns, from the bottom up, metres."""

CREAM = ((0.001, 0.053), (0.0115, 0.053), (0.0125, 0.057), (0.009, 0.061), (0.0095, 0.0635), (0.004, 0.067), (0, 0.068))
"""Profile (radius, z) of the swirl of cream on a cake, metres."""

CREAM_AT = 0.022
"""Where the swirl is along the slice, metres from the middle of its length."""


def cheese_wedge(variant: str) -> BuiltObject:
    """A wedge of cheese, 0.105 m long and 0.045 m high: the tip to the left, the rind to the right."""
    rng = variant_rng("cheese_wedge", variant)
    colour, rind, veins = {
        "emmental": ((246, 206, 92), (214, 160, 60), None),
        "gouda": ((246, 190, 84), (184, 32, 30), None),
        "blue": ((240, 234, 212), (196, 184, 156), (74, 96, 116)),
    }[variant]
    outline = _wedge(0.1, 17.0)
    body = _bevelled(outline, 0.0, 0.045)
    if variant != "blue":
        body = solids.cut(body, *_holes(rng, small=variant == "gouda"))
    skin = solids.cut(
        solids.prism(_wedge(0.105, 17.0), 0.0447, 0.0001),
        solids.prism(_wedge(0.1, 17.6), 0.1, -0.01),
        solids.box((0.2, 0.2, 0.2), (-0.07, 0, -0.1)),
    )
    face, bubbles = _split_by_hull(body)
    parts = [
        paint(face, skins.cheese(rng, colour, veins), tiled(0.09), roughness=0.5),
        paint(skin, materials.plastic(rng, rind), tiled(0.05), roughness=0.35 if variant == "gouda" else 0.7),
    ]
    if len(bubbles.faces):
        shade = tuple(int(0.8 * c) for c in colour)
        parts.append(paint(bubbles, skins.cheese(rng, shade), tiled(0.09), roughness=0.6))
    return BuiltObject(parts, [body.convex_hull, pieces.coarse(skin.vertices)], mass=0.2, friction=0.8)


def cake_slice(variant: str) -> BuiltObject:
    """A slice of layer cake, 0.1 m long: the tip to the left, topped with cream and fruit."""
    rng = variant_rng("cake_slice", variant)
    sponge, cream, icing = {
        "strawberry": ((238, 200, 130), (252, 246, 236), (246, 168, 178)),
        "chocolate": ((92, 54, 34), (222, 190, 156), (62, 34, 22)),
        "lemon": ((246, 220, 130), (252, 248, 232), (250, 226, 110)),
    }[variant]
    inner, between, outer = _wedge(0.095, 17.0), _wedge(0.0952, 17.3), _wedge(0.0985, 17.15)
    crumb, filling, glaze = skins.sponge_cake(rng, sponge), materials.plastic(rng, cream), materials.plastic(rng, icing)
    heights = list(itertools.pairwise(CAKE_LAYERS))
    parts = [paint(solids.prism(inner, b - a, a), crumb, tiled(0.05), roughness=0.95) for a, b in heights[::2]]
    parts += [paint(solids.prism(between, b - a, a), filling, tiled(0.05), roughness=0.5) for a, b in heights[1::2]]
    top = _bevelled(outer, CAKE_LAYERS[-1] - 0.0005, 0.054)
    back = solids.cut(solids.prism(outer, CAKE_LAYERS[-1]), solids.prism(inner * (1, 1.2), 0.1, -0.01))
    parts += [paint(coat, glaze, tiled(0.06), roughness=0.3) for coat in (top, back)]
    swirl = solids.moved(lumps.lobed(CREAM, 7, 0.16, 42), (CREAM_AT, 0, 0))
    crown = [paint(swirl, filling, tiled(0.04), roughness=0.6), _topping(variant, rng)]
    slab = pieces.hull(*(np.column_stack([outer, np.full(len(outer), z)]) for z in (0.0, 0.0535)))
    hulls = [slab, pieces.coarse(np.concatenate([part.vertices for part in crown]))]
    return BuiltObject([*parts, *crown], hulls, mass=0.13, friction=0.8)


def muffin(variant: str) -> BuiltObject:
    """A muffin in a pleated paper case, 0.066 m across and 0.06 m high."""
    rng = variant_rng("muffin", variant)
    dough, bits, paper = {
        "blueberry": ((226, 172, 98), (48, 42, 96), (236, 226, 200)),
        "chocolate": ((98, 60, 36), (44, 24, 16), (176, 128, 84)),
        "vanilla": ((236, 194, 122), (214, 66, 76), (150, 196, 206)),
    }[variant]
    case = lumps.lobed(
        [(0.001, 0), (0.0225, 0), (0.0235, 0.001), (0.0292, 0.0345), (0.0285, 0.035), (0.001, 0.034)],
        24,
        [0, 0.03, 0.05, 0.06, 0.06, 0],
        96,
    )
    knots = [
        (0.001, 0.031),
        (0.026, 0.0315),
        (0.0325, 0.036),
        (0.033, 0.041),
        (0.0275, 0.051),
        (0.018, 0.0575),
        (0.001, 0.0605),
    ]
    top = solids.displaced(lumps.lobed(lumps.smooth(knots, 22), count=40), 0.0011, 0.022, rng)
    crust = skins.muffin_top(rng, dough, bits)
    parts = [
        paint(case, skins.pleated(rng, paper), around(), roughness=0.9, crease=15),
        paint(top, crust, lumps.over_dome((0, 0, 0.03), 95.0), roughness=0.75),
    ]
    hulls = [pieces.stack([(0.0228, 0), (0.0235, 0.001), (0.0288, 0.0345)]), pieces.coarse(top.vertices, 90)]
    return BuiltObject(parts, hulls, mass=0.09, friction=0.8)


def _wedge(length: float, half_angle: float) -> np.ndarray:
    """Outline (n, 2), counter-clockwise: a slice of a round with its tip on the left at x = -0.05."""
    rim = solids.arc((-0.05, 0), length, -half_angle, half_angle, 12)
    return np.concatenate([[(-0.05, 0.0)], rim])


def _bevelled(outline: np.ndarray, low: float, high: float, bevel: float = 0.0015) -> solids.Solid:
    """A prism over an outline with a bevelled upper edge."""
    middle = outline.mean(axis=0)
    inset = middle + (outline - middle) * (1 - bevel / np.linalg.norm(outline - middle, axis=1).min())
    levels = ((outline, low), (outline, high - bevel), (inset, high))
    return solids.closed_rings([np.column_stack([o, np.full(len(o), z)]) for o, z in levels])


def _split_by_hull(body: solids.Solid) -> tuple[solids.Solid, solids.Solid]:
    """The faces on a body's convex hull, and those in its hollows."""
    hull = body.convex_hull
    depth = (body.triangles_center @ hull.face_normals.T - (hull.triangles_center * hull.face_normals).sum(axis=1)).max(
        axis=1
    )
    outside, inside = body.copy(), body.copy()
    outside.update_faces(depth > -1e-5)
    inside.update_faces(depth <= -1e-5)
    return outside, inside


def _holes(rng: np.random.Generator, small: bool) -> list[solids.Solid]:
    """Bubbles in the two cut sides and the top of a wedge."""
    out = []
    for i in range(18 if small else 24):
        radius = rng.uniform(0.0012, 0.0024) if small else rng.uniform(0.003, 0.0065)
        along, up = rng.uniform(0.025, 0.09), rng.uniform(0.008, 0.038)
        side = np.tan(np.radians(17.0)) * along
        place = [
            (-0.05 + along, side, up),
            (-0.05 + along, -side, up),
            (-0.05 + along, rng.uniform(-0.6, 0.6) * side, 0.045),
        ]
        flat = 0.75 if not small else 0.9
        out.append(solids.ellipsoid((radius, radius * flat, radius * 0.9), np.array(place[i % 3]), 14))
    return out


def _topping(variant: str, rng: np.random.Generator) -> Part:
    """What lies on the cream: a strawberry, a piece of chocolate, or a slice of lemon."""
    if variant == "strawberry":
        knots = [(0.0005, 0.0), (0.006, 0.0005), (0.0085, 0.004), (0.0075, 0.01), (0.004, 0.0155), (0.0005, 0.0175)]
        berry = solids.moved(lumps.lobed(lumps.smooth(knots, 14), count=20), (CREAM_AT, 0, 0.061))
        return paint(berry, foods.peel(rng, (204, 28, 40)), tiled(0.03), roughness=0.3)
    if variant == "chocolate":
        flake = solids.moved(solids.rounded_box((0.016, 0.004, 0.018), 0.0012), turn=20, axis=(0, 1, 0))
        flake = solids.moved(flake, (CREAM_AT, 0, 0.059))
        return paint(flake, materials.plastic(rng, (58, 32, 22)), tiled(0.03), roughness=0.4)
    rind = [(0, -0.0016), (0.0098, -0.0016), (0.0105, 0), (0.0098, 0.0016), (0, 0.0016)]
    slice_ = solids.moved(solids.revolved(rind, 28), (CREAM_AT, 0, 0.069), turn=90, axis=(1, 0, 0))
    return paint(slice_, materials.plastic(rng, (246, 212, 52)), tiled(0.03), roughness=0.3)


BUILDERS = {"cake_slice": cake_slice, "cheese_wedge": cheese_wedge, "muffin": muffin}
