"""Small electronic devices without moving parts: a mouse, a mobile phone, a number pad."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, solids
from vcage.objects.builders.mappings import from_above, tiled
from vcage.objects.builders.parts import BuiltObject, Part, paint, variant_rng
from vcage.objects.textures import materials, prints, screens
from vcage.objects.textures.noise import Colour


def computer_mouse(variant: str) -> BuiltObject:
    """A wireless mouse with its buttons to the back, as a user in front of the table holds it."""
    rng = variant_rng("computer_mouse", variant)
    colour, grip = {
        "black": ((48, 49, 53), (30, 30, 33)),
        "white": ((236, 236, 232), (196, 198, 200)),
        "blue": ((52, 96, 172), (34, 44, 66)),
    }[variant]
    shell = solids.closed_rings(_mouse_rings())
    seam = tuple(int(c * 0.45) for c in colour)
    picture = prints.canvas(320, 560, colour)
    picture = prints.rectangle(picture, (0, 0), (0.13, 1), grip)
    picture = prints.rectangle(picture, (0.87, 0), (1, 1), grip)
    picture = prints.rectangle(picture, (0.492, 0), (0.508, 0.44), seam)
    picture = prints.rectangle(picture, (0.13, 0.43), (0.87, 0.44), seam)
    picture = prints.rectangle(picture, (0.43, 0.09), (0.57, 0.31), seam)
    picture = prints.text(picture, "orbi", (0.5, 0.78), 0.06, grip if variant != "black" else (120, 122, 128))
    wheel = solids.revolved([(0, -0.0035), (0.0105, -0.0035), (0.0115, 0), (0.0105, 0.0035), (0, 0.0035)], 28)
    wheel = solids.moved(wheel, (0, 0.034, 0.0235), turn=90, axis=(0, 1, 0))
    parts = [
        paint(shell, picture, from_above(), roughness=0.45, crease=50),
        paint(wheel, materials.plastic(rng, (70, 72, 78)), tiled(0.01), roughness=0.9),
    ]
    hulls = [pieces.coarse(shell.vertices, 120), pieces.coarse(wheel.vertices, 30)]
    return BuiltObject(parts, hulls, mass=0.1, friction=0.8)


def _mouse_rings(stations: int = 17, points: int = 20) -> np.ndarray:
    """(stations, points, 3) outlines across the mouse: upright sides, a flat bottom, the back of the hand's arch."""
    along = np.sin(np.linspace(-1, 1, stations) * np.pi / 2) * 0.985
    angle = np.linspace(0, np.pi, points - 2)
    side, top = (np.sign(f) * np.abs(f) ** 0.62 for f in (np.cos(angle), np.sin(angle)))
    rings = []
    for t in along:
        half = 0.031 * (1 - 0.06 * t) * (1 - abs(t) ** 3.2) ** 0.42
        height = 0.0385 * (1 - 0.34 * (t + 0.25) ** 2) * (1 - abs(t) ** 4) ** 0.5
        x = np.concatenate([[-half * 0.94], [half * 0.94], half * side])
        z = np.concatenate([[0, 0], 0.004 + (height - 0.004) * top])
        rings.append(np.column_stack([x, np.full(points, 0.0565 * t), z]))
    return np.array(rings)


def mobile_phone(variant: str) -> BuiltObject:
    """A mobile phone in a thick rubber bumper, lying on its back, screen on."""
    rng = variant_rng("mobile_phone", variant)
    bumper, wallpaper = {
        "black": ((42, 43, 47), ((28, 42, 92), (150, 74, 140))),
        "blue": ((40, 98, 176), ((8, 62, 78), (70, 172, 160))),
        "red": ((194, 46, 44), ((70, 24, 60), (236, 132, 70))),
    }[variant]
    width, length, height = 0.067, 0.139, 0.0175
    case = solids.prism(solids.rounded_rectangle((width, length), 0.011), height - 0.002, 0.001)
    chamfer = [
        solids.prism(solids.rounded_rectangle((width - 0.002, length - 0.002), 0.010), 0.0012, z)
        for z in (0.0, height - 0.0012)
    ]
    well = solids.prism(solids.rounded_rectangle((width - 0.007, length - 0.007), 0.0075), 0.01, height - 0.0014)
    glass = solids.prism(solids.rounded_rectangle((width - 0.007, length - 0.007), 0.0075), 0.002, height - 0.0026)
    ribs = [
        solids.box((0.0008, 0.0016, 0.010), (side * (width / 2 + 0.0001), y, 0.0035))
        for side in (-1, 1)
        for y in np.linspace(-0.018, 0.018, 7)
    ]
    keys = [
        solids.rounded_box((0.0016, size, 0.005), 0.0007, (width / 2, y, 0.0065), steps=1)
        for y, size in ((0.042, 0.012), (0.028, 0.008))
    ]
    rubber = materials.plastic(rng, bumper)
    parts = [
        paint(solids.cut(solids.union(case, *chamfer), well), rubber, tiled(0.05), roughness=0.85),
        paint(glass, screens.phone_screen((320, 704), wallpaper), from_above(), roughness=0.15),
        paint(solids.union(*ribs, *keys), materials.plastic(rng, [int(c * 0.7) for c in bumper]), tiled(0.05)),
    ]
    hulls = [pieces.hull(solids.union(case, *chamfer).vertices)]
    return BuiltObject(parts, hulls, mass=0.23, friction=0.9)


PAD = (("num", "/", "*", "-"), ("7", "8", "9", "+"), ("4", "5", "6", ""), ("1", "2", "3", "enter"), ("0", "", ".", ""))
"""Legends of a number pad's keys, row by row from the back; the empty ones belong to a larger neighbour."""


def numeric_keypad(variant: str) -> BuiltObject:
    """A number pad with seventeen raised keys, tilted a little towards the user."""
    rng = variant_rng("numeric_keypad", variant)
    case, caps, ink, accent = {
        "black": ((40, 41, 45), (66, 68, 74), (238, 238, 238), (206, 92, 40)),
        "white": ((232, 231, 226), (248, 247, 243), (52, 54, 60), (96, 152, 206)),
    }[variant]
    width, length, pitch = 0.066, 0.092, 0.0155
    outline = solids.rounded_rectangle((width, length), 0.005)
    body = solids.prism(outline, 0.02)
    body.vertices[:, 2] += np.where(body.vertices[:, 2] > 0.01, 0.05 * body.vertices[:, 1], 0)
    cable = solids.moved(
        solids.revolved([(0, 0), (0.0028, 0), (0.002, 0.006), (0, 0.006)], 16),
        (0, 0.0455, 0.010),
        turn=-90,
        axis=(1, 0, 0),
    )
    parts = [
        paint(body, materials.plastic(rng, case, 128), tiled(0.06), roughness=0.6),
        paint(cable, materials.plastic(rng, (28, 28, 30)), tiled(0.05), roughness=0.9),
    ]
    for row, legends in enumerate(PAD):
        for column, legend in enumerate(legends):
            if not legend:
                continue
            wide, tall = {"0": (2, 1), "+": (1, 2), "enter": (1, 2)}.get(legend, (1, 1))
            x, y = (column + wide / 2 - 2) * pitch, (2.5 - row - tall / 2) * pitch
            ground = accent if legend in ("+", "enter", "num") else caps
            parts.append(_cap(legend, (wide * pitch, tall * pitch), (x, y - 0.002), ground, ink))
    top = [(x, y, 0.0258 + 0.05 * y) for x in (-0.0295, 0.0295) for y in (-0.039, 0.035)]
    under = [(x, y, 0.015) for x, y, _ in top]
    hulls = [pieces.hull(body.vertices), pieces.hull(top, under), pieces.hull(cable.vertices)]
    return BuiltObject(parts, hulls, mass=0.16, friction=0.8)


def _cap(legend: str, size: tuple[float, float], at: tuple[float, float], ground: Colour, ink: Colour) -> Part:
    """One key, narrower at its top, with its legend."""
    half = np.array(size) / 2 - 0.0006
    z = 0.02 + 0.05 * at[1]
    rings = [
        np.column_stack([solids.rounded_rectangle(2 * (half - inset), 0.0015, 2) + at, np.full(12, z + rise)])
        for inset, rise in ((0, -0.002), (0.0003, 0.003), (0.0016, 0.0057), (0.0024, 0.006))
    ]
    solid = solids.closed_rings(rings)
    rows = round(64 * size[1] / 0.0155)
    picture = prints.canvas(round(64 * size[0] / 0.0155), rows, ground)
    height = (30 if len(legend) == 1 else 15) / rows
    return paint(solid, prints.text(picture, legend, (0.5, 0.5), height, ink), from_above(), roughness=0.6)


BUILDERS = {
    "computer_mouse": computer_mouse,
    "mobile_phone": mobile_phone,
    "numeric_keypad": numeric_keypad,
}
