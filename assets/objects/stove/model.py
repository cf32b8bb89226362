"""A flat stove: one burner under a glass top, and a knob that turns on the lower strip before it."""

from __future__ import annotations

import numpy as np

from assets.shapes.dial import dial_joint
from assets.textures.dials import ray
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.lofts import across
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, MovingPart, paint, variant_rng

VARIANTS = {
    "black": ((46, 47, 50), 0.0),
    "white": ((236, 235, 230), 0.0),
    "steel": ((180, 183, 188), 0.35),
}
"""Variant → colour of the body, metallic share."""

WIDTH, TOP, STRIP = 0.34, 0.05, 0.014
"""Width; heights of the burner and of the strip with the knob, metres."""

KNOB_AT = (0.0, -0.105)
"""Middle of the knob, x and y in metres."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("stove", variant)
    colour, metallic = VARIANTS[variant]
    coat = materials.plastic(rng, colour, 128)
    block, strip = ((WIDTH, 0.21, TOP - 0.004), (0, 0.035, 0)), ((WIDTH, 0.07, STRIP), (0, KNOB_AT[1], 0))
    glass = solids.rounded_box((WIDTH - 0.012, 0.198, 0.005), 0.002, (0, 0.035, TOP - 0.005), steps=2)
    marks = _marks((28, 28, 30) if sum(colour) > 400 else (232, 232, 228), colour)
    dial = solids.prism(solids.circle(0.031, 40, KNOB_AT), 0.0006, STRIP - 0.0002)
    parts = [
        paint(
            solids.rounded_box(block[0], 0.004, block[1], steps=2), coat, tiled(0.1), roughness=0.4, metallic=metallic
        ),
        paint(
            solids.rounded_box(strip[0], 0.004, strip[1], steps=2), coat, tiled(0.1), roughness=0.4, metallic=metallic
        ),
        paint(glass, _burner(), from_above(), roughness=0.15),
        paint(dial, marks, from_above(), roughness=0.5),
    ]
    hulls = [solids.box((WIDTH, 0.21, TOP), block[1]), solids.box(*strip)]
    return BuiltObject(parts, hulls, mass=3.0, friction=1.0, moving=[_knob(rng, colour)])


def _burner() -> np.ndarray:
    """Dark glass with the rings of one burner."""
    picture = prints.canvas(984, 594, (22, 22, 24))
    for radius, colour in ((0.42, (120, 116, 112)), (0.405, (36, 34, 34)), (0.3, (104, 60, 46)), (0.285, (36, 34, 34))):
        picture = prints.disc(picture, (0.5, 0.5), radius, colour)
    for radius, colour in ((0.18, (104, 60, 46)), (0.165, (36, 34, 34)), (0.02, (120, 116, 112))):
        picture = prints.disc(picture, (0.5, 0.5), radius, colour)
    return picture


def _marks(ink: Colour, ground: Colour) -> np.ndarray:
    """Strokes around the knob: off to the back, then hotter the further it is turned."""
    picture = prints.canvas(384, 384, ground)
    for step in range(7):
        red = (206, 46, 38)
        picture = ray(picture, step * np.pi / 8, (0.42, 0.485), 0.014, ink if step < 5 else red)
    return picture


def _knob(rng: np.random.Generator, colour: Colour) -> MovingPart:
    """A round foot with a grip across it that points to the back when off; it turns clockwise."""
    x, y = KNOB_AT
    shade: Colour = (206, 208, 212) if sum(colour) < 300 else (40, 41, 44)
    foot = [(0, STRIP + 0.001), (0.0225, STRIP + 0.001), (0.0225, STRIP + 0.005), (0.021, STRIP + 0.007)]
    disc = solids.moved(solids.revolved([*foot, (0, STRIP + 0.007)], 40), (x, y, 0))
    profile = np.concatenate(
        [
            [(-0.017, STRIP + 0.006), (0.017, STRIP + 0.006)],
            solids.arc((0.012, 0.041), 0.005, 0, 90, 5),
            solids.arc((-0.012, 0.041), 0.005, 90, 180, 5),
        ]
    )
    grip = solids.moved(across(profile, 0.012), (x, y, 0))
    mark = solids.box((0.003, 0.014, 0.0006), (x, y + 0.006, 0.0459))
    parts = [
        paint(solids.union(disc, grip), materials.plastic(rng, shade), tiled(0.05), roughness=0.4),
        paint(mark, materials.plastic(rng, (206, 46, 38)), tiled(0.05)),
    ]
    hulls = [
        pieces.stack([(0.0225, STRIP + 0.001), (0.0225, STRIP + 0.005), (0.021, STRIP + 0.007)], centre=KNOB_AT),
        pieces.hull(grip.vertices),
    ]
    return MovingPart("knob", parts, hulls, mass=0.04, joint=dial_joint((x, y, STRIP)))
