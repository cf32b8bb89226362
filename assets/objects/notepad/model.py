"""A thick pad bound with a spiral at its far edge, lying flat."""

from __future__ import annotations

import numpy as np

from assets.textures import packaging
from vcage.objects.modelling import lofts, materials, prints, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"yellow": (248, 224, 120), "white": (250, 249, 242), "kraft": (188, 146, 98)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("notepad", variant)
    colour = COLOURS[variant]
    width, depth, height = 0.066, 0.1, 0.024
    block = solids.box((width - 0.001, depth - 0.001, height - 0.0035), (0, 0, 0.002))
    back = solids.prism(solids.rounded_rectangle((width, depth), 0.004), 0.0022)
    sheet = solids.prism(solids.rounded_rectangle((width, depth), 0.003), 0.0018, height - 0.0018)
    if variant == "kraft":
        page = packaging.fitted(materials.cardboard(rng, colour), "NOTES", (0.5, 0.42), (0.5, 0.12), (66, 46, 30))
        page = packaging.stroke(page, [(0.25, 0.54), (0.75, 0.54)], 0.012, (66, 46, 30))
    else:
        page = _ruled(12, colour)
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
    return lofts.across(outline[::-1, ::-1], width)


def _ruled(lines: int, ground: Colour = (250, 249, 240), ink: Colour = (150, 180, 214), size: int = 256) -> np.ndarray:
    """A ruled sheet with a red margin."""
    page = prints.canvas(size, size, ground)
    for i in range(lines):
        y = 0.14 + 0.84 * i / lines
        page = prints.rectangle(page, (0, y), (1, y + 0.009), ink)
    return prints.rectangle(page, (0.13, 0), (0.142, 1), (222, 120, 120))
