"""A hardcover that lies closed, spine to the left."""

from __future__ import annotations

from vcage.objects.modelling import materials, prints, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"blue": (38, 66, 122), "red": (140, 34, 38), "green": (44, 92, 66)}

TITLES = {"blue": ("THE OPEN", "SEA"), "red": ("A SHORT", "HISTORY"), "green": ("FIELD", "GUIDE")}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("book", variant)
    colour = COLOURS[variant]
    width, depth, height, board = 0.148, 0.205, 0.03, 0.003
    pages = solids.box((width - 0.008, depth - 0.008, height - 2 * board), (0, 0, board))
    covers = [solids.box((width, depth, board), (0, 0, z)) for z in (0, height - board)]
    spine = solids.box((board, depth, height), (-width / 2 + board / 2, 0, 0))
    front = materials.felt(rng, tuple(min(255, int(c * 1.15)) for c in colour), 256)
    front = prints.rectangle(front, (0.08, 0.06), (0.92, 0.07), (222, 190, 110))
    front = prints.rectangle(front, (0.08, 0.93), (0.92, 0.94), (222, 190, 110))
    title = TITLES[variant]
    front = prints.text(front, title[0], (0.5, 0.3), 0.11, (240, 224, 180))
    front = prints.text(front, title[1], (0.5, 0.45), 0.11, (240, 224, 180))
    front = prints.disc(front, (0.5, 0.71), 0.07, (222, 190, 110))
    parts = [
        paint(pages, materials.page_edges(rng), tiled(0.03), roughness=0.95),
        paint(solids.union(*covers, spine), front, from_above(), roughness=0.7),
    ]
    return BuiltObject(parts, [solids.box((width, depth, height))], mass=0.5, friction=0.6)
