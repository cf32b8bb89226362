"""A microwave oven whose cavity slides out to the front like a drawer, with its controls above."""

from __future__ import annotations

from assets.shapes import joinery
from assets.shapes.joinery import Carcass, DrawerLook, Finish
from vcage.objects.modelling import materials, prints, solids
from vcage.objects.modelling.mappings import from_front, six_sides
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, MovingPart, Part, paint, variant_rng

CARCASS = Carcass(0.30, 0.20, bays=(0.1,), foot=0.012, board=0.006, side=0.008, top=0.034, lip=0.002)
"""Metres. Its bay just clears a mug, so that a hand can set that down over the front rather than drop it."""

VARIANTS = {
    "white": ((232, 232, 228), (238, 238, 234), (60, 62, 68)),
    "steel": ((168, 171, 176), (34, 36, 40), (228, 228, 230)),
    "red": ((176, 36, 36), (232, 226, 214), (70, 40, 36)),
}
"""Variant → shell, panel, ink."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("drawer_microwave", variant)
    shell_colour, panel, ink = VARIANTS[variant]
    metal = 0.35 if variant == "steel" else 0.0
    shell = Finish(materials.plastic(rng, shell_colour, 128), 0.12, 0.4, metal)
    rubber = Finish(materials.felt(rng, (28, 28, 30)), 0.05, 0.9)
    body = CARCASS.build(shell, shell, rubber, "plinth")
    body.parts += [_controls(panel, ink), *_vents(shell_colour)]
    lining = Finish(materials.plastic(rng, (120, 124, 130)), 0.1, 0.5)
    steel = Finish(materials.brushed(rng), 0.05, 0.35, 0.4)
    drawer = joinery.drawer(CARCASS, 0, DrawerLook(shell, lining, steel, steel))
    drawer.parts.append(_window(shell_colour))
    moving = [MovingPart("drawer", drawer.parts, drawer.hulls, 0.9, joinery.slide(CARCASS, 0))]
    return BuiltObject(body.parts, body.hulls, mass=9.5, friction=1.0, moving=moving)


def _controls(panel: Colour, ink: Colour) -> Part:
    """The strip above the drawer: a green clock, programmes, stop and start."""
    wide, high = CARCASS.width - 0.012, CARCASS.top - 0.008
    picture = prints.canvas(1100, 100, panel)
    picture = prints.rectangle(picture, (0.02, 0.14), (0.17, 0.86), (14, 18, 16))
    picture = prints.text(picture, "12:30", (0.095, 0.5), 0.6, (90, 240, 140))
    button = [int(0.82 * g + 0.18 * i) for g, i in zip(panel, ink, strict=True)]
    keys = [(words, button, ink) for words in ("POPCORN", "DEFROST", "REHEAT", "POWER")]
    keys += [("STOP", (190, 52, 44), (255, 255, 255)), ("START", (46, 140, 76), (255, 255, 255))]
    for i, (words, colour, letters) in enumerate(keys):
        x = 0.255 + 0.133 * i
        picture = prints.rectangle(picture, (x - 0.06, 0.2), (x + 0.06, 0.8), colour)
        picture = prints.text(picture, words, (x, 0.5), 0.26, letters)
    strip = solids.box((wide, 0.001, high), (0, CARCASS.face - CARCASS.lip, CARCASS.under_top + 0.004))
    return paint(strip, picture, from_front(), roughness=0.35)


def _window(frame: Colour) -> Part:
    """The front's dark window with a perforated screen, and the maker's name."""
    wide, high = CARCASS.clear - 0.012, CARCASS.bays[0] - 0.014
    size = (1040, round(1040 * high / wide))
    picture = prints.rectangle(prints.canvas(*size, frame), (0.03, 0.08), (0.97, 0.92), (20, 21, 24))
    picture = prints.rectangle(picture, (0.07, 0.17), (0.93, 0.83), (46, 46, 48))
    for row in range(12):
        for column in range(42):
            picture = prints.disc(picture, (0.08 + 0.0205 * column, 0.2 + 0.0545 * row), 0.005, (26, 25, 26))
    picture = prints.text(picture, "Wellmark", (0.88, 0.125), 0.05, (200, 200, 204))
    pane = solids.box((wide, 0.001, high), (0, CARCASS.face, CARCASS.floor(0) + 0.007))
    return paint(pane, picture, from_front(), roughness=0.3)


def _vents(shell: Colour) -> list[Part]:
    """Slots at the back of both sides."""
    picture = prints.canvas(200, 256, shell)
    for i in range(9):
        picture = prints.rectangle(picture, (0.15, 0.2 + 0.07 * i), (0.85, 0.225 + 0.07 * i), (30, 30, 32))
    sides = prints.atlas(dict.fromkeys(("left", "right"), picture), shell, (200, 256))
    x, y, z = CARCASS.width / 2 - CARCASS.lip, CARCASS.back - 0.05, CARCASS.floor(0) + 0.02
    plates = [solids.box((0.001, 0.06, 0.077), (sign * x, y, z)) for sign in (-1, 1)]
    return [paint(plate, sides, six_sides(), roughness=0.5) for plate in plates]
