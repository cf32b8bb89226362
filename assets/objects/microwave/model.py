"""A small microwave oven with its door to the front, hinged at the left, and a vertical handle at the right."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_front, six_sides, tiled
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, MovingPart, paint, variant_rng
from vcage.schema.asset import Joint

Spans = Sequence[tuple[float, float]]

OVEN = (0.34, 0.172, 0.205)
"""Width, depth without the door, and height of a microwave oven, metres."""

FRONT = -0.057
"""Where the oven's box begins, y in metres; the door and its handle lie before it."""

CAVITY = ((-0.156, 0.080), (FRONT - 0.001, 0.101), (0.022, 0.189))
"""The room inside, from … to along x, y, z, metres."""

DOOR = (0.256, 0.018, 0.193)
"""Width, thickness and height of the oven's door, metres."""

VARIANTS = {
    "white": ((232, 232, 228), (226, 226, 222), (238, 238, 234), (60, 62, 68)),
    "steel": ((168, 171, 176), (188, 191, 196), (34, 36, 40), (228, 228, 230)),
    "red": ((176, 36, 36), (184, 40, 38), (232, 226, 214), (70, 40, 36)),
}
"""Variant → shell, frame, panel, ink."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("microwave", variant)
    shell, frame, panel, ink = VARIANTS[variant]
    width, depth, height = OVEN
    middle = FRONT + depth / 2
    room = _between(CAVITY)
    lining = _between(CAVITY, 0.002)
    body = solids.rounded_box((width, depth, height - 0.006), 0.006, (0, middle, 0.006), steps=2)
    feet = [solids.box((0.03, 0.03, 0.008), (x, middle + y, 0)) for x in (-0.13, 0.13) for y in (-0.06, 0.06)]
    centre = (CAVITY[0][0] + CAVITY[0][1]) / 2
    plate = solids.moved(
        solids.revolved([(0, 0), (0.067, 0), (0.07, 0.003), (0.07, 0.006), (0.066, 0.004), (0, 0.004)], 40),
        (centre, 0.022, CAVITY[2][0]),
    )
    # Flat for physics, so that things stand on the plate's middle as they seem to.
    flat = pieces.stack([(0.07, CAVITY[2][0]), (0.07, CAVITY[2][0] + 0.004)], centre=(centre, 0.022))
    right = solids.rounded_box(
        (width / 2 - 0.088, DOOR[1], DOOR[2]), 0.003, ((0.088 + width / 2) / 2, FRONT - DOOR[1] / 2, 0.010), steps=2
    )
    picture = prints.atlas({"front": _microwave_panel((384, 820), panel, ink)}, panel, (384, 820))
    vents = prints.canvas(256, 256, shell)
    for i in range(9):
        vents = prints.rectangle(vents, (0.55, 0.2 + 0.035 * i), (0.85, 0.213 + 0.035 * i), (30, 30, 32))
    sides = prints.atlas(dict.fromkeys(("left", "right", "back"), vents), shell, (256, 256))
    metal = 0.35 if variant == "steel" else 0.0
    parts = [
        paint(solids.cut(body, lining), sides, six_sides(), roughness=0.4, metallic=metal),
        paint(solids.cut(lining, room), materials.plastic(rng, (206, 206, 202)), tiled(0.1), roughness=0.5),
        paint(right, picture, six_sides(), roughness=0.4),
        paint(plate, materials.plastic(rng, (196, 216, 216)), tiled(0.1), roughness=0.15),
        paint(solids.union(*feet), materials.plastic(rng, (28, 28, 30)), tiled(0.05), roughness=0.9),
    ]
    hulls = [*_oven_walls(), right.convex_hull, flat, *feet]
    return BuiltObject(parts, hulls, mass=9.5, friction=1.0, moving=[_door(rng, variant, frame)])


def _oven_walls() -> list[pieces.Piece]:
    (left, right), (_, back), (floor, ceiling) = CAVITY
    x, front, end, top = OVEN[0] / 2, FRONT, FRONT + OVEN[1], OVEN[2]
    spans = [
        ((-x, x), (front, end), (0.006, floor)),
        ((-x, x), (front, end), (ceiling, top)),
        ((-x, left), (front, end), (floor, ceiling)),
        ((right, x), (front, end), (floor, ceiling)),
        ((left, right), (back, end), (floor, ceiling)),
    ]
    return [_between(span) for span in spans]


def _door(rng: np.random.Generator, variant: str, frame: Colour) -> MovingPart:
    """The door with its window, and a bar handle that stands 4 cm out."""
    left, near = -OVEN[0] / 2, FRONT - 0.001 - DOOR[1]
    middle, low = left + DOOR[0] / 2, 0.010
    leaf = solids.rounded_box(DOOR, 0.003, (middle, near + DOOR[1] / 2, low), steps=2)
    x, z, length = left + DOOR[0] - 0.018, low + DOOR[2] / 2, 0.12
    bar = solids.rounded_box((0.014, 0.014, length), 0.004, (x, near - 0.034, z - length / 2))
    posts = [
        solids.box((0.011, 0.034, 0.012), (x, near - 0.016, z + side * (length / 2 - 0.012) - 0.006))
        for side in (-1, 1)
    ]
    seal = solids.box((0.22, 0.001, 0.15), (middle - 0.003, near + DOOR[1], low + 0.022))
    picture = _microwave_door((768, 580), frame)
    grip = materials.brushed(rng) if variant == "red" else materials.plastic(rng, (70, 73, 78))
    parts = [
        paint(leaf, prints.atlas({"front": picture}, frame, (768, 580)), six_sides(), roughness=0.35),
        paint(seal, materials.plastic(rng, (40, 40, 42)), from_front(), roughness=0.7),
        paint(solids.union(bar, *posts), grip, tiled(0.05, along=2), roughness=0.3, metallic=0.4),
    ]
    hinge = Joint(
        kind="turn",
        origin=(left + 0.002, near + DOOR[1] / 2, 0.0),
        axis=(0.0, 0.0, -1.0),
        lower=0.0,
        upper=1.0,
        damping=1.0,
        friction=0.3,
    )
    return MovingPart("door", parts, [leaf.convex_hull, bar.convex_hull, *posts], mass=0.6, joint=hinge)


def _between(spans: Spans, grown: float = 0.0) -> solids.Solid:
    """The box with these limits along x, y and z; ``grown`` on all sides but the front."""
    lower, upper = np.array(spans, dtype=np.float64).T
    lower, upper = lower - [grown, 0, grown], upper + grown
    return solids.box(upper - lower, [*(lower + upper)[:2] / 2, lower[2]])


def _microwave_door(size: tuple[int, int], frame: Colour) -> np.ndarray:
    """The front of a microwave oven's door: a dark window with a perforated screen."""
    picture = prints.rectangle(prints.canvas(*size, frame), (0.06, 0.09), (0.81, 0.91), (20, 21, 24))
    picture = prints.rectangle(picture, (0.12, 0.17), (0.75, 0.83), (46, 46, 48))
    for row in range(22):
        for column in range(30):
            at = (0.13 + 0.021 * column, 0.185 + 0.03 * row)
            picture = prints.disc(picture, at, 0.007, (26, 25, 26))
    picture = prints.text(picture, "Wellmark", (0.435, 0.135), 0.042, (200, 200, 204))
    # A soft reflection of a window, so that the pane reads as glass.
    glare = np.array([[0.5, 0.17], [0.62, 0.17], [0.42, 0.83], [0.3, 0.83]]) * size
    shine = cv2.fillConvexPoly(np.zeros(picture.shape[:2], np.float32), glare.round().astype(np.int32), (0.12,))
    return np.round(picture + shine[..., None] * (255 - picture.astype(np.float32))).astype(np.uint8)


def _microwave_panel(size: tuple[int, int], ground: Colour, ink: Colour) -> np.ndarray:
    """A microwave oven's control panel: a green clock, programmes, a number pad, stop and start."""
    picture = prints.rectangle(prints.canvas(*size, ground), (0.1, 0.06), (0.9, 0.19), (14, 18, 16))
    picture = prints.text(picture, "12:30", (0.5, 0.125), 0.085, (90, 240, 140))
    button = [int(0.82 * g + 0.18 * i) for g, i in zip(ground, ink, strict=True)]
    for i, words in enumerate(("POPCORN", "DEFROST", "REHEAT", "POWER")):
        x, y = 0.3 + 0.4 * (i % 2), 0.275 + 0.085 * (i // 2)
        picture = prints.rectangle(picture, (x - 0.18, y - 0.032), (x + 0.18, y + 0.032), button)
        picture = prints.text(picture, words, (x, y), 0.026, ink)
    for i, key in enumerate("123456789"):
        picture = _key(picture, key, (0.22 + 0.28 * (i % 3), 0.47 + 0.095 * (i // 3)), button, ink)
    picture = _key(picture, "0", (0.5, 0.755), button, ink)
    for x, words, colour in ((0.3, "STOP", (190, 52, 44)), (0.7, "START", (46, 140, 76))):
        picture = prints.rectangle(picture, (x - 0.18, 0.84), (x + 0.18, 0.93), colour)
        picture = prints.text(picture, words, (x, 0.885), 0.038)
    return picture


def _key(picture: np.ndarray, legend: str, at: tuple[float, float], ground: Colour, ink: Colour) -> np.ndarray:
    picture = prints.rectangle(picture, (at[0] - 0.115, at[1] - 0.037), (at[0] + 0.115, at[1] + 0.037), ground)
    return prints.text(picture, legend, at, 0.05, ink)
