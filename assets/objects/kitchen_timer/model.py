"""A weighted round timer; a dial with a grip across it turns clockwise on top."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from assets.shapes.dial import dial_joint
from assets.textures.dials import on_circle, ray
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.lofts import across
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, MovingPart, paint, variant_rng

VARIANTS = {
    "red": ((200, 42, 38), (246, 244, 238), (34, 34, 36)),
    "white": ((238, 236, 230), (60, 64, 70), (244, 244, 240)),
    "mint": ((120, 194, 172), (248, 246, 240), (40, 66, 62)),
}
"""Variant → colour, face, ink."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("kitchen_timer", variant)
    colour, face, ink = VARIANTS[variant]
    outer = [(0, 0), (0.031, 0), (0.033, 0.002), (0.033, 0.034), (0.0315, 0.0375), (0.029, 0.0385), (0, 0.0385)]
    foot = solids.revolved([(0, 0), (0.0333, 0), (0.0333, 0.006), (0, 0.006)], 48)
    pointer = solids.box((0.0035, 0.0012, 0.016), (0, -0.0331, 0.019))
    parts = [
        paint(solids.revolved(outer, 48), materials.plastic(rng, colour), tiled(0.05), roughness=0.35),
        paint(foot, materials.plastic(rng, (44, 44, 48)), tiled(0.05), roughness=0.8),
        paint(pointer, materials.plastic(rng, ink if variant != "white" else (200, 40, 36)), tiled(0.05)),
    ]
    hulls = [pieces.stack([(0.0333, 0), (0.0333, 0.006), (0.033, 0.034), (0.029, 0.0385)])]
    return BuiltObject(parts, hulls, mass=0.9, friction=1.0, moving=[_dial(rng, colour, face, ink)])


def _dial(rng: np.random.Generator, colour: Colour, face: Colour, ink: Colour) -> MovingPart:
    """A disc with minutes and a grip that points to the front."""
    disc = solids.revolved([(0, 0.0395), (0.0285, 0.0395), (0.0285, 0.0415), (0.0275, 0.0425), (0, 0.0425)], 48)
    profile = np.concatenate(
        [
            [(-0.016, 0.042), (0.016, 0.042)],
            solids.arc((0.011, 0.062), 0.005, 0, 90, 5),
            solids.arc((-0.011, 0.062), 0.005, 90, 180, 5),
        ]
    )
    grip = across(profile, 0.012)
    mark = solids.box((0.003, 0.016, 0.0006), (0, -0.004, 0.0669))
    picture = _minute_ring(384, face, ink, [str(5 * i) for i in range(12)])
    parts = [
        paint(disc, picture, from_above(), roughness=0.5),
        paint(grip, materials.plastic(rng, colour), tiled(0.05), roughness=0.4),
        paint(mark, materials.plastic(rng, face if face[0] > 100 else ink), tiled(0.05)),
    ]
    hulls = [pieces.stack([(0.0285, 0.0395), (0.0285, 0.0425)]), pieces.hull(grip.vertices)]
    return MovingPart("dial", parts, hulls, mass=0.04, joint=dial_joint((0.0, 0.0, 0.04)))


def _minute_ring(size: int, ground: Colour, ink: Colour, labels: Sequence[str]) -> np.ndarray:
    """A round dial that fills the picture: marks at its edge, and labels in order counter-clockwise.

    The first label is at the picture's lower edge; turning the dial clockwise brings the next ones there.
    """
    picture = prints.canvas(size, size, ground)
    for mark in range(4 * len(labels)):
        length = 0.07 if mark % 4 == 0 else 0.035
        angle = np.pi + mark * 2 * np.pi / (4 * len(labels))
        picture = ray(picture, angle, (0.485 - length, 0.485), 0.014 if mark % 4 == 0 else 0.007, ink)
    for i, label in enumerate(labels):
        angle = np.pi - i * 2 * np.pi / len(labels)
        turn = 180 - np.degrees(angle)
        picture = prints.text(picture, label, on_circle(angle, 0.345), 0.1, ink, turn=turn)
    return picture
