"""A rugged laptop, closed, hinge at the back; a rubber tab at the front of the lid lifts the screen."""

from __future__ import annotations

import cv2
import numpy as np

from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.lofts import across
from vcage.objects.modelling.mappings import from_above, six_sides, tiled
from vcage.objects.modelling.noise import Colour, blend, clouds
from vcage.objects.modelling.parts import BuiltObject, MovingPart, paint, variant_rng
from vcage.schema.asset import Joint

WIDTH, DEPTH = 0.30, 0.215
"""Of a laptop, metres, without its lifting tab."""

DECK, CLOSED = 0.017, 0.029
"""Heights of a laptop's keyboard and of its closed lid, metres."""

TAB = 0.032
"""How far a laptop's lifting tab stands out at the front, metres."""

KEY_ROWS = (
    ("esc", "1", "2", "3", "4", "5", "6", "7", "8", "9", "0", "-", "=", "del"),
    ("tab", "Q", "W", "E", "R", "T", "Y", "U", "I", "O", "P", "[", "]", "\\"),
    ("caps", "A", "S", "D", "F", "G", "H", "J", "K", "L", ";", "'", "enter"),
    ("shift", "Z", "X", "C", "V", "B", "N", "M", ",", ".", "/", "shift"),
    ("ctrl", "fn", "alt", "", "alt", "<", ">"),
)
"""Legends of a laptop's keyboard, row by row; the empty one is the space bar."""

WIDE = {"": 5.6, "del": 1.4, "tab": 1.4, "\\": 1.2, "caps": 1.7, "enter": 1.9, "shift": 2.2, "ctrl": 1.4}
"""Widths of keys that are not as wide as a letter's."""

VARIANTS = {
    "silver": ((182, 185, 190), (46, 48, 52), (232, 232, 232), (226, 112, 36)),
    "black": ((52, 54, 58), (24, 25, 27), (222, 222, 222), (196, 44, 40)),
    "blue": ((52, 78, 118), (28, 32, 40), (226, 230, 236), (236, 176, 40)),
}
"""Variant → case, keys, ink, rubber."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("laptop", variant)
    case, keys, ink, rubber = VARIANTS[variant]
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
        paint(deck, _keyboard_deck((1024, 720), case, keys, ink), from_above(), roughness=0.6),
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
    tab = across(profile, 0.013)
    ridges = [across(_bar(front - 0.012 - 0.005 * i), 0.0144) for i in range(3)]
    # While the lid is closed the screen's upper edge is in front.
    shown = prints.atlas({"bottom": _desktop(rng, (640, 458))}, (22, 22, 24), (640, 458))
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
    plate = across(profile, 0.0135)
    ahead = plate.slice_plane((0, front - 0.001, 0), (0, -1, 0))
    root = plate.slice_plane((0, front - 0.001, 0), (0, 1, 0))
    return [pieces.hull(ahead.vertices), pieces.hull(root.vertices)]


def _keyboard_deck(size: tuple[int, int], case: Colour, keys: Colour, ink: Colour) -> np.ndarray:
    """The upper side of a laptop's base: keyboard at the back, touch pad in front.

    Args:
        size: (width, height), pixels.
        case: colour of the deck.
        keys: colour of the key caps.
        ink: colour of the legends.
    """
    dark = [int(c * 0.35) for c in case]
    picture = prints.rectangle(prints.canvas(*size, case), (0.045, 0.075), (0.955, 0.625), dark)
    pitch = 0.53 / len(KEY_ROWS)
    for row, legends in enumerate(KEY_ROWS):
        widths = np.array([WIDE.get(legend, 1.0) for legend in legends])
        ends = 0.053 + 0.894 * np.cumsum(widths) / widths.sum()
        top = 0.085 + pitch * row
        for legend, left, right in zip(legends, [0.053, *ends[:-1]], ends, strict=True):
            picture = prints.rectangle(picture, (left + 0.004, top + 0.005), (right - 0.004, top + pitch - 0.008), keys)
            if legend:
                height = 0.042 if len(legend) == 1 else 0.026
                picture = prints.text(picture, legend, ((left + right) / 2, top + pitch / 2), height, ink)
    rim = [int(c * 0.6) for c in case]
    picture = prints.rectangle(picture, (0.345, 0.675), (0.655, 0.955), rim)
    return prints.rectangle(picture, (0.35, 0.681), (0.65, 0.949), [int(c * 0.88) for c in case])


def _desktop(rng: np.random.Generator, size: tuple[int, int], bezel: Colour = (22, 22, 24)) -> np.ndarray:
    """A laptop's screen in its bezel: hills under a sky, a window with text, a row of icons."""
    width, height = size
    shape = (height, width)
    rows = np.linspace(0, 1, height)[:, None]
    screen = blend((66, 132, 206), (196, 224, 240), np.repeat(rows * 1.4, width, axis=1))
    columns = np.linspace(0, 2 * np.pi, width)[None]
    for level, colour in ((0.55, (96, 158, 140)), (0.68, (54, 120, 96)), (0.8, (30, 84, 72))):
        crest = level + 0.05 * np.sin(columns * rng.uniform(0.8, 1.6) + rng.uniform(0, 6))
        crest = crest + 0.05 * (clouds(rng, shape, (2, 4))[:1] - 0.5)
        screen = np.where((rows > crest)[..., None], np.asarray(colour, dtype=np.uint8), screen)
    screen = prints.rectangle(screen, (0.12, 0.14), (0.6, 0.66), (246, 246, 248))
    screen = prints.rectangle(screen, (0.12, 0.14), (0.6, 0.2), (56, 62, 78))
    for i, end in enumerate((0.52, 0.56, 0.48, 0.55, 0.4, 0.53)):
        screen = prints.rectangle(screen, (0.15, 0.26 + 0.062 * i), (end, 0.28 + 0.062 * i), (150, 154, 164))
    screen = prints.rectangle(screen, (0.0, 0.925), (1.0, 1.0), (28, 32, 42))
    icons = [(66, 150, 240), (240, 190, 60), (70, 180, 110), (226, 80, 70), (150, 110, 220)]
    for i, colour in enumerate(icons):
        screen = prints.rectangle(screen, (0.38 + 0.052 * i, 0.94), (0.415 + 0.052 * i, 0.985), colour)
    screen = prints.text(screen, "09:41", (0.94, 0.962), 0.034)
    picture = prints.canvas(width, height, bezel)
    top, left = round(0.055 * height), round(0.03 * width)
    inner = cv2.resize(
        screen, (width - 2 * left, height - 2 * top - round(0.03 * height)), interpolation=cv2.INTER_AREA
    )
    picture[top : top + len(inner), left : left + inner.shape[1]] = inner
    return prints.disc(picture, (0.5, 0.028), 0.008, (70, 80, 96))
