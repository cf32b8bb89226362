"""A low letter tray for half sheets, with a cut-out in front and grips at the sides."""

from __future__ import annotations

from assets.shapes import open_box
from assets.textures import packaging
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_front, tiled
from vcage.objects.modelling.parts import BuiltObject, Part, paint, variant_rng


def build(variant: str) -> BuiltObject:
    rng = variant_rng("document_tray", variant)
    inner, wall, floor, height = (0.22, 0.16), 0.005, 0.0035, 0.038
    shell, _ = open_box.open_box(inner, wall, floor, height, 0.008)
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
