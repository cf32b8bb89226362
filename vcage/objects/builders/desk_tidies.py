"""Trays, cases and small helpers of a desk."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, shells, solids
from vcage.objects.builders.mappings import around, from_above, from_front, tiled
from vcage.objects.builders.parts import BuiltObject, Part, paint, variant_rng
from vcage.objects.textures import materials, packaging, prints


def correction_fluid(variant: str) -> BuiltObject:
    """A small bottle of white correction fluid with a brush cap."""
    accent = {"blue": (34, 96, 176), "green": (44, 138, 84)}[variant]
    radius, shoulder, height = 0.017, 0.044, 0.078
    body = [(0, 0), (radius - 0.002, 0), (radius, 0.002), (radius, shoulder - 0.007)]
    body = np.concatenate([body, solids.arc((0.0105, shoulder - 0.007), (radius - 0.0105, 0.007), 15, 90, 6)])
    cap = [(0, shoulder), (0.0125, shoulder), (0.012, height - 0.012), (0.0105, height - 0.002), (0.009, height)]
    lines = [("BLANCO", 0.4, 0.26, 0.2, (250, 250, 250)), ("correction fluid", 0.66, 0.26, 0.11, accent)]
    label = packaging.label((512, 208), (250, 250, 248), lines, [(0.26, 0.54, accent)])
    ribs = packaging.striped([accent, tuple(int(0.8 * c) for c in accent)], 40)
    parts = [
        paint(solids.revolved([*body, (0, shoulder)], 40), label, around(), roughness=0.3),
        paint(solids.revolved([*cap, (0, height)], 36), ribs, around(), roughness=0.45),
    ]
    hulls = [
        pieces.stack([(radius - 0.001, 0), (radius, 0.002), (radius, shoulder - 0.006), (0.0125, shoulder)]),
        pieces.stack([(0.0125, shoulder), (0.012, height - 0.012), (0.01, height)]),
    ]
    return BuiltObject(parts, hulls, mass=0.045, friction=0.7)


def pen_tray(variant: str) -> BuiltObject:
    """A long low tray for pens, its end walls thick enough to hold."""
    rng = variant_rng("pen_tray", variant)
    inner, wall, floor, height = (0.2, 0.072), 0.009, 0.006, 0.03
    body, hulls = shells.open_box(inner, wall, floor, height, 0.01)
    if variant == "bamboo":
        part = paint(body, materials.wood(rng, materials.PINE), tiled(0.14), roughness=0.7)
    else:
        colour = {"black": (50, 50, 54), "mint": (150, 206, 186)}[variant]
        part = paint(body, materials.plastic(rng, colour), tiled(0.1), roughness=0.5)
    felt = {"bamboo": (96, 110, 100), "black": (120, 124, 130), "mint": (236, 240, 236)}[variant]
    return BuiltObject([part, _lining(rng, inner, floor, felt)], hulls, mass=0.25, friction=0.7)


def _lining(rng: np.random.Generator, inner: tuple[float, float], floor: float, colour: tuple[int, int, int]) -> Part:
    """Felt on the floor of a tray, 0.4 mm above it."""
    sheet = solids.prism(solids.rounded_rectangle((inner[0] - 0.002, inner[1] - 0.002), 0.003), 0.0006, floor - 0.0002)
    return paint(sheet, materials.felt(rng, colour), tiled(0.05), roughness=0.95)


def magnifying_glass(variant: str) -> BuiltObject:
    """A reading glass that lies flat, lens to the left and a thick handle to the right along x."""
    rng = variant_rng("magnifying_glass", variant)
    rim_colour = {"brass": (206, 164, 82), "black": (50, 50, 54)}[variant]
    radius, thick, middle = 0.038, 0.011, (-0.052, 0.0, 0.0)
    frame = [
        (radius - 0.005, 0),
        (radius - 0.001, 0),
        (radius, 0.0015),
        (radius, thick - 0.0015),
        (radius - 0.001, thick),
    ]
    rim = solids.moved(solids.revolved([*frame, (radius - 0.005, thick)], 56), middle)
    glass_profile = [(0, 0.0034), (radius - 0.0045, 0.0042), (radius - 0.0045, 0.0066), (0.02, 0.0078), (0, 0.0082)]
    glass = solids.moved(solids.revolved(glass_profile, 48), middle)
    lens = prints.canvas(256, 256, (188, 214, 226))
    lens = prints.disc(lens, (0.5, 0.5), 0.4, (204, 226, 236))
    lens = packaging.stroke(lens, [(0.24, 0.46), (0.46, 0.24)], 0.06, (246, 251, 253))
    lens = packaging.stroke(lens, [(0.3, 0.6), (0.6, 0.3)], 0.03, (238, 247, 251))
    axis = 0.0104
    neck = shells.rod(0.0046, -0.0165, 0.004, 0.0068, 20)
    x = np.array([0.0, 0.003, 0.012, 0.04, 0.07, 0.08, 0.084])
    scale = np.array([0.7, 0.8, 0.9, 1.0, 0.98, 0.85, 0.6])
    ring = solids.circle(0.0112, 28)
    ring[:, 1] = np.maximum(ring[:, 1], -axis)
    stations = [np.column_stack([np.full(28, at), ring * s + (0, axis)]) for at, s in zip(x, scale, strict=True)]
    handle = solids.closed_rings(stations)
    steel = materials.brushed(rng, rim_colour)
    grip = materials.wood(rng, materials.WALNUT) if variant == "brass" else materials.plastic(rng, (36, 36, 40))
    parts = [
        paint(rim, steel, tiled(0.05), roughness=0.3, metallic=0.4),
        paint(neck, steel, tiled(0.05), roughness=0.3, metallic=0.4),
        paint(glass, lens, from_above(), roughness=0.05),
        paint(handle, grip, tiled(0.1), roughness=0.45),
    ]
    profile = [(radius - 0.005, 0), (radius, 0), (radius, thick), (radius - 0.005, thick)]
    hulls = pieces.ring(profile, 16, middle[:2])
    hulls += [
        pieces.stack([(radius - 0.005, 0.0036), (radius - 0.005, 0.0064), (0.02, 0.008)], 16, middle[:2]),
        pieces.hull(neck.vertices[::2]),
        pieces.hull(handle.vertices[::2]),
    ]
    return BuiltObject(parts, hulls, mass=0.12, friction=0.7)


def glasses_case(variant: str) -> BuiltObject:
    """A closed hard case for glasses, lying along x, the seam in front."""
    rng = variant_rng("glasses_case", variant)
    colour = {"brown": (112, 66, 38), "navy": (36, 50, 86), "red": (156, 36, 44)}[variant]
    wide, deep, tall, seam = 0.16, 0.062, 0.042, 0.022
    outline = solids.rounded_rectangle((wide, deep), 0.026, 9)
    lower = [(0, 0.9, 0.8), (0.002, 0.945, 0.88), (0.008, 0.985, 0.965), (0.015, 1.0, 1.0), (seam - 0.0006, 1.0, 1.0)]
    upper = [(seam + 0.0006, 1.0, 1.0), (0.028, 0.997, 0.99), (0.034, 0.98, 0.94), (0.039, 0.94, 0.84)]
    upper += [(tall - 0.0005, 0.87, 0.66), (tall, 0.8, 0.45)]
    skin = materials.felt(rng, colour, 256)
    skin = (0.55 * skin + 0.45 * np.asarray(colour)).astype(np.uint8)
    lid = np.tile(skin, (1, 2, 1))
    gold = (214, 180, 108)
    edge = solids.rounded_rectangle((0.86, 0.66), 0.16, 6) + 0.5
    lid = packaging.stroke(
        lid, [tuple(p) for p in edge], 0.012, tuple(int(min(255, 1.5 * c)) for c in colour), closed=True
    )
    for x in (0.455, 0.545):
        lid = prints.disc(prints.disc(lid, (x, 0.5), 0.075, gold), (x, 0.5), 0.055, colour)
    lid = packaging.stroke(lid, [(0.485, 0.47), (0.515, 0.47)], 0.022, gold)
    lining = shells.levelled(outline, [(seam - 0.001, 0.985, 0.97), (seam + 0.001, 0.985, 0.97)])
    clasp = solids.rounded_box((0.022, 0.004, 0.012), 0.0016, (0, -deep / 2 + 0.0008, seam - 0.005))
    parts = [
        paint(shells.levelled(outline, lower), skin, tiled(0.08), roughness=0.6),
        paint(shells.levelled(outline, upper), lid, from_above(), roughness=0.6),
        paint(lining, materials.plastic(rng, (30, 28, 28)), tiled(0.05), roughness=0.9),
        paint(clasp, materials.brushed(rng, gold), tiled(0.05), roughness=0.3, metallic=0.4),
    ]
    few = solids.rounded_rectangle((wide, deep), 0.026, 8)
    few = np.repeat(few, 2, axis=0)
    hull = shells.levelled_hull(few, [lower[0], lower[1], lower[3], upper[0], upper[2], upper[4]])
    return BuiltObject(parts, [hull, clasp.convex_hull], mass=0.13, friction=0.7)


def document_tray(variant: str) -> BuiltObject:
    """A low letter tray for half sheets, with a cut-out in front and grips at the sides."""
    rng = variant_rng("document_tray", variant)
    inner, wall, floor, height = (0.22, 0.16), 0.005, 0.0035, 0.038
    shell, _ = shells.open_box(inner, wall, floor, height, 0.008)
    notch = solids.box((0.11, 0.04, 0.1), (0, -inner[1] / 2 - wall / 2, 0.014))
    shell = solids.cut(shell, notch)
    grips = [
        solids.rounded_box((0.011, 0.07, 0.034), 0.004, (side * (inner[0] + wall) / 2, 0, height - 0.028))
        for side in (-1, 1)
    ]
    if variant == "wood":
        skin, roughness = materials.wood(rng, materials.BEECH), 0.65
    else:
        skin, roughness = materials.plastic(rng, {"black": (48, 48, 52), "blue": (58, 104, 160)}[variant]), 0.5
    outer = inner[0] + 2 * wall
    cheek = (outer - 0.11) / 2
    hulls = [piece for piece in pieces.tray(inner, wall, floor, height) if not _is_front(piece)]
    hulls += [
        solids.box((cheek, wall, height - floor), (side * (outer - cheek) / 2, -(inner[1] + wall) / 2, floor))
        for side in (-1, 1)
    ]
    hulls += [solids.box((0.11, wall, 0.014 - floor), (0, -(inner[1] + wall) / 2, floor))]
    hulls += [grip.convex_hull for grip in grips]
    parts = [paint(solids.union(shell, *grips), skin, tiled(0.16), roughness=roughness)]
    parts.append(_plate(inner, wall))
    return BuiltObject(parts, hulls, mass=0.22, friction=0.8)


def _is_front(piece: pieces.Piece) -> bool:
    """Whether a piece of a tray is the front wall: it lies wholly in front of the middle."""
    return bool(piece.bounds[1, 1] < 0)


def _plate(inner: tuple[float, float], wall: float) -> Part:
    """A name plate on the front, below the cut-out."""
    face = packaging.fitted(prints.canvas(256, 48, (250, 249, 244)), "DOCUMENTS", (0.5, 0.5), (0.8, 0.6), (50, 52, 58))
    plate = solids.box((0.05, 0.0008, 0.0094), (0, -inner[1] / 2 - wall - 0.0002, 0.0025))
    return paint(plate, face, from_front(), roughness=0.7)


BUILDERS = {
    "correction_fluid": correction_fluid,
    "document_tray": document_tray,
    "glasses_case": glasses_case,
    "magnifying_glass": magnifying_glass,
    "pen_tray": pen_tray,
}
