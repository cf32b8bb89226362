"""Appliances with a hinge: a laptop computer and a microwave oven."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vcage.objects.builders import pieces, solids
from vcage.objects.builders.mappings import from_above, from_front, six_sides, tiled
from vcage.objects.builders.parts import BuiltObject, MovingPart, paint, variant_rng
from vcage.objects.builders.plates import upright
from vcage.objects.textures import materials, prints, screens
from vcage.objects.textures.noise import Colour
from vcage.schema.asset import Joint

Spans = Sequence[tuple[float, float]]

# --- laptop ------------------------------------------------------------------------------------------------

WIDTH, DEPTH = 0.30, 0.215
"""Of a laptop, metres, without its lifting tab."""

DECK, CLOSED = 0.017, 0.029
"""Heights of a laptop's keyboard and of its closed lid, metres."""

TAB = 0.032
"""How far a laptop's lifting tab stands out at the front, metres."""


def laptop(variant: str) -> BuiltObject:
    """A rugged laptop, closed, hinge at the back; a rubber tab at the front of the lid lifts the screen."""
    rng = variant_rng("laptop", variant)
    case, keys, ink, rubber = {
        "silver": ((182, 185, 190), (46, 48, 52), (232, 232, 232), (226, 112, 36)),
        "black": ((52, 54, 58), (24, 25, 27), (222, 222, 222), (196, 44, 40)),
        "blue": ((52, 78, 118), (28, 32, 40), (226, 230, 236), (236, 176, 40)),
    }[variant]
    outline = solids.rounded_rectangle((WIDTH, DEPTH), 0.012)
    base = solids.prism(outline, DECK - 0.002, 0.002)
    deck = solids.prism(solids.rounded_rectangle((WIDTH - 0.002, DEPTH - 0.002), 0.011), 0.0012, DECK - 0.001)
    feet = [solids.box((0.03, 0.012, 0.003), (x, y, 0)) for x in (-0.11, 0.11) for y in (-0.085, 0.085)]
    ports = prints.canvas(512, 64, [int(c * 0.9) for c in case])
    for x, width in ((0.1, 0.05), (0.18, 0.03), (0.24, 0.03), (0.85, 0.06)):
        ports = prints.rectangle(ports, (x, 0.35), (x + width, 0.65), (18, 18, 20))
    sides = prints.atlas(dict.fromkeys(("left", "right"), ports), case)
    parts = [
        paint(base, sides, six_sides(), roughness=0.45, metallic=0.2),
        paint(deck, screens.keyboard_deck((1024, 720), case, keys, ink), from_above(), roughness=0.6),
        paint(solids.union(*feet), materials.plastic(rng, (28, 28, 30)), tiled(0.05), roughness=0.9),
    ]
    hulls = [solids.box((WIDTH, DEPTH, DECK - 0.002), (0, 0, 0.002)), *feet]
    return BuiltObject(parts, hulls, mass=2.1, friction=0.9, moving=[_screen(rng, case, rubber)])


def _screen(rng: np.random.Generator, case: Colour, rubber: Colour) -> MovingPart:
    """The lid with the screen on its lower side, and the lifting tab."""
    low = DECK + 0.0015
    shell = solids.prism(solids.rounded_rectangle((WIDTH, DEPTH), 0.012), CLOSED - low - 0.0005, low + 0.0005)
    panel = solids.box((WIDTH - 0.006, DEPTH - 0.008, 0.001), (0, 0, low))
    back = prints.text(prints.canvas(512, 366, case), "NORDVIK", (0.5, 0.5), 0.09, [int(c * 0.6 + 90) for c in case])
    back = prints.rectangle(back, (0.03, 0.04), (0.97, 0.055), [int(c * 0.8) for c in case])
    back = prints.rectangle(back, (0.03, 0.945), (0.97, 0.96), [int(c * 0.8) for c in case])
    front = -DEPTH / 2
    profile = np.concatenate(
        [
            [(front + 0.016, CLOSED - 0.001), (front - 0.0005, CLOSED - 0.004), (front - 0.0015, 0.017)],
            solids.arc((front - TAB + 0.008, 0.024), 0.008, 270, 180, 5),
            solids.arc((front - TAB + 0.008, 0.044), 0.008, 180, 90, 5),
            solids.arc((front - 0.002, 0.042), 0.010, 90, 20, 4),
        ]
    )[::-1]
    tab = upright(profile, 0.013)
    ridges = [upright(_bar(front - 0.012 - 0.005 * i), 0.0144) for i in range(3)]
    # While the lid is closed the screen's upper edge is in front.
    shown = prints.atlas({"bottom": screens.desktop(rng, (640, 458))}, (22, 22, 24), (640, 458))
    atlas = prints.atlas({"top": back}, case, (512, 366))
    parts = [
        paint(shell, atlas, six_sides(), roughness=0.4, metallic=0.2),
        paint(panel, shown, six_sides(), roughness=0.25),
        paint(tab, materials.plastic(rng, rubber), tiled(0.05), roughness=0.85),
        paint(solids.union(*ridges), materials.plastic(rng, [int(c * 0.8) for c in rubber]), tiled(0.05)),
    ]
    hulls = [solids.box((WIDTH, DEPTH, CLOSED - low), (0, 0, low)), *_halves(profile, front)]
    # Holds the screen where it is left: its weight asks for 0.35 N m at most.
    hinge = Joint(
        kind="turn",
        origin=(0.0, DEPTH / 2, low),
        axis=(-1.0, 0.0, 0.0),
        lower=0.0,
        upper=1.75,
        damping=50.0,
        friction=0.6,
    )
    return MovingPart("screen", parts, hulls, mass=0.3, joint=hinge)


def _bar(y: float) -> np.ndarray:
    return np.array([(y - 0.001, 0.024), (y + 0.001, 0.024), (y + 0.001, 0.044), (y - 0.001, 0.044)])


def _halves(profile: np.ndarray, front: float) -> list[pieces.Piece]:
    """The tab in front of the lid, and its root on top of the lid."""
    plate = upright(profile, 0.0135)
    ahead = plate.slice_plane((0, front - 0.001, 0), (0, -1, 0))
    root = plate.slice_plane((0, front - 0.001, 0), (0, 1, 0))
    return [pieces.hull(ahead.vertices), pieces.hull(root.vertices)]


# --- microwave oven ----------------------------------------------------------------------------------------

OVEN = (0.34, 0.172, 0.205)
"""Width, depth without the door, and height of a microwave oven, metres."""

FRONT = -0.057
"""Where the oven's box begins, y in metres; the door and its handle lie before it."""

CAVITY = ((-0.156, 0.080), (FRONT - 0.001, 0.101), (0.022, 0.189))
"""The room inside, from … to along x, y, z, metres."""

DOOR = (0.256, 0.018, 0.193)
"""Width, thickness and height of the oven's door, metres."""


def microwave(variant: str) -> BuiltObject:
    """A small microwave oven with its door to the front, hinged at the left, and a vertical handle at the right."""
    rng = variant_rng("microwave", variant)
    shell, frame, panel, ink = {
        "white": ((232, 232, 228), (226, 226, 222), (238, 238, 234), (60, 62, 68)),
        "steel": ((168, 171, 176), (188, 191, 196), (34, 36, 40), (228, 228, 230)),
        "red": ((176, 36, 36), (184, 40, 38), (232, 226, 214), (70, 40, 36)),
    }[variant]
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
    picture = prints.atlas({"front": screens.microwave_panel((384, 820), panel, ink)}, panel, (384, 820))
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
    picture = screens.microwave_door((768, 580), frame)
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


BUILDERS = {
    "laptop": laptop,
    "microwave": microwave,
}
