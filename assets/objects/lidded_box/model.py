"""A keepsake box; its lid is hinged at the back and is lifted by a tab at the front."""

from __future__ import annotations

import numpy as np

from assets.shapes.joinery import GRIP_WIDTH, Assembly, Finish
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_above
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, MovingPart, Part, paint, variant_rng
from vcage.schema.asset import Joint

INNER, WALL, FLOOR, HEIGHT = (0.17, 0.12), 0.009, 0.008, 0.074
"""Free size inside, thickness of walls and floor, and height of the rim, metres."""

LID, SEAM = 0.014, 0.0012
"""Thickness of the lid, and the seam between the rim and the lid, metres."""

TAB, TAB_HEIGHT = 0.034, 0.03
"""How far the tab stands out in front, and its height, metres."""

OPEN = 1.8
"""How far the lid turns: beyond the vertical, so that it rests on its stop and does not fall shut, radians."""

OUTER = (INNER[0] + 2 * WALL, INNER[1] + 2 * WALL)

MIDDLE, FACE, BACK = TAB / 2, (TAB - OUTER[1]) / 2, (TAB + OUTER[1]) / 2
"""y of the box's middle, front and back in the object frame."""

LININGS = {"walnut": (112, 30, 42), "painted": (226, 214, 196), "tin": (190, 192, 196)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("lidded_box", variant)
    body, lid_finish, metal = _finishes(rng, variant)
    lining = LININGS[variant]
    hollow = solids.box((*INNER, 1.0), (0, MIDDLE, FLOOR))
    shell = solids.cut(_slab(HEIGHT, 0.0), hollow)
    cloth = solids.box((INNER[0] - 0.001, INNER[1] - 0.001, 0.0004), (0, MIDDLE, FLOOR))
    texture = materials.brushed(rng) if variant == "tin" else materials.felt(rng, lining)
    parts = [body.on(shell), Finish(texture, 0.06, 0.95).on(cloth)]
    parts += _hinges(metal)
    hulls = [solids.moved(piece, (0, MIDDLE, 0)) for piece in pieces.tray(INNER, WALL, FLOOR, HEIGHT)]
    lid = _lid(variant, lid_finish, metal, rng)
    return BuiltObject(parts, hulls, mass=0.9, friction=1.0, moving=[lid])


def _lid(variant: str, finish: Finish, metal: Finish, rng: np.random.Generator) -> MovingPart:
    low = HEIGHT + SEAM
    out = Assembly([finish.on(_slab(LID, low))], [solids.box((*OUTER, LID), (0, MIDDLE, low))])
    field = (OUTER[0] - 0.03, OUTER[1] - 0.03)
    panel = solids.rounded_box((*field, 0.003), 0.0012, (0, MIDDLE, low + LID - 0.001), steps=2)
    picture = _picture(variant, rng, field[0] / field[1])
    out.parts.append(paint(panel, picture, from_above(), roughness=finish.roughness))
    # The tab hangs in front of the box and turns with the lid; only its root reaches into the lid.
    z, gap = low + 0.002, 0.0015
    middle = (0, FACE - (TAB + gap) / 2, z - TAB_HEIGHT / 2)
    out.board((GRIP_WIDTH, TAB - gap, TAB_HEIGHT), middle, metal, radius=0.004, along=1)
    out.board((GRIP_WIDTH - 0.002, 0.008, LID - 0.004), (0, FACE, low + 0.002), metal)
    joint = Joint(
        kind="turn",
        origin=(0, BACK, low - SEAM / 2),
        axis=(-1, 0, 0),
        lower=0.0,
        upper=OPEN,
        damping=20.0,
        friction=0.3,
    )
    return MovingPart("lid", out.parts, out.hulls, 0.18, joint)


def _slab(height: float, bottom: float) -> solids.Solid:
    """The box's outline, with rounded upright edges, raised by ``height``."""
    outline = solids.rounded_rectangle(OUTER, 0.004, 3) + (0, MIDDLE)
    return solids.prism(outline, height, bottom)


def _hinges(metal: Finish) -> list[Part]:
    """Two leaves on the back of the box."""
    leaves = [solids.box((0.024, 0.001, 0.014), (x, BACK - 0.0004, HEIGHT - 0.014)) for x in (-0.05, 0.05)]
    return [metal.on(leaf) for leaf in leaves] + [_lock_plate(metal)]


def _lock_plate(metal: Finish) -> Part:
    """A small plate on the front, under the tab."""
    return metal.on(solids.box((0.03, 0.001, 0.02), (0, FACE, HEIGHT - 0.036)))


def _finishes(rng: np.random.Generator, variant: str) -> tuple[Finish, Finish, Finish]:
    """Of the box, of the lid's edge, and of the metal."""
    brass = Finish(materials.brushed(rng, (204, 166, 92)), 0.05, 0.35, 0.4)
    if variant == "walnut":
        box, edge = (Finish(materials.wood(rng, materials.WALNUT), 0.16, 0.5) for _ in range(2))
        return box, edge, brass
    if variant == "painted":
        colour = materials.plastic(rng, (120, 160, 168), 128)
        return Finish(colour, 0.1, 0.5), Finish(colour, 0.1, 0.5), brass
    red = Finish(materials.plastic(rng, (160, 36, 40), 128), 0.1, 0.3, 0.2)
    return red, red, Finish(materials.brushed(rng), 0.05, 0.3, 0.4)


def _picture(variant: str, rng: np.random.Generator, aspect: float) -> np.ndarray:
    """The lid's top panel: inlaid stars, a posy, or a tin's print."""
    rows = 256
    columns = round(rows * aspect)
    if variant == "walnut":
        wood = materials.wood(rng, materials.OAK, 512)[:rows, :columns]
        return _star(_bordered(wood, (74, 46, 30), (226, 196, 140)), (66, 40, 26), (240, 214, 160))
    if variant == "painted":
        return _posy(_bordered(prints.canvas(columns, rows, (240, 234, 220)), (120, 160, 168), (240, 234, 220)))
    ground = _bordered(prints.canvas(columns, rows, (168, 38, 42)), (226, 190, 104), (140, 26, 32))
    ground = prints.text(ground, "BUTTER", (0.5, 0.36), 0.2, (246, 226, 170))
    return prints.text(ground, "BISCUITS", (0.5, 0.63), 0.2, (246, 226, 170))


def _bordered(picture: np.ndarray, line: Colour, between: Colour) -> np.ndarray:
    """The picture inside two lines that run around it."""
    out = prints.canvas(picture.shape[1], picture.shape[0], line)
    for inset, fill in ((0.03, between), (0.05, line)):
        out = prints.rectangle(out, (inset, 1.4 * inset), (1 - inset, 1 - 1.4 * inset), fill)
    rows, columns = picture.shape[:2]
    top, left = round(0.085 * rows), round(0.06 * columns)
    out[top : rows - top, left : columns - left] = picture[top : rows - top, left : columns - left]
    return out


def _star(picture: np.ndarray, dark: Colour, light: Colour) -> np.ndarray:
    """An eight-pointed star of two woods in the middle."""
    rows, columns = picture.shape[:2]
    y, x = np.mgrid[:rows, :columns]
    dx, dy = (x - columns / 2) / rows, (y - rows / 2) / rows
    turn = np.arctan2(dy, dx) % (np.pi / 4) - np.pi / 8
    reach = 0.13 + 0.2 * (np.abs(turn) / (np.pi / 8))
    inside = np.hypot(dx, dy) < reach
    out = picture.copy()
    out[inside & (turn < 0)] = dark
    out[inside & (turn >= 0)] = light
    return out


def _posy(picture: np.ndarray) -> np.ndarray:
    """Five flowers with leaves."""
    flowers = [((0.5, 0.45), 0.075, (206, 92, 104)), ((0.35, 0.55), 0.055, (232, 176, 84))]
    flowers += [((0.65, 0.55), 0.055, (232, 176, 84)), ((0.25, 0.42), 0.045, (120, 120, 180))]
    flowers += [((0.75, 0.42), 0.045, (120, 120, 180))]
    for (x, y), size, colour in flowers:
        for leaf in (-1, 1):
            picture = prints.disc(picture, (x + leaf * 0.9 * size, y + 1.9 * size), 0.55 * size, (116, 148, 104))
        for angle in np.arange(5) * 2 * np.pi / 5 - np.pi / 2:
            petal = (x + 0.72 * size * np.cos(angle), y + size * np.sin(angle))
            picture = prints.disc(picture, petal, 0.62 * size, colour)
        picture = prints.disc(picture, (x, y), 0.5 * size, (250, 226, 130))
    return picture
