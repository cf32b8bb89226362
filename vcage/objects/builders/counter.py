"""Things that lie and stand on a shop's counter: signs, a mat, a coin tray and a shopping basket."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, solids
from vcage.objects.builders.mappings import from_above, six_sides, tiled
from vcage.objects.builders.parts import BuiltObject, Part, paint, variant_rng
from vcage.objects.textures import materials, prints, till_faces


def payment_sign(variant: str) -> BuiltObject:
    """A thick acrylic panel with a square payment code, upright in a foot."""
    rng = variant_rng("payment_sign", variant)
    ground, brand = {
        "blue": ((34, 98, 196), "ZIPPA"),
        "green": ((30, 146, 86), "PAYLEAF"),
        "orange": ((232, 116, 34), "QUIKO"),
    }[variant]
    size, foot = (0.1, 0.011, 0.141), 0.016
    panel = solids.rounded_box(size, 0.0012, (0, 0, foot - 0.006), steps=2)
    base = solids.rounded_box((0.108, 0.06, foot), 0.004)
    poster = till_faces.payment_poster(rng, ground, brand)
    back = prints.text(prints.canvas(440, 620, ground), brand, (0.5, 0.5), 0.1, (255, 255, 255))
    glass = (196, 222, 224)
    parts = [
        paint(panel, prints.atlas({"front": poster, "back": back}, glass, (440, 620)), six_sides(), roughness=0.12),
        paint(base, materials.wood(rng, materials.BEECH), tiled(0.12), roughness=0.6),
    ]
    hulls = [solids.box((size[0], size[1], size[2] - 0.006), (0, 0, foot)), base.convex_hull]
    return BuiltObject(parts, hulls, mass=0.35, friction=0.6)


def customer_mat(variant: str) -> BuiltObject:
    """A rubber counter mat, 0.36 × 0.24 m, that marks the customer's side."""
    ground, ink = {
        "black": ((42, 44, 48), (240, 240, 236)),
        "blue": ((34, 74, 130), (250, 250, 246)),
        "green": ((38, 100, 70), (250, 244, 214)),
    }[variant]
    size, height = (0.36, 0.24), 0.004
    mat = solids.prism(solids.rounded_rectangle(size, 0.014), height)
    part = paint(mat, till_faces.customer_floor(ground, ink), from_above(), roughness=0.85)
    return BuiltObject([part], [mat.convex_hull], mass=0.35, friction=0.9)


def coin_tray(variant: str) -> BuiltObject:
    """A till tray: three coin cups in front, a compartment for notes behind, a handle on the wall between."""
    rng = variant_rng("coin_tray", variant)
    colour = {"black": (54, 56, 60), "grey": (150, 154, 160), "blue": (56, 92, 146)}[variant]
    wall, floor, height, divider, web = 0.008, 0.005, 0.034, 0.01, 0.006
    cup, notes = (0.074, 0.074), 0.086
    inner = (3 * cup[0] + 2 * web, cup[1] + divider + notes)
    front = -inner[1] / 2
    ridge = front + cup[1] + divider / 2
    outer = (inner[0] + 2 * wall, inner[1] + 2 * wall)
    cup_middles = [(i * (cup[0] + web), front + cup[1] / 2) for i in (-1, 0, 1)]
    notes_middle = (0.0, inner[1] / 2 - notes / 2)
    hollows = [((*cup, 1.0), (*at, floor - 0.0008)) for at in cup_middles]
    hollows.append(((inner[0], notes, 1.0), (*notes_middle, floor - 0.0008)))
    shell = solids.prism(solids.rounded_rectangle(outer, 0.008), height)
    handle = solids.rounded_box((0.1, divider, 0.026), 0.0045, (0, ridge, 0.024))
    body = solids.union(solids.cut(shell, *[solids.box(*hollow) for hollow in hollows]), handle)
    dark = tuple(int(0.72 * c) for c in colour)
    copper, brass, silver = (196, 122, 76), (222, 186, 92), (202, 204, 208)
    parts = [paint(body, materials.plastic(rng, colour), tiled(0.1), roughness=0.5)]
    for at, value, metal in zip(cup_middles, ("5", "10", "50"), (copper, brass, silver), strict=True):
        plate = solids.box((*cup, 0.0009), (*at, floor - 0.0009))
        parts.append(paint(plate, till_faces.coin_floor((222, 222), dark, value, metal), from_above(), roughness=0.6))
    plate = solids.box((inner[0], notes, 0.0009), (*notes_middle, floor - 0.0009))
    parts.append(paint(plate, till_faces.note_floor((702, 258), dark), from_above(), roughness=0.6))
    hulls = pieces.tray(inner, wall, floor, height)
    hulls.append(solids.box((inner[0], divider, height - floor), (0, ridge, floor)))
    hulls.append(handle.convex_hull)
    for side in (-1, 1):
        middle = side * (cup[0] + web) / 2
        hulls.append(solids.box((web, cup[1], height - floor), (middle, front + cup[1] / 2, floor)))
    return BuiltObject(parts, hulls, mass=0.25, friction=0.7)


def shopping_basket(variant: str) -> BuiltObject:
    """A low hand basket with slotted walls, 0.23 × 0.16 m inside; its two handles are folded outwards."""
    rng = variant_rng("shopping_basket", variant)
    colour = {"red": (204, 40, 44), "blue": (36, 92, 176), "green": (52, 140, 72)}[variant]
    inner, wall, floor, height = (0.23, 0.16), 0.006, 0.004, 0.048
    outer = (inner[0] + 2 * wall, inner[1] + 2 * wall)
    shell = solids.prism(solids.rounded_rectangle(outer, 0.01), height)
    rim = solids.prism(solids.rounded_rectangle((outer[0] + 0.008, outer[1] + 0.008), 0.012), 0.014, height - 0.014)
    hollow = solids.prism(solids.rounded_rectangle(inner, 0.008), 1.0, floor - 0.0008)
    bottom = solids.prism(solids.rounded_rectangle(inner, 0.008), 0.0009, floor - 0.0009)
    body = solids.cut(solids.union(shell, rim), hollow, *_slots())
    grey = materials.plastic(rng, (64, 66, 72))
    parts = [
        paint(body, materials.plastic(rng, colour), tiled(0.1), roughness=0.45),
        paint(bottom, till_faces.slotted_floor((520, 340), colour), from_above(), roughness=0.5),
    ]
    hulls = pieces.tray(inner, wall, floor, height)
    for side in (-1, 1):
        hulls += [
            solids.box((0.004, outer[1] - 0.01, 0.014), (side * (outer[0] / 2 + 0.002), 0, height - 0.014)),
            solids.box((outer[0] - 0.01, 0.004, 0.014), (0, side * (outer[1] / 2 + 0.002), height - 0.014)),
        ]
        bars = _handle(side, outer[1] / 2, height - 0.019)
        parts.append(paint(solids.union(*bars), grey, tiled(0.05), roughness=0.6))
        hulls += [bar.convex_hull for bar in bars]
        parts.append(_shop_name(side, outer[0] / 2))
    return BuiltObject(parts, hulls, mass=0.18, friction=0.8)


def _slots() -> list[solids.Solid]:
    """Cutters of upright slots through all four walls, none where the name is."""
    tools = [solids.box((0.01, 1.0, 0.02), (0.0185 * i, 0, 0.011)) for i in range(-5, 6)]
    for y in 0.0185 * np.arange(-3, 4):
        if abs(y) > 0.05:
            tools.append(solids.box((1.0, 0.01, 0.02), (0, y, 0.011)))
    return tools


def _handle(side: int, edge: float, z: float) -> list[solids.Solid]:
    """Grip and two arms of a handle that lies outside the long wall at y = ±edge."""
    reach = 0.043
    grip = solids.rounded_box((0.13, 0.012, 0.018), 0.0025, (0, side * (edge + reach), z))
    arms = [
        solids.rounded_box((0.008, reach + 0.004, 0.008), 0.002, (x, side * (edge + reach / 2), z + 0.008), steps=2)
        for x in (-0.058, 0.058)
    ]
    return [grip, *arms]


def _shop_name(side: int, edge: float) -> Part:
    """A white plate with the shop's name on a short wall, at x = ±edge."""
    picture = prints.text(prints.canvas(384, 96, (250, 250, 246)), "FRESKO", (0.5, 0.5), 0.66, (50, 60, 66))
    plate = solids.box((0.0012, 0.086, 0.021), (side * edge, 0, 0.0105))
    sides = {"left": picture, "right": picture}
    return paint(plate, prints.atlas(sides, (250, 250, 246), (384, 96)), six_sides(), roughness=0.5)


def price_sign(variant: str) -> BuiltObject:
    """A small A-frame board with a price on both sides."""
    rng = variant_rng("price_sign", variant)
    words, price, ground, ink, frame = {
        "chalk": ("TODAY", "1.50", (46, 52, 50), (244, 244, 238), materials.OAK[0]),
        "yellow": ("SALE", "2.99", (252, 212, 40), (206, 28, 34), (206, 28, 34)),
        "white": ("NEW", "0.89", (250, 250, 246), (30, 84, 160), (30, 84, 160)),
    }[variant]
    face = till_faces.price_board(words, price, ground, ink, frame)
    sheet = prints.atlas({"front": face, "back": face}, frame, (face.shape[1], face.shape[0]))
    boards = [_leaning_board(side, 0.088, 0.078) for side in (-1, 1)]
    hinge = solids.rounded_box((0.07, 0.01, 0.007), 0.002, (0, 0, 0.0735))
    parts = [paint(board, sheet, six_sides(), roughness=0.7) for board in boards]
    parts.append(paint(hinge, materials.plastic(rng, tuple(int(0.7 * c) for c in frame)), tiled(0.05), roughness=0.6))
    return BuiltObject(parts, [*boards, hinge.convex_hull], mass=0.09, friction=0.8)


def _leaning_board(side: int, width: float, height: float) -> solids.Solid:
    """One of two boards that lean against each other, flat at its foot; ``side`` is -1 for the front one."""
    section = [(0.027, 0.0), (0.0215, 0.0), (0.0, height), (0.0055, height)]
    return pieces.hull(*[[(x, side * y, z) for y, z in section] for x in (-width / 2, width / 2)])


BUILDERS = {
    "coin_tray": coin_tray,
    "customer_mat": customer_mat,
    "payment_sign": payment_sign,
    "price_sign": price_sign,
    "shopping_basket": shopping_basket,
}
