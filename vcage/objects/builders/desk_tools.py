"""Tools and things of a desk."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, solids
from vcage.objects.builders.mappings import from_above, tiled
from vcage.objects.builders.parts import BuiltObject, paint, variant_rng
from vcage.objects.textures import materials, prints


def book(variant: str) -> BuiltObject:
    """A hardcover that lies closed, spine to the left."""
    rng = variant_rng("book", variant)
    colour = {"blue": (38, 66, 122), "red": (140, 34, 38), "green": (44, 92, 66)}[variant]
    width, depth, height, board = 0.148, 0.205, 0.03, 0.003
    pages = solids.box((width - 0.008, depth - 0.008, height - 2 * board), (0, 0, board))
    covers = [solids.box((width, depth, board), (0, 0, z)) for z in (0, height - board)]
    spine = solids.box((board, depth, height), (-width / 2 + board / 2, 0, 0))
    front = materials.felt(rng, tuple(min(255, int(c * 1.15)) for c in colour), 256)
    front = prints.rectangle(front, (0.08, 0.06), (0.92, 0.07), (222, 190, 110))
    front = prints.rectangle(front, (0.08, 0.93), (0.92, 0.94), (222, 190, 110))
    title = {"blue": ("THE OPEN", "SEA"), "red": ("A SHORT", "HISTORY"), "green": ("FIELD", "GUIDE")}[variant]
    front = prints.text(front, title[0], (0.5, 0.3), 0.11, (240, 224, 180))
    front = prints.text(front, title[1], (0.5, 0.45), 0.11, (240, 224, 180))
    front = prints.disc(front, (0.5, 0.71), 0.07, (222, 190, 110))
    parts = [
        paint(pages, materials.page_edges(rng), tiled(0.03), roughness=0.95),
        paint(solids.union(*covers, spine), front, from_above(), roughness=0.7),
    ]
    return BuiltObject(parts, [solids.box((width, depth, height))], mass=0.5, friction=0.6)


def stapler(variant: str) -> BuiltObject:
    """A desk stapler along x, hinge to the right."""
    rng = variant_rng("stapler", variant)
    colour = {"black": (40, 40, 44), "red": (190, 36, 40)}[variant]
    base = solids.rounded_box((0.125, 0.038, 0.011), 0.005)
    outline = np.concatenate(
        [
            [(-0.06, 0.020), (0.02, 0.022), (0.054, 0.014)],
            solids.arc((0.048, 0.028), (0.012, 0.018), -50, 80, 7),
            solids.arc((-0.02, 0.030), (0.041, 0.0165), 90, 175, 7),
        ]
    )
    arm = solids.moved(solids.prism(outline, 0.026, -0.013), turn=90, axis=(1, 0, 0))
    hinge = solids.box((0.026, 0.03, 0.018), (0.044, 0, 0.006))
    rail = solids.box((0.098, 0.016, 0.007), (-0.0125, 0, 0.0165))
    anvil = solids.box((0.018, 0.02, 0.001), (-0.05, 0, 0.0106))
    pad = solids.rounded_box((0.05, 0.018, 0.003), 0.0012, (-0.005, 0, 0.0452))
    parts = [
        paint(solids.union(base, hinge), materials.plastic(rng, (58, 58, 62)), tiled(0.05), roughness=0.5),
        paint(arm, materials.plastic(rng, colour), tiled(0.05), roughness=0.3, crease=30),
        paint(pad, materials.felt(rng, (120, 122, 128)), tiled(0.03), roughness=0.8),
        paint(solids.union(rail, anvil), materials.brushed(rng), tiled(0.05), roughness=0.3, metallic=0.4),
    ]
    hulls = [base.convex_hull, arm.convex_hull, hinge, rail, pad.convex_hull]
    return BuiltObject(parts, hulls, mass=0.2, friction=0.7)


def calculator(variant: str) -> BuiltObject:
    """A pocket calculator with a raised display."""
    rng = variant_rng("calculator", variant)
    colour = {"grey": (70, 74, 82), "white": (226, 226, 222)}[variant]
    body = solids.rounded_box((0.064, 0.105, 0.017), 0.004)
    face = materials.plastic(rng, colour, 256)
    face = prints.rectangle(face, (0.1, 0.07), (0.9, 0.27), (28, 30, 34))
    face = prints.rectangle(face, (0.13, 0.09), (0.87, 0.25), (168, 186, 158))
    face = prints.text(face, "2026", (0.7, 0.17), 0.11, (40, 48, 40))
    keys = []
    for i, key in enumerate("789/456x123-0.=+"):
        x, y = -0.0225 + 0.015 * (i % 4), 0.018 - 0.0175 * (i // 4)
        ground = (226, 120, 40) if key in "/x-+=" else (236, 236, 232) if variant == "grey" else (90, 94, 100)
        ink = (250, 250, 250) if key in "/x-+=" or variant == "white" else (30, 30, 34)
        cap = prints.text(prints.canvas(48, 48, ground), key, (0.5, 0.5), 0.7, ink)
        keys.append(
            paint(solids.rounded_box((0.011, 0.012, 0.004), 0.0012, (x, y, 0.0155)), cap, from_above(), roughness=0.5)
        )
    hulls = [body.convex_hull, solids.box((0.058, 0.068, 0.0185), (0, -0.0085, 0.001))]
    return BuiltObject([paint(body, face, from_above(), roughness=0.5), *keys], hulls, mass=0.09, friction=0.6)


def remote_control(variant: str) -> BuiltObject:
    """A television remote control along y."""
    colour = {"black": (38, 38, 42), "white": (232, 232, 230)}[variant]
    body = solids.rounded_box((0.044, 0.15, 0.021), 0.007)
    ink = (200, 200, 204) if variant == "black" else (70, 72, 78)
    face = prints.canvas(192, 640, colour)
    face = prints.disc(face, (0.25, 0.075), 0.022, (214, 40, 44))
    for i in range(12):
        face = prints.disc(face, (0.25 + 0.25 * (i % 3), 0.17 + 0.065 * (i // 3)), 0.02, ink)
    face = prints.disc(face, (0.5, 0.56), 0.105, ink)
    face = prints.disc(face, (0.5, 0.56), 0.05, colour)
    for i, light in enumerate([(200, 50, 50), (60, 160, 80), (230, 200, 60), (60, 100, 200)]):
        face = prints.rectangle(face, (0.14 + 0.19 * i, 0.72), (0.28 + 0.19 * i, 0.74), light)
    for i in range(6):
        face = prints.disc(face, (0.25 + 0.25 * (i % 3), 0.81 + 0.06 * (i // 3)), 0.016, ink)
    return BuiltObject([paint(body, face, from_above(), roughness=0.45)], [pieces.coarse(body.vertices, 90)], 0.1, 0.7)


def pencil_cup(variant: str) -> BuiltObject:
    """An empty cup for pens, ribbed outside."""
    rng = variant_rng("pencil_cup", variant)
    radius, height, wall, floor = 0.0345, 0.09, 0.003, 0.005
    profile = [(0, 0), (radius - 0.001, 0), (radius, 0.002), (radius, height - 0.001), (radius - 0.001, height)]
    profile += [(radius - wall, height), (radius - wall, floor), (0, floor)]
    body = solids.revolved(profile, 44)
    if variant == "bamboo":
        part = paint(body, materials.wood(rng, materials.PINE), tiled(0.1, along=2), roughness=0.7)
    else:
        part = paint(body, materials.felt(rng, (70, 78, 92)), tiled(0.05), roughness=0.7)
    hulls = [pieces.stack([(radius, 0), (radius, floor)])]
    hulls += pieces.ring([(radius - wall, floor), (radius, floor), (radius, height), (radius - wall, height)])
    return BuiltObject([part], hulls, mass=0.12, friction=0.6)


def tape_roll(variant: str) -> BuiltObject:
    """A roll of packing tape that lies flat, with its cardboard core."""
    rng = variant_rng("tape_roll", variant)
    colour = {"brown": (176, 132, 78), "blue": (50, 110, 190)}[variant]
    outer, middle, inner, height = 0.0335, 0.0225, 0.0205, 0.024
    tape = solids.revolved([(middle, 0), (outer, 0), (outer, height), (middle, height)], 44)
    core = solids.revolved([(inner, 0), (middle, 0), (middle, height + 0.0004), (inner, height + 0.0004)], 44)
    windings = prints.canvas(256, 256, colour)
    for i in range(13):
        ring_colour = tuple(int(c * (0.86 if i % 2 else 1.0)) for c in colour)
        windings = prints.disc(windings, (0.5, 0.5), 0.5 - 0.0125 * i, ring_colour)
    parts = [
        paint(tape, windings, from_above(), roughness=0.3),
        paint(core, materials.cardboard(rng), tiled(0.1), roughness=0.9),
    ]
    return BuiltObject(
        parts, pieces.ring([(inner, 0), (outer, 0), (outer, height), (inner, height)]), mass=0.09, friction=0.7
    )


BUILDERS = {
    "book": book,
    "calculator": calculator,
    "pencil_cup": pencil_cup,
    "remote_control": remote_control,
    "stapler": stapler,
    "tape_roll": tape_roll,
}
