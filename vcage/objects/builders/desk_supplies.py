"""Paper things and small machines of a desk."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, shells, solids
from vcage.objects.builders.mappings import from_above, six_sides, tiled
from vcage.objects.builders.parts import BuiltObject, paint, variant_rng
from vcage.objects.textures import materials, packaging, prints

INK = (44, 46, 52)


def notepad(variant: str) -> BuiltObject:
    """A thick pad bound with a spiral at its far edge, lying flat."""
    rng = variant_rng("notepad", variant)
    colour = {"yellow": (248, 224, 120), "white": (250, 249, 242), "kraft": (188, 146, 98)}[variant]
    width, depth, height = 0.066, 0.1, 0.024
    block = solids.box((width - 0.001, depth - 0.001, height - 0.0035), (0, 0, 0.002))
    back = solids.prism(solids.rounded_rectangle((width, depth), 0.004), 0.0022)
    sheet = solids.prism(solids.rounded_rectangle((width, depth), 0.003), 0.0018, height - 0.0018)
    if variant == "kraft":
        page = packaging.fitted(materials.cardboard(rng, colour), "NOTES", (0.5, 0.42), (0.5, 0.12), (66, 46, 30))
        page = packaging.stroke(page, [(0.25, 0.54), (0.75, 0.54)], 0.012, (66, 46, 30))
    else:
        page = packaging.ruled(12, colour)
    for x in np.linspace(0.07, 0.93, 12):
        page = prints.disc(page, (x, 0.055), 0.016, (52, 52, 56))
    bend = np.radians(np.arange(10) * 36.0)
    rings = []
    for x in np.linspace(0.07, 0.93, 12) * width - width / 2:
        outline = np.stack([height / 2 + np.cos(bend) * (height / 2 + 0.0012), np.sin(bend) * 0.0065], axis=1)
        hole = np.stack([height / 2 + np.cos(bend) * (height / 2), np.sin(bend) * 0.0054], axis=1)
        wire = solids.cut(_plate_yz(outline, 0.0012), _plate_yz(hole, 0.01))
        rings.append(solids.moved(wire, (x, depth / 2 - 0.0025, 0)))
    wires = solids.above(solids.union(*rings), 0.0)
    board = materials.cardboard(rng, (150, 118, 82))
    parts = [
        paint(
            block, materials.page_edges(rng, (244, 238, 214) if variant == "yellow" else (240, 238, 230)), tiled(0.03)
        ),
        paint(back, board, tiled(0.1), roughness=0.9),
        paint(sheet, page, from_above(), roughness=0.9),
        paint(wires, materials.brushed(rng, (96, 98, 104)), tiled(0.05), roughness=0.3, metallic=0.4),
    ]
    spine = solids.box((0.86 * width + 0.0012, 0.0092, height + 0.001), (0, depth / 2 - 0.0006, 0))
    return BuiltObject(parts, [solids.box((width, depth, height)), spine], mass=0.15, friction=0.7)


def _plate_yz(outline: np.ndarray, width: float) -> solids.Solid:
    """A plate across x whose outline is given as (z, y)."""
    return shells.across(outline[::-1, ::-1], width)


def desk_calendar(variant: str) -> BuiltObject:
    """A tent of card with a month on its front and wire rings along the ridge."""
    rng = variant_rng("desk_calendar", variant)
    accent, month, first, days = {
        "blue": ((36, 92, 168), "JUNE", 0, 30),
        "red": ((196, 42, 46), "MARCH", 6, 31),
        "green": ((46, 128, 84), "SEPTEMBER", 1, 30),
    }[variant]
    width, half, tall, card = 0.15, 0.034, 0.118, 0.0022
    page = packaging.calendar_page(month, first, days, accent)
    plates, sheets = [], []
    for sign in (-1, 1):
        foot, ridge = np.array([sign * half, 0.0]), np.array([sign * 0.0012, tall])
        along = (ridge - foot) / np.linalg.norm(ridge - foot)
        away = sign * np.array([along[1], -along[0]])  # out of the plate
        plates.append(_upright([foot - (sign * card, 0), ridge - (sign * card, 0), ridge, foot], width))
        low, high = foot + 0.008 * along, ridge - 0.011 * along
        block = [low - 0.0004 * away, low + 0.0012 * away, high + 0.0012 * away, high - 0.0004 * away]
        sheets.append(_upright(block, width - 0.006))
    hulls = [*plates, *sheets]
    base = solids.box((width, 2 * half - 0.002, card))
    angle = np.arange(10) * 2 * np.pi / 10
    loops = []
    for x in np.linspace(-0.062, 0.062, 14):
        ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        loop = solids.cut(shells.across(ring * 0.0072, 0.0014), shells.across(ring * 0.0058, 0.01))
        loops.append(solids.moved(loop, (x, 0, tall - 0.003)))
    hulls += [base, solids.box((0.1254, 0.011, 0.013), (0, 0, tall - 0.0095))]
    stand = materials.plastic(rng, tuple(int(0.75 * c) for c in accent))
    parts = [
        paint(solids.union(*plates, base), stand, tiled(0.1), roughness=0.7),
        *[
            paint(sheet, prints.atlas({"front": page, "back": page}, (250, 249, 245), (448, 352)), six_sides())
            for sheet in sheets
        ],
        paint(solids.union(*loops), materials.brushed(rng, (70, 72, 76)), tiled(0.05), roughness=0.3, metallic=0.4),
    ]
    return BuiltObject(parts, hulls, mass=0.14, friction=0.7)


def _upright(corners: list[np.ndarray], width: float) -> solids.Solid:
    """A prism across x through corners (y, z) of a convex polygon in any sense."""
    outline = np.array(corners)
    return pieces.hull(*[np.column_stack([np.full(len(outline), x), outline]) for x in (-width / 2, width / 2)])


def hole_punch(variant: str) -> BuiltObject:
    """A two-hole punch with a broad lever that rises towards the front."""
    rng = variant_rng("hole_punch", variant)
    colour = {"black": (44, 44, 48), "red": (186, 34, 38), "blue": (34, 84, 160)}[variant]
    width = 0.1
    base = solids.rounded_box((width + 0.006, 0.088, 0.012), 0.004, steps=3)
    column = solids.box((width - 0.012, 0.024, 0.02), (0, 0.02, 0.01))
    profile = [(-0.034, 0.044), (-0.028, 0.04), (0.034, 0.022), (0.038, 0.027), (0.032, 0.04), (0.012, 0.051)]
    profile += [(-0.026, 0.056), (-0.034, 0.053)]
    lever = shells.across(profile, width)
    pins = [
        solids.moved(solids.revolved([(0, 0.0115), (0.0045, 0.0115), (0.0045, 0.036), (0, 0.036)], 20), (x, 0.0, 0))
        for x in (-0.04, 0.04)
    ]
    scale = solids.box((width + 0.007, 0.007, 0.0012), (0, -0.03, 0.0115))
    marks = packaging.striped([(228, 228, 224), (70, 70, 74)], 42)
    pad = shells.across(
        [(-0.03, 0.053), (0.006, 0.051), (0.006, 0.0535), (-0.0255, 0.0568), (-0.03, 0.0556)], width - 0.016
    )
    parts = [
        paint(solids.union(base, column), materials.plastic(rng, (60, 60, 64)), tiled(0.05), roughness=0.6),
        paint(lever, materials.plastic(rng, colour), tiled(0.05), roughness=0.3, crease=25),
        paint(pad, materials.plastic(rng, tuple(int(0.6 * c + 12) for c in colour)), tiled(0.05), roughness=0.7),
        paint(scale, marks, from_above(), roughness=0.5),
        paint(solids.union(*pins), materials.brushed(rng), tiled(0.05), roughness=0.25, metallic=0.5),
    ]
    hulls = [base.convex_hull, column, lever.convex_hull, pad.convex_hull, *[pin.convex_hull for pin in pins], scale]
    return BuiltObject(parts, hulls, mass=0.35, friction=0.7)


def paper_clip_box(variant: str) -> BuiltObject:
    """A small clear box, full of paper clips."""
    rng = variant_rng("paper_clip_box", variant)
    metals = {
        "silver": [(206, 208, 212), (176, 180, 186), (228, 230, 232)],
        "coloured": [(214, 44, 48), (40, 110, 200), (246, 200, 40), (60, 160, 80), (240, 240, 240), (230, 110, 40)],
    }[variant]
    size, wall, fill = (0.084, 0.058, 0.032), 0.0022, 0.026
    shell, _ = shells.open_box((size[0] - 2 * wall, size[1] - 2 * wall), wall, 0.002, size[2], 0.004)
    clips = packaging.paper_clips(rng, metals)
    heap = np.linspace(-1, 1, 9)
    rows = []
    for v in heap:
        bulge = 0.0045 * (1 - heap**2) * (1 - v**2)
        rows.append(np.column_stack([heap * (size[0] / 2 - wall), np.full(9, v * (size[1] / 2 - wall)), fill + bulge]))
    top = np.concatenate(rows)
    mound = pieces.hull(top, top * (1, 1, 0) + (0, 0, fill - 0.004))
    wires = _loose_clips(rng, fill)
    tone = (0.4 * clips + 0.6 * np.array([216, 226, 236])).astype(np.uint8)
    front = packaging.fitted(
        prints.rectangle(tone, (0.12, 0.24), (0.88, 0.84), (250, 250, 248)),
        "PAPER CLIPS",
        (0.5, 0.48),
        (0.66, 0.22),
        INK,
    )
    front = packaging.fitted(front, "100", (0.5, 0.7), (0.2, 0.14), (196, 42, 46))
    sides = {"front": front, "back": front, "left": tone, "right": tone}
    parts = [
        paint(shell, prints.atlas(sides, (214, 224, 234), (320, 192)), six_sides(), roughness=0.15),
        paint(mound, clips, from_above(), roughness=0.4, metallic=0.2),
        *[
            paint(wire, materials.brushed(rng, metals[i % len(metals)]), tiled(0.05), roughness=0.3, metallic=0.3)
            for i, wire in enumerate(wires)
        ],
    ]
    return BuiltObject(parts, [solids.box(size)], mass=0.12, friction=0.6)


def _loose_clips(rng: np.random.Generator, fill: float) -> list[solids.Solid]:
    """Some clips of bent wire on top of the heap."""
    bend = (
        np.array([(-13, -4), (10, -4), (14, -2), (14, 2), (10, 4), (-11, 4), (-14, 1.5), (-11, -1.2), (8, -1.2)]) / 1000
    )
    clips = []
    for i, (x, y) in enumerate([(-0.021, 0.008), (0.004, -0.011), (0.021, 0.009), (-0.017, -0.013), (0.001, 0.012)]):
        turn = rng.uniform(0, 2 * np.pi)
        rotation = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        z = fill + 0.0032 + 0.0003 * i + 0.0008 * np.sin(np.arange(len(bend)))
        path = np.column_stack([bend @ rotation + (x, y), z])
        clips.append(solids.sweep(path, solids.circle(0.0007, 6)))
    return clips


def business_card_holder(variant: str) -> BuiltObject:
    """A low stand with a pile of cards that lean back."""
    rng = variant_rng("business_card_holder", variant)
    width, depth, front, back, lean = 0.098, 0.046, 0.016, 0.036, 0.35
    skin = {
        "wood": materials.wood(rng, materials.WALNUT),
        "black": materials.plastic(rng, (42, 42, 46)),
        "steel": materials.brushed(rng),
    }[variant]
    base = solids.rounded_box((width, depth, 0.007), 0.002)
    lip = solids.rounded_box((width, 0.006, front), 0.002, (0, -depth / 2 + 0.003, 0))
    rest = _upright([(0.012, 0.004), (0.02, 0.004), (0.02 + lean * 0.008, back), (0.015 + lean * 0.008, back)], width)
    rest_low = solids.box((width, 0.008, 0.006), (0, 0.018, 0.003))
    low = np.array([(-0.016, 0.0068), (0.011, 0.0068)])
    rise = np.array([0.11, 0.99]) * 0.049
    cards = _upright([low[0], low[1], low[1] + rise, low[0] + rise], 0.088)
    face = packaging.fitted(prints.canvas(352, 200, (252, 251, 247)), "ADA MERTON", (0.42, 0.28), (0.6, 0.14), INK)
    face = packaging.fitted(face, "architect", (0.28, 0.45), (0.28, 0.09), (120, 122, 128))
    face = prints.disc(face, (0.84, 0.3), 0.14, (40, 128, 150))
    for row in (0.66, 0.76, 0.86):
        face = prints.rectangle(face, (0.12, row), (0.5, row + 0.025), (150, 152, 158))
    edges = materials.page_edges(rng, (246, 244, 236))
    upright = edges.transpose(1, 0, 2)
    picture = prints.atlas(
        {"front": face, "back": face, "top": edges, "left": upright, "right": upright},
        (246, 244, 236),
        (352, 200),
    )
    metallic = 0.4 if variant == "steel" else 0.0
    parts = [
        paint(solids.union(base, lip, rest, rest_low), skin, tiled(0.1), roughness=0.4, metallic=metallic),
        paint(cards, picture, six_sides(), roughness=0.8),
    ]
    return BuiltObject(parts, [base.convex_hull, lip.convex_hull, rest, cards], mass=0.16, friction=0.6)


BUILDERS = {
    "business_card_holder": business_card_holder,
    "desk_calendar": desk_calendar,
    "hole_punch": hole_punch,
    "notepad": notepad,
    "paper_clip_box": paper_clip_box,
}
