"""A steel cash drawer: coin cups at the front, a bay for notes behind them, a lock and a slot in its face."""

from __future__ import annotations

import numpy as np

from assets.shapes import joinery
from assets.shapes.joinery import Assembly, Carcass, DrawerLook, Finish
from vcage.objects.modelling import materials, prints, solids
from vcage.objects.modelling.mappings import from_above, from_front
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, MovingPart, Part, paint, variant_rng

COINS = 5
"""Compartments for coins, side by side at the front."""

COIN_DEPTH, DIVIDER, DIVIDER_HEIGHT = 0.04, 0.003, 0.012
"""Depth of these compartments, thickness and height of what divides them, metres."""

VARIANTS = {
    "black": ((46, 47, 52), (70, 71, 77)),
    "grey": ((160, 162, 164), (200, 202, 200)),
}
"""Variant → shell colour, front colour."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("cash_drawer", variant)
    shell_colour, front_colour = VARIANTS[variant]
    shell = Finish(materials.plastic(rng, shell_colour, 128), 0.12, 0.5, 0.1)
    steel = Finish(materials.brushed(rng), 0.05, 0.35, 0.4)
    rubber = Finish(materials.felt(rng, (34, 34, 36)), 0.05, 0.9)
    carcass = Carcass(0.30, 0.20, bays=(0.07,), foot=0.02, board=0.004, side=0.005, top=0.005, lip=0.002)
    body = carcass.build(shell, shell, rubber, "legs")
    tray = Finish(materials.plastic(rng, (66, 68, 74)), 0.1, 0.5)
    front = Finish(materials.plastic(rng, front_colour, 128), 0.12, 0.45, 0.1)
    look = DrawerLook(front, tray, steel, steel, style="fin")
    drawer = joinery.drawer(carcass, 0, look)
    drawer.add(_fittings(carcass, tray, rng))
    ink = (222, 222, 226) if variant == "black" else (40, 42, 48)
    drawer.parts += _face(carcass, front_colour, ink, steel)
    moving = [MovingPart("drawer", drawer.parts, drawer.hulls, 0.7, joinery.slide(carcass, 0))]
    return BuiltObject(body.parts, body.hulls, mass=5.0, friction=1.0, moving=moving)


def _fittings(carcass: Carcass, tray: Finish, rng: np.random.Generator) -> Assembly:
    """Low dividers, coins in the cups, and the marked bay for notes."""
    out = Assembly()
    wide = carcass.clear - 0.01 - 2 * joinery.WALL
    floor = carcass.floor(0) + joinery.DRAWER_FLOOR
    start = carcass.face + joinery.PANEL
    step = wide / COINS
    for i in range(1, COINS):
        x = -wide / 2 + i * step
        out.board((DIVIDER, COIN_DEPTH, DIVIDER_HEIGHT), (x, start + COIN_DEPTH / 2, floor), tray)
    out.board((wide, DIVIDER, DIVIDER_HEIGHT), (0, start + COIN_DEPTH + DIVIDER / 2, floor), tray)
    coins = solids.box((wide, COIN_DEPTH, 0.0004), (0, start + COIN_DEPTH / 2, floor))
    out.parts.append(paint(coins, _coins(rng, wide), from_above(), roughness=0.45))
    depth = joinery.DRAWER_DEPTH - COIN_DEPTH - DIVIDER
    notes = solids.box((wide, depth, 0.0004), (0, start + COIN_DEPTH + DIVIDER + depth / 2, floor))
    out.parts.append(paint(notes, _note_bay(wide / depth), from_above(), roughness=0.6))
    return out


def _coins(rng: np.random.Generator, wide: float) -> np.ndarray:
    """Coins strewn over the floors of the cups, one metal and size per cup."""
    rows = 160
    columns = round(rows * wide / COIN_DEPTH)
    picture = prints.canvas(columns, rows, (52, 53, 58))
    kinds = [((186, 112, 66), 0.19), ((178, 104, 60), 0.22), ((208, 172, 88), 0.22), ((204, 206, 208), 0.25)]
    kinds.append(((214, 200, 150), 0.27))
    for cup, (metal, size) in enumerate(kinds):
        for _ in range(14):
            x = (cup + rng.uniform(0.2, 0.8)) / COINS
            picture = _coin(picture, (x, rng.uniform(0.2, 0.8)), size * rng.uniform(0.95, 1.0), metal)
    return picture


def _coin(picture: np.ndarray, centre: tuple[float, float], size: float, metal: Colour) -> np.ndarray:
    """One coin with a dark outline, a bright rim and a stamped face; ``size`` is its diameter as a share of rows."""
    for share, tone in ((1.08, 0.4), (1.0, 1.1), (0.84, 0.86), (0.78, 0.98), (0.3, 0.86)):
        colour = tuple(min(255, int(tone * c)) for c in metal)
        picture = prints.disc(picture, centre, size * share / 2, colour)
    return picture


def _note_bay(aspect: float) -> np.ndarray:
    """The bay's floor with four wells for notes."""
    rows = 160
    picture = prints.canvas(round(rows * aspect), rows, (66, 68, 74))
    for i, tint in enumerate([(92, 112, 100), (112, 98, 92), (92, 102, 120), (116, 110, 88)]):
        left = 0.012 + 0.2475 * i
        picture = prints.rectangle(picture, (left, 0.06), (left + 0.233, 0.94), (40, 41, 46))
        picture = prints.rectangle(picture, (left + 0.006, 0.09), (left + 0.227, 0.91), tint)
        words = ("5", "10", "20", "50")[i]
        picture = prints.text(picture, words, (left + 0.1165, 0.5), 0.26, tuple(int(1.5 * c) for c in tint))
    return picture


def _face(carcass: Carcass, ground: Colour, ink: Colour, steel: Finish) -> list[Part]:
    """What is on the front: a lock, a slot for cheques, and the maker's plate."""
    y, z = carcass.face, carcass.floor(0) + carcass.bays[0] / 2
    lock = solids.moved(solids.prism(solids.circle(0.009, 20), 0.003), (0.085, y + 0.0005, z), turn=90, axis=(1, 0, 0))
    keyhole = solids.box((0.0016, 0.001, 0.008), (0.085, y - 0.0027, z - 0.004))
    slot = solids.box((0.09, 0.001, 0.0025), (-0.078, y - 0.0001, z + 0.018))
    dark = Finish(np.full((8, 8, 3), 18, dtype=np.uint8), roughness=0.9)
    picture = prints.text(prints.canvas(300, 70, ground), "TILLMARK", (0.5, 0.5), 0.62, ink)
    plate = solids.box((0.06, 0.001, 0.014), (-0.078, y, z - 0.015))
    return [steel.on(lock), dark.on(keyhole), dark.on(slot), paint(plate, picture, from_front(), roughness=0.5)]
