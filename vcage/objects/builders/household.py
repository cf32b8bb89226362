"""Things that are kept in a cabinet: light, batteries, first aid, and a tray for small parts."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, shells, solids
from vcage.objects.builders.mappings import from_above, six_sides, tiled
from vcage.objects.builders.parts import BuiltObject, Part, paint, variant_rng
from vcage.objects.textures import materials, packaging, prints


def flashlight(variant: str) -> BuiltObject:
    """A metal torch that stands on its lamp."""
    rng = variant_rng("flashlight", variant)
    colour = {"black": (48, 50, 54), "silver": (188, 192, 198), "red": (176, 34, 38)}[variant]
    head = [(0, 0.001), (0.019, 0.001), (0.019, 0), (0.0225, 0), (0.0225, 0.004), (0.0218, 0.005), (0.0218, 0.026)]
    head += [(0.016, 0.041), (0, 0.041)]
    barrel = solids.revolved([(0, 0.04), (0.0145, 0.04), (0.0145, 0.112), (0, 0.112)], 36)
    rings = [solids.revolved(_washer(0.0158, z, 0.004), 36) for z in (0.043, 0.112)]
    tail = [(0, 0.112), (0.015, 0.112), (0.015, 0.131), (0.0135, 0.133), (0, 0.133)]
    knob = solids.revolved([(0, 0.1325), (0.0075, 0.1325), (0.0075, 0.1348), (0.006, 0.136), (0, 0.136)], 24)
    switch = solids.rounded_box((0.009, 0.004, 0.018), 0.0018, (0, -0.0145, 0.054))
    shade = tuple(int(0.8 * c) for c in colour)
    metal = materials.brushed(rng, colour)
    parts = [
        paint(solids.revolved(head, 40), metal, tiled(0.05, along=2), roughness=0.35, metallic=0.4),
        paint(barrel, packaging.knurled(rng, colour), tiled(0.03), roughness=0.45, metallic=0.3),
        paint(
            solids.union(*rings, solids.revolved(tail, 36)),
            materials.brushed(rng, shade),
            tiled(0.05),
            roughness=0.35,
            metallic=0.4,
        ),
        paint(knob, materials.plastic(rng, (214, 120, 30)), tiled(0.05), roughness=0.7),
        paint(switch, materials.plastic(rng, (214, 120, 30)), tiled(0.05), roughness=0.7),
    ]
    hulls = [
        pieces.stack([(0.0225, 0), (0.0225, 0.005), (0.0218, 0.026), (0.016, 0.041)]),
        pieces.stack([(0.015, 0.04), (0.0155, 0.1165), (0.015, 0.132)]),
        pieces.stack([(0.0075, 0.1315), (0.0075, 0.1348), (0.006, 0.136)], 12),
        switch.convex_hull,
    ]
    return BuiltObject(parts, hulls, mass=0.16, friction=0.7)


def _washer(radius: float, z: float, height: float) -> list[tuple[float, float]]:
    return [(0, z), (radius, z), (radius, z + height), (0, z + height)]


def battery_pack(variant: str) -> BuiltObject:
    """Eight upright batteries of size AA in a printed sleeve."""
    rng = variant_rng("battery_pack", variant)
    top, ground, words = {
        "copper": ((196, 118, 58), (30, 30, 34), "VOLTRA"),
        "green": ((84, 170, 84), (246, 246, 244), "ECOCELL"),
    }[variant]
    radius, height = 0.00725, 0.0485
    cells, nipples = [], []
    for column in range(4):
        for row in range(2):
            at = ((column - 1.5) * 2 * radius, (row - 0.5) * 2 * radius, 0)
            profile = [(0, 0), (radius - 0.0006, 0), (radius, 0.0006), (radius, height - 0.0008)]
            cells.append(solids.moved(solids.revolved([*profile, (radius - 0.001, height), (0, height)], 20), at))
            nub = [(0, height - 0.0004), (0.0027, height - 0.0004), (0.0027, height + 0.0015), (0, height + 0.0015)]
            nipples.append(solids.moved(solids.revolved(nub, 14), at))
    size = (8 * radius + 0.0008, 4 * radius + 0.0008)
    sleeve = solids.prism(solids.rounded_rectangle(size, radius * 0.95, 5), 0.03, 0.004)
    ink = top if variant == "copper" else (34, 110, 50)
    front = packaging.label((384, 192), ground, [(words, 0.34, 0.8, 0.28, ink)], [(0.84, 1.0, top)], (0.5,))
    front = packaging.fitted(front, "AA  x8  alkaline", (0.5, 0.66), (0.6, 0.15), ink)
    side = packaging.label((192, 192), ground, [("AA", 0.4, 0.6, 0.3, ink)], [(0.84, 1.0, top)], (0.5,))
    picture = prints.atlas({"front": front, "back": front, "left": side, "right": side}, ground, (384, 192))
    parts = [
        paint(solids.union(*cells), materials.brushed(rng, top), tiled(0.05), roughness=0.3, metallic=0.4),
        paint(solids.union(*nipples), materials.brushed(rng), tiled(0.05), roughness=0.25, metallic=0.5),
        paint(sleeve, picture, six_sides(), roughness=0.4),
    ]
    outline = solids.rounded_rectangle(size, radius * 0.95, 3)
    hulls = [shells.levelled_hull(np.repeat(outline, 2, axis=0), [(0, 0.985), (0.004, 1.0), (height + 0.0008, 0.985)])]
    return BuiltObject(parts, hulls, mass=0.19, friction=0.6)


def light_bulb_box(variant: str) -> BuiltObject:
    """The carton of one light bulb, standing upright."""
    ground, glow, words = {
        "warm": ((36, 50, 92), (252, 212, 90), "WARM WHITE"),
        "daylight": ((40, 130, 190), (246, 250, 252), "DAYLIGHT"),
    }[variant]
    size = (0.06, 0.06, 0.108)
    face = packaging.light_bulb(prints.canvas(224, 400, ground), (0.5, 0.38), 0.44, glow)
    face = packaging.fitted(face, "BRIGHTON", (0.5, 0.08), (0.8, 0.06), (252, 252, 250))
    face = packaging.fitted(face, words, (0.5, 0.72), (0.8, 0.05), glow)
    face = packaging.fitted(face, "LED 9 W", (0.5, 0.82), (0.6, 0.07), (252, 252, 250))
    face = packaging.fitted(face, "= 60 W", (0.5, 0.92), (0.4, 0.05), (252, 252, 250))
    top = packaging.light_bulb(prints.canvas(224, 224, ground), (0.5, 0.54), 0.66, glow)
    sides = dict.fromkeys(("front", "back", "left", "right"), face) | {"top": top}
    box = solids.rounded_box(size, 0.0012, steps=2)
    part = paint(box, prints.atlas(sides, ground, (224, 400)), six_sides(), roughness=0.6)
    return BuiltObject([part], [solids.box(size)], mass=0.09, friction=0.6)


def first_aid_kit(variant: str) -> BuiltObject:
    """A small first-aid case that stands upright, with a cross on its front and a handle on top."""
    rng = variant_rng("first_aid_kit", variant)
    ground, mark = {"red": ((196, 30, 34), (250, 250, 248)), "white": ((244, 244, 240), (200, 30, 36))}[variant]
    size = (0.15, 0.06, 0.1)
    case = solids.rounded_box(size, 0.008, steps=4)
    face = packaging.cross(prints.canvas(480, 320, ground), (0.5, 0.46), 0.3, mark)
    face = packaging.fitted(face, "FIRST AID", (0.5, 0.87), (0.5, 0.09), mark)
    seam = tuple(int(0.7 * c) for c in ground)
    top = prints.rectangle(prints.canvas(480, 320, ground), (0, 0.47), (1, 0.53), seam)
    side = prints.rectangle(prints.canvas(480, 320, ground), (0.46, 0), (0.54, 1), seam)
    picture = prints.atlas({"front": face, "back": face, "top": top, "left": side, "right": side}, ground, (480, 320))
    rise = np.array([(-0.034, 0), (-0.032, 0.01), (-0.024, 0.015), (0.024, 0.015), (0.032, 0.01), (0.034, 0)])
    path = np.column_stack([rise[:, 0], np.zeros(6), rise[:, 1] + size[2] - 0.002])
    grip = solids.sweep(path, solids.circle(1.0, 14) * (0.005, 0.007), up=(0, 1, 0))
    latches = [solids.rounded_box((0.016, 0.006, 0.02), 0.002, (x, -0.028, 0.078)) for x in (-0.05, 0.05)]
    clasp = (60, 62, 68) if variant == "white" else (226, 226, 224)
    parts = [
        paint(case, picture, six_sides(), roughness=0.5),
        paint(grip, materials.plastic(rng, (46, 48, 52)), tiled(0.05), roughness=0.6),
        paint(solids.union(*latches), materials.plastic(rng, clasp), tiled(0.05), roughness=0.4),
    ]
    rings = grip.vertices[:-2].reshape(6, 14, 3)
    hulls = [solids.rounded_box(size, 0.008, steps=2), *pieces.chain(list(rings)), *[x.convex_hull for x in latches]]
    return BuiltObject(parts, hulls, mass=0.26, friction=0.7)


def toolbox_tray(variant: str) -> BuiltObject:
    """A carrier with two open compartments and a grip above the wall between them."""
    rng = variant_rng("toolbox_tray", variant)
    colour = {"red": (190, 40, 40), "grey": (98, 106, 116), "yellow": (238, 186, 40)}[variant]
    length, room, wall, middle, floor, rim = 0.19, 0.068, 0.005, 0.014, 0.005, 0.04
    inner = (length, 2 * room + middle)
    shell, hulls = shells.open_box(inner, wall, floor, rim, 0.008)
    top, reach = 0.088, 0.05
    divider = solids.box((length, middle, rim - floor), (0, 0, floor))
    posts = [
        pieces.hull(
            [(side * x, y, rim) for x in (reach - 0.012, length / 2) for y in (-middle / 2, middle / 2)],
            [(side * x, y, top) for x in (reach - 0.012, reach + 0.006) for y in (-middle / 2, middle / 2)],
        )
        for side in (-1, 1)
    ]
    grip = solids.rounded_box((2 * reach - 0.01, 0.0155, 0.018), 0.005, (0, 0, top - 0.018), steps=4)
    parts = [
        paint(solids.union(shell, divider, *posts), materials.plastic(rng, colour), tiled(0.1), roughness=0.5),
        paint(grip, materials.felt(rng, (44, 46, 50)), tiled(0.03), roughness=0.8),
        _mats((length - 0.002, room - 0.002), (room + middle) / 2, floor, rng),
    ]
    return BuiltObject(parts, [*hulls, divider, *posts, grip.convex_hull], mass=0.4, friction=0.7)


def _mats(size: tuple[float, float], offset: float, floor: float, rng: np.random.Generator) -> Part:
    """Rubber mats, 0.4 mm thick, on the floors of the front and the back compartment."""
    mats = [solids.box((*size, 0.0004), (0, side * offset, floor - 0.0001)) for side in (-1, 1)]
    return paint(solids.union(*mats), packaging.knurled(rng, (64, 66, 70), cells=24), from_above(), roughness=0.9)


BUILDERS = {
    "battery_pack": battery_pack,
    "first_aid_kit": first_aid_kit,
    "flashlight": flashlight,
    "light_bulb_box": light_bulb_box,
    "toolbox_tray": toolbox_tray,
}
