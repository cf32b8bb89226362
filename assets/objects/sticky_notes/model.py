"""A cube of paper slips."""

from __future__ import annotations

from vcage.objects.modelling import materials, prints, solids
from vcage.objects.modelling.mappings import from_above, six_sides
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COLOURS = {"yellow": (250, 226, 92), "pink": (244, 132, 170), "green": (150, 214, 110)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("sticky_notes", variant)
    colour = COLOURS[variant]
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
