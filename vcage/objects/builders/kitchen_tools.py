"""Kitchen tools that are turned or sawn: a board, a rolling pin, a pepper mill; and a vacuum flask."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import lumps, pieces, solids
from vcage.objects.builders.mappings import around, tiled
from vcage.objects.builders.parts import BuiltObject, paint, variant_rng
from vcage.objects.textures import kitchen, materials, prints

ASH = ((208, 180, 140), (236, 214, 180))


def cutting_board(variant: str) -> BuiltObject:
    """A thick cutting board on four feet, 0.19 × 0.15 m, with a grip to the right."""
    rng = variant_rng("cutting_board", variant)
    colours = {"beech": materials.BEECH, "walnut": materials.WALNUT, "bamboo": ((196, 160, 96), (226, 198, 138))}[
        variant
    ]
    size, foot, top = np.array([0.19, 0.15]), 0.006, 0.025
    blade = solids.prism(solids.rounded_rectangle(size, 0.016, 6), top - foot, foot)
    groove = solids.cut(
        solids.prism(solids.rounded_rectangle(size - 0.018, 0.012, 6), 0.01, top - 0.0025),
        solids.prism(solids.rounded_rectangle(size - 0.03, 0.008, 6), 0.02, top - 0.005),
    )
    outline = _grip_outline(size[0] / 2)
    grip = solids.prism(outline, top - foot - 0.002, foot)
    hole = solids.prism(solids.circle(0.0065, 24, (size[0] / 2 + 0.062, 0)), 0.1)
    board = solids.cut(solids.union(blade, grip), groove, hole)
    rubber = materials.plastic(rng, (52, 50, 50))
    parts = [paint(board, materials.wood(rng, colours, boards=6), tiled(0.17), roughness=0.65)]
    root, rest = outline[[0, 1, -2, -1]], outline[1:-1]
    hulls = [blade, *(pieces.hull(_upright(outline_, foot, top - 0.002)) for outline_ in (root, rest))]
    for x, y in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
        knob = solids.revolved([(0, 0), (0.0075, 0), (0.0085, 0.0015), (0.0085, foot + 0.0005), (0, foot + 0.0005)], 16)
        knob = solids.moved(knob, (x * (size[0] / 2 - 0.02), y * (size[1] / 2 - 0.02), 0))
        parts.append(paint(knob, rubber, tiled(0.05), roughness=0.9))
        hulls.append(knob.convex_hull)
    return BuiltObject(parts, hulls, mass=0.34, friction=0.7)


def rolling_pin(variant: str) -> BuiltObject:
    """A rolling pin along x, 0.3 m long, with a narrow flat underside so that it does not roll."""
    rng = variant_rng("rolling_pin", variant)
    radius, half = 0.024, 0.095
    edge = solids.arc((radius - 0.004, half - 0.004), 0.004, 0, 90, 5)
    barrel = solids.revolved(np.concatenate([[(0, -half)], edge[::-1] * (1, -1), edge, [(0, half)]]), 40)
    knots = [(0.0075, half - 0.001), (0.0075, half + 0.004), (0.0115, half + 0.014), (0.0135, half + 0.03)]
    knots += [(0.0125, half + 0.045), (0.0085, half + 0.053), (0.003, half + 0.055)]
    shape = lumps.smooth(knots, 16)
    handle = solids.revolved(np.concatenate([[(0, shape[0, 1])], shape, [(0, shape[-1, 1])]]), 28)
    body = lumps.lying(barrel, 0.0012)
    colours = {"beech": materials.BEECH, "walnut": materials.WALNUT, "marble": materials.WALNUT}[variant]
    grain = materials.wood(rng, colours)
    skin, roughness = (kitchen.marble(rng), 0.2) if variant == "marble" else (grain, 0.6)
    height = radius - 0.0012
    parts, hulls = [paint(body, skin, tiled(0.12), roughness=roughness)], [pieces.coarse(body.vertices, 90)]
    for side in (-1, 1):
        grip = solids.moved(handle, (0, 0, height), turn=90 * side, axis=(0, 1, 0))
        parts.append(paint(grip, grain, tiled(0.12), roughness=0.55))
        hulls += pieces.slabs(grip, 2)
    return BuiltObject(parts, hulls, mass=0.55 if variant == "marble" else 0.4, friction=0.6)


def pepper_mill(variant: str) -> BuiltObject:
    """A turned pepper mill, 0.165 m high, with a steel knob."""
    rng = variant_rng("pepper_mill", variant)
    knots = [(0.027, 0), (0.0275, 0.006), (0.0245, 0.02), (0.0175, 0.05), (0.016, 0.065), (0.0205, 0.088)]
    knots += [(0.0225, 0.1), (0.0195, 0.11), (0.0165, 0.114)]
    body = lumps.smooth(knots, 26)
    head = np.concatenate([[(0.0165, 0.1155)], solids.arc((0, 0.135), (0.0235, 0.022), -50, 78, 16)])
    knob = np.concatenate([[(0, 0.154), (0.005, 0.154), (0.0045, 0.157)], solids.arc((0, 0.1605), 0.0055, -30, 90, 7)])
    ring = [(0.01, 0.1135), (0.0172, 0.1135), (0.0172, 0.1162), (0.01, 0.1162)]
    colours = {"walnut": materials.WALNUT, "ash": ASH, "black": ((30, 28, 28), (58, 54, 52))}[variant]
    wood = materials.wood(rng, colours)
    metal = kitchen.steel(rng)
    parts = []
    for outline in (body, head):
        closed = np.concatenate([[(0, outline[0, 1])], outline, [(0, outline[-1, 1])]])
        parts.append(paint(solids.revolved(closed, 40), wood, tiled(0.1, along=2), roughness=0.4))
    parts += [paint(solids.revolved(p, 32), metal, tiled(0.05), roughness=0.3, metallic=0.5) for p in (ring, knob)]
    hulls = [pieces.stack([tuple(p) for p in rows]) for rows in (body[:13:3], body[12:19:2], body[18::2], head[::3])]
    hulls.append(pieces.stack([(0.0045, 0.154), (0.0055, 0.1605), (0.003, 0.1655)], 8))
    return BuiltObject(parts, hulls, mass=0.3, friction=0.6)


def thermos(variant: str) -> BuiltObject:
    """A vacuum flask, 0.215 m high, with its cup as a lid and a handle to the right."""
    rng = variant_rng("thermos", variant)
    radius, shoulder, height = 0.034, 0.152, 0.215
    body = [(0, 0), (0.032, 0), (radius, 0.002), (radius, shoulder - 0.006), (0.0325, shoulder), (0, shoulder)]
    collar = [(0, shoulder - 0.001), (0.0315, shoulder - 0.001), (0.0315, shoulder + 0.006), (0, shoulder + 0.006)]
    lid = [(0, shoulder + 0.005), (0.0325, shoulder + 0.005), (0.033, shoulder + 0.008), (0.0305, height - 0.004)]
    lid += [(0.0285, height - 0.0005), (0.027, height), (0.0255, height - 0.0015), (0, height - 0.0015)]
    foot = [(0.02, 0.003), (radius + 0.0004, 0.003), (radius + 0.0004, 0.014), (0.02, 0.014)]
    coat = {"steel": None, "green": (52, 86, 68), "blue": (36, 72, 118)}[variant]
    metal = kitchen.steel(rng)
    print_ = materials.plastic(rng, coat, 384) if coat else kitchen.steel(rng, 384)
    for x in (0.25, 0.75):
        print_ = prints.text(print_, "KOLDE", (x, 0.44), 0.075, (240, 240, 236) if coat else (60, 62, 66))
        print_ = prints.rectangle(print_, (x - 0.1, 0.53), (x + 0.1, 0.545), (236, 150, 50))
    print_ = np.roll(print_, 96, axis=1)  # a print in front and one at the back
    dark = materials.plastic(rng, (40, 42, 44))
    parts = [paint(solids.revolved(body, 44), print_, around(), roughness=0.35, metallic=0.0 if coat else 0.4)]
    parts += [paint(solids.revolved(p, 44), dark, tiled(0.05), roughness=0.6) for p in (collar, foot)]
    parts.append(paint(solids.revolved(lid, 44), metal, tiled(0.06), roughness=0.3, metallic=0.5))
    bow = np.array([(0.0, 0.132), (0.012, 0.134), (0.021, 0.131), (0.0255, 0.122), (0.026, 0.105), (0.0245, 0.075)])
    bow = np.concatenate([bow, [(0.0205, 0.05), (0.0135, 0.039), (0.0, 0.034)]])
    path = np.column_stack([radius - 0.002 + bow[:, 0], np.zeros(len(bow)), bow[:, 1]])
    count = 14
    handle = solids.sweep(path, solids.circle(1.0, count) * (0.0045, 0.009), up=(0, 1, 0))
    parts.append(paint(handle, dark, tiled(0.05), roughness=0.6))
    hulls = [
        pieces.stack([(0.032, 0), (radius + 0.0004, 0.003), (radius, shoulder - 0.006), (0.0325, shoulder)]),
        pieces.stack([(0.0315, shoulder), (0.033, shoulder + 0.008), (0.0305, height - 0.004), (0.027, height)]),
        *pieces.chain(list(np.asarray(handle.vertices)[: len(path) * count].reshape(len(path), count, 3))),
    ]
    return BuiltObject(parts, hulls, mass=0.5, friction=0.6)


def _grip_outline(start: float) -> np.ndarray:
    """(n, 2) counter-clockwise: a grip to the right from ``start``, with fillets towards the board."""
    end = solids.arc((start + 0.062, 0), 0.0185, -85, 85, 12)
    return np.concatenate(
        [[(start - 0.004, -0.024), (start + 0.012, -0.0175)], end, [(start + 0.012, 0.0175), (start - 0.004, 0.024)]]
    )


def _upright(outline: np.ndarray, low: float, high: float) -> np.ndarray:
    """Corners (2n, 3) of a prism over an outline."""
    return np.concatenate([np.column_stack([outline, np.full(len(outline), z)]) for z in (low, high)])


BUILDERS = {
    "cutting_board": cutting_board,
    "pepper_mill": pepper_mill,
    "rolling_pin": rolling_pin,
    "thermos": thermos,
}
