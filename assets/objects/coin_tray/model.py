"""A till tray: three coin cups in front, a compartment for notes behind, a handle on the wall between."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"black": (54, 56, 60), "grey": (150, 154, 160), "blue": (56, 92, 146)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("coin_tray", variant)
    colour = COLOURS[variant]
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
        parts.append(paint(plate, _coin_floor((222, 222), dark, value, metal), from_above(), roughness=0.6))
    plate = solids.box((inner[0], notes, 0.0009), (*notes_middle, floor - 0.0009))
    parts.append(paint(plate, _note_floor((702, 258), dark), from_above(), roughness=0.6))
    hulls = pieces.tray(inner, wall, floor, height)
    hulls.append(solids.box((inner[0], divider, height - floor), (0, ridge, floor)))
    hulls.append(handle.convex_hull)
    for side in (-1, 1):
        middle = side * (cup[0] + web) / 2
        hulls.append(solids.box((web, cup[1], height - floor), (middle, front + cup[1] / 2, floor)))
    return BuiltObject(parts, hulls, mass=0.25, friction=0.7)


def _coin_floor(size: tuple[int, int], ground: Colour, value: str, metal: Colour) -> np.ndarray:
    """The floor of a coin cup: a large coin with its value."""
    picture = prints.canvas(*size, ground)
    dark = tuple(int(0.7 * c) for c in metal)
    for radius, colour in ((0.36, dark), (0.345, metal), (0.29, dark), (0.275, metal)):
        picture = prints.disc(picture, (0.5, 0.5), radius, colour)
    return prints.text(picture, value, (0.5, 0.5), 0.3, tuple(int(0.4 * c) for c in metal))


def _note_floor(size: tuple[int, int], ground: Colour) -> np.ndarray:
    """The floor of a compartment for banknotes: the outline of an invented note."""
    picture = prints.canvas(*size, ground)
    tint, dark = (150, 186, 160), (70, 110, 88)
    picture = prints.rectangle(picture, (0.12, 0.14), (0.88, 0.86), dark)
    picture = prints.rectangle(picture, (0.13, 0.17), (0.87, 0.83), tint)
    picture = prints.rectangle(picture, (0.15, 0.23), (0.85, 0.77), dark)
    picture = prints.rectangle(picture, (0.157, 0.25), (0.843, 0.75), tint)
    picture = prints.disc(picture, (0.5, 0.5), 0.21, dark)
    picture = prints.text(picture, "20", (0.5, 0.5), 0.22, tint)
    return prints.text(prints.text(picture, "20", (0.23, 0.5), 0.16, dark), "20", (0.77, 0.5), 0.16, dark)
