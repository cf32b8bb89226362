"""Stationery: things to write, erase, glue and note with."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, solids
from vcage.objects.builders.mappings import around, from_above, six_sides, tiled
from vcage.objects.builders.parts import BuiltObject, paint, variant_rng
from vcage.objects.textures import materials, prints

INKS = {"black": (34, 34, 38), "red": (196, 32, 38), "blue": (28, 74, 176), "green": (24, 130, 66)}


def marker(variant: str) -> BuiltObject:
    """A fat whiteboard marker that lies along x, cap to the right with the clip on top."""
    ink, rng = INKS[variant], variant_rng("marker", variant)
    radius, length = 0.009, 0.13
    plastic = materials.plastic(rng, ink)

    def lying(profile: list[tuple[float, float]]) -> solids.Solid:
        return solids.moved(solids.revolved(profile, 24), (0, 0, radius), turn=90, axis=(0, 1, 0))

    half = length / 2
    barrel = lying([(0, -half + 0.006), (0.0084, -half + 0.006), (0.0084, 0.018), (0, 0.018)])
    plug = lying([(0, -half), (0.006, -half), (0.0082, -half + 0.002), (0.0082, -half + 0.008), (0, -half + 0.008)])
    cap = lying([(0, 0.016), (radius, 0.016), (radius, half - 0.006), (0.0065, half), (0, half)])
    clip = solids.rounded_box((0.034, 0.005, 0.0028), 0.0012, (half - 0.024, 0, 2 * radius - 0.0006))
    parts = [
        paint(barrel, _marker_label(ink), around(0, (0, radius)), roughness=0.4),
        paint(plug, plastic, tiled(0.05), roughness=0.35),
        paint(solids.union(cap, clip), plastic, tiled(0.05), roughness=0.35),
    ]
    octagon = pieces.stack([(radius, -half), (radius, half)], sides=8)
    octagon = solids.moved(octagon, (0, 0, radius), turn=90, axis=(0, 1, 0))
    return BuiltObject(parts, [octagon, clip.convex_hull], mass=0.022, friction=0.8)


def _marker_label(ink: tuple[int, int, int]) -> np.ndarray:
    """The print around the barrel: rows run along the barrel's axis, columns around it."""
    label = prints.canvas(256, 384, (244, 244, 242))
    label = prints.rectangle(label, (0, 0), (1, 0.14), ink)
    label = prints.rectangle(label, (0, 0.70), (1, 1), ink)
    label = prints.rectangle(label, (0.3, 0.16), (0.7, 0.68), ink)
    return prints.text(label, "BOARD", (0.5, 0.42), 0.15, (255, 255, 255), turn=90)


def whiteboard_eraser(variant: str) -> BuiltObject:
    """A plastic grip over a felt pad."""
    rng = variant_rng("whiteboard_eraser", variant)
    colour = {"blue": (40, 92, 168), "grey": (88, 92, 98)}[variant]
    felt = solids.rounded_box((0.106, 0.047, 0.013), 0.001)
    grip = solids.rounded_box((0.112, 0.052, 0.02), 0.006, (0, 0, 0.012))
    top = prints.text(materials.plastic(rng, colour, 256), "ERASER", (0.5, 0.5), 0.2, (240, 240, 240))
    parts = [
        paint(felt, materials.felt(rng, (60, 60, 64)), tiled(0.04), roughness=0.95),
        paint(grip, top, from_above(), roughness=0.45),
    ]
    return BuiltObject(parts, [felt.convex_hull, pieces.coarse(grip.vertices)], mass=0.06, friction=0.8)


def glue_stick(variant: str) -> BuiltObject:
    """A standing tube with a cap."""
    rng = variant_rng("glue_stick", variant)
    cap_colour = {"white": (236, 236, 230), "orange": (238, 128, 36)}[variant]
    body = solids.revolved([(0, 0), (0.0135, 0), (0.0135, 0.006), (0.0128, 0.007), (0.0128, 0.06), (0, 0.06)], 28)
    cap = solids.revolved([(0, 0.058), (0.0137, 0.058), (0.0137, 0.084), (0.0122, 0.087), (0, 0.087)], 28)
    label = prints.canvas(256, 192, (250, 206, 40))
    label = prints.rectangle(label, (0, 0.82), (1, 1), (40, 66, 140))
    for x in (0.17, 0.5, 0.83):
        label = prints.text(label, "GLUE", (x, 0.42), 0.24, (40, 66, 140))
    parts = [
        paint(body, label, around(), roughness=0.45),
        paint(cap, materials.plastic(rng, cap_colour), tiled(0.05), roughness=0.4),
    ]
    return BuiltObject(parts, [pieces.stack([(0.0137, 0), (0.0137, 0.084), (0.0122, 0.087)])], mass=0.035)


def ruler(variant: str) -> BuiltObject:
    """A triangular scale ruler, as draughtsmen use: lies on a face along x."""
    rng = variant_rng("ruler", variant)
    width, height, length = 0.03, 0.026, 0.17
    outline = np.array([(-width / 2, 0), (width / 2, 0), (0.0012, height), (-0.0012, height)])
    bar = solids.moved(solids.prism(outline, length, -length / 2), turn=90, axis=(1, 0, 0))
    bar = solids.moved(bar, turn=90)
    ground = {"white": (240, 238, 230), "yellow": (240, 208, 84)}[variant]
    scale = materials.plastic(rng, ground, 128).repeat(8, axis=1)
    for side in (0.0, 0.5):
        for i in range(1, 86):
            reach = 0.20 if i % 10 == 0 else 0.15 if i % 5 == 0 else 0.09
            edge = side if side == 0 else 1 - reach
            scale = prints.rectangle(scale, (i / 86 - 0.0012, edge), (i / 86 + 0.0012, edge + reach), (30, 30, 34))
    for i in range(1, 9):
        for y in (0.28, 0.72):
            scale = prints.text(scale, str(2 * i), (2 * i / 17.2, y), 0.13, (30, 30, 34))
    return BuiltObject([paint(bar, scale, from_above(), roughness=0.4)], [bar.convex_hull], mass=0.05, friction=0.6)


def sticky_notes(variant: str) -> BuiltObject:
    """A cube of paper slips."""
    rng = variant_rng("sticky_notes", variant)
    colour = {"yellow": (250, 226, 92), "pink": (244, 132, 170), "green": (150, 214, 110)}[variant]
    size = (0.056, 0.056, 0.03)
    block = solids.box(size)
    edges = materials.page_edges(rng, colour)
    sheet = materials.plastic(rng, colour, 128)
    picture = prints.atlas({**dict.fromkeys(("front", "back", "left", "right"), edges), "top": sheet}, colour)
    curl = solids.moved(solids.box((0.055, 0.055, 0.0006)), (0, 0, size[2]))
    note = prints.text(materials.plastic(rng, colour, 192), "to do", (0.36, 0.2), 0.16, (60, 60, 90))
    for row in (0.4, 0.56, 0.72):
        note = prints.rectangle(note, (0.1, row), (0.8 - row / 4, row + 0.025), (80, 80, 110))
    parts = [paint(block, picture, six_sides(), roughness=0.9), paint(curl, note, from_above(), roughness=0.9)]
    return BuiltObject(parts, [solids.box((*size[:2], size[2] + 0.0006))], mass=0.08, friction=0.8)


def rubber_eraser(variant: str) -> BuiltObject:
    """A rubber in a paper sleeve."""
    rng = variant_rng("rubber_eraser", variant)
    colour = {"white": (242, 240, 236), "pink": (236, 146, 150)}[variant]
    rubber = solids.rounded_box((0.056, 0.024, 0.018), 0.003)
    sleeve = solids.box((0.034, 0.0248, 0.0186), (-0.008, 0, 0))
    print_ = prints.canvas(256, 192, (34, 70, 150))
    print_ = prints.rectangle(print_, (0, 0.0), (1, 0.18), (240, 240, 240))
    print_ = prints.text(print_, "rubber", (0.5, 0.56), 0.3)
    parts = [
        paint(rubber, materials.plastic(rng, colour), tiled(0.05), roughness=0.8),
        paint(sleeve, print_, from_above(), roughness=0.7),
    ]
    return BuiltObject(parts, [rubber.convex_hull, sleeve], mass=0.025, friction=0.9)


BUILDERS = {
    "glue_stick": glue_stick,
    "marker": marker,
    "rubber_eraser": rubber_eraser,
    "ruler": ruler,
    "sticky_notes": sticky_notes,
    "whiteboard_eraser": whiteboard_eraser,
}
