"""Food: crusts, crumbs, icing and skins."""

from __future__ import annotations

import cv2
import numpy as np

from vcage.objects.textures.noise import Colour, blend, clouds, noise, over, shaded

PALE, GOLD, BROWN = (232, 192, 128), (204, 142, 72), (128, 74, 32)


def plain_crust(rng: np.random.Generator, colour: Colour = (188, 124, 62), size: int = 128) -> np.ndarray:
    """An even, slightly mottled crust."""
    return shaded(np.full((size, size, 3), colour, dtype=np.uint8), 0.8 + 0.35 * clouds(rng, (size, size), (5, 5)))


def crumb(rng: np.random.Generator, toasted: bool = False, size: int = 192) -> np.ndarray:
    """The inside of bread, with pores; browned towards the middle when toasted."""
    shape = (size, size)
    picture = blend((232, 214, 174), (250, 240, 214), clouds(rng, shape, (6, 6)))
    picture = over(picture, (214, 188, 138), np.clip((noise(rng, shape, (30, 30)) - 0.8) * 5, 0, 0.6))
    picture = over(picture, (206, 178, 126), (noise(rng, shape, (60, 60)) > 0.86) * 0.5)
    if toasted:
        brown = np.sqrt(_from_middle(shape, 1.15)) * (0.5 + 0.6 * clouds(rng, shape, (4, 4)))
        picture = over(picture, (180, 108, 46), np.clip(brown, 0, 0.8))
    return picture


def tinted_crumb(rng: np.random.Generator, colour: Colour, grains: bool = False, size: int = 192) -> np.ndarray:
    """Soft crumb of a colour with fine pores, and with grains when it is wholegrain bread."""
    shape = (size, size)
    picture = shaded(np.full((*shape, 3), colour, dtype=np.uint8), 0.93 + 0.1 * clouds(rng, shape, (6, 6)))
    picture = over(picture, np.asarray(colour) * 0.8, np.clip((noise(rng, shape, (34, 34)) - 0.8) * 5, 0, 0.6))
    return _scattered(rng, picture, [(98, 62, 32), (236, 214, 160)], 70, 4, 1.0) if grains else picture


def baguette_crust(rng: np.random.Generator, dark: bool = False) -> np.ndarray:
    """A crust around a loaf: rows run along it, columns around with the back in the middle.

    Gold with brown sides, dusted with flour; pale slanting cuts with dark lips across the back.
    """
    shape = (320, 384)
    gold, brown = ((178, 108, 48), (98, 52, 22)) if dark else ((214, 148, 72), (154, 90, 38))
    rows, columns = _coordinates(shape)
    around, along = rows * 3.2, columns  # 1 is about 55 degrees from the top
    picture = blend(gold, brown, 0.15 + 0.3 * np.clip(np.abs(around), 0, 2) ** 2 / 2 + 0.6 * (clouds(rng, shape) - 0.5))
    dust = np.clip(clouds(rng, shape, (10, 12)) - 0.45, 0, 1) * np.clip(1.6 - np.abs(around), 0, 1)
    picture = over(picture, (250, 240, 222), dust * 1.3)
    for place in (-0.62, -0.12, 0.38):
        cut = ((along - place - 0.13 * around) / 0.125) ** 2 + (around / 0.95) ** 2
        picture = over(picture, brown, np.clip(1.6 - cut, 0, 1) * 0.85)
        picture = over(picture, PALE, np.clip((0.95 - cut) * 3, 0, 1) * (0.75 + 0.25 * clouds(rng, shape, (8, 8))))
    return np.ascontiguousarray(np.rot90(picture))


def croissant_crust(rng: np.random.Generator, dark: bool = False) -> np.ndarray:
    """Rolled dough: columns run along the roll, rows up from the bottom; each turn is dark at its edge."""
    shape = (128, 512)
    share = np.linspace(-1, 1, shape[1])
    steps = np.abs(share) * 4.2
    edge = (steps - np.floor(steps))[None]
    gold, brown = ((196, 122, 52), (110, 58, 22)) if dark else ((222, 160, 84), (158, 92, 38))
    mottle = clouds(rng, shape, (3, 12)) - 0.5
    layers = 0.5 + 0.5 * np.sin(edge * 24)
    picture = blend(gold, brown, 0.12 + 0.75 * edge**3 + 0.7 * mottle + 0.1 * layers)
    return over(picture, PALE, np.clip(0.25 - edge, 0, 1) * 2.2 * (0.6 + mottle))


def roll_crust(rng: np.random.Generator, *, seeds: bool = False, size: int = 320) -> np.ndarray:
    """A round roll spread out from its top: pale gold, browner below, dusted with flour, perhaps with poppy seeds."""
    shape = (size, size)
    inner = _from_middle(shape, 0.9)
    picture = blend((176, 112, 52), (224, 178, 112), 0.1 + 1.1 * inner + 0.5 * (clouds(rng, shape, (5, 5)) - 0.5))
    flour = np.clip(clouds(rng, shape, (12, 12)) - 0.36, 0, 1) * np.clip(inner * 2.4 - 0.3, 0, 1)
    picture = over(picture, (252, 246, 234), flour * (1.4 if seeds else 2.6))
    return _scattered(rng, picture, [(44, 42, 46)], count=220, length=3, reach=0.66) if seeds else picture


def bagel_crust(rng: np.random.Generator, seeds: bool, size: int = 576) -> np.ndarray:
    """A bagel's skin spread out as a disc: the top of the ring half-way out, its underside in the middle and outside.

    Chestnut brown, paler below; sesame seeds lie thick on the top.
    """
    shape = (size, size)
    away = np.hypot(*_coordinates(shape))
    top = np.clip(1 - ((away - 0.47) / 0.4) ** 2, 0, 1)
    picture = blend((218, 162, 94), (142, 76, 32), 0.05 + 0.95 * top + 0.5 * (clouds(rng, shape, (5, 5)) - 0.5))
    blisters = noise(rng, shape, (40, 40)) > 0.9
    picture = over(picture, (214, 160, 98), blisters * top * 0.5)
    if not seeds:
        return picture
    turn, far = rng.uniform(0, 2 * np.pi, 480), rng.normal(0.47, 0.11, 480).clip(0.26, 0.72)
    places = np.column_stack([far * np.cos(turn), far * np.sin(turn)])
    return _strokes(rng, picture, [(250, 236, 200), (238, 216, 166)], places, length=5)


def pretzel_crust(rng: np.random.Generator, salted: bool, size: int = 384) -> np.ndarray:
    """Lye crust for all sides: deep brown, with grains of coarse salt."""
    shape = (size, size)
    picture = blend((104, 46, 18), (168, 88, 36), clouds(rng, shape, (7, 7)) * 1.3 - 0.15)
    if not salted:
        return picture
    return _scattered(rng, picture, [(252, 250, 246), (236, 232, 224)], count=260, length=3, reach=0.98)


def sprinkles(rng: np.random.Generator, icing: Colour, size: int = 256) -> np.ndarray:
    """Icing with coloured sprinkles."""
    ground = shaded(np.full((size, size, 3), icing, dtype=np.uint8), 0.95 + 0.08 * clouds(rng, (size, size)))
    colours = [(250, 250, 250), (250, 214, 60), (90, 180, 230), (120, 200, 110), (230, 60, 90)]
    return _scattered(rng, ground, colours, count=170, length=10, reach=1.0)


def fruit_skin(rng: np.random.Generator, low: Colour, high: Colour, streaks: bool = False) -> np.ndarray:
    """Skin around a fruit: rows from the stem (top) to the bottom, columns around."""
    shape = (256, 256)
    pattern = clouds(rng, shape, (2, 40) if streaks else (4, 4), 3)
    picture = blend(low, high, (pattern - 0.5) * 2.2 + 0.5)
    return over(picture, (250, 236, 190), (noise(rng, shape, (56, 64)) > 0.9) * 0.25)


def banana_skin(rng: np.random.Generator, ripe: bool = True) -> np.ndarray:
    """Columns from stem to tip, rows from the bottom up; brown ends, and freckles when ripe."""
    shape = (96, 384)
    low, high = ((232, 186, 44), (250, 216, 84)) if ripe else ((168, 186, 62), (226, 214, 88))
    picture = blend(low, high, clouds(rng, shape, (3, 10)) * 1.6 - 0.3)
    place = np.linspace(0, 1, shape[1])[None] * np.ones((shape[0], 1))
    picture = over(picture, (138, 150, 60), np.clip(1 - place / 0.16, 0, 0.7))
    picture = over(picture, (64, 44, 24), np.clip((0.03 - place) * 60, 0, 0.85) + np.clip((place - 0.965) * 60, 0, 0.9))
    if ripe:
        picture = over(picture, (112, 70, 28), np.clip((noise(rng, shape, (22, 70)) - 0.84) * 8, 0, 0.8))
    return picture


def peel(rng: np.random.Generator, colour: Colour) -> np.ndarray:
    """Citrus peel: an even colour with fine dimples."""
    shape = (256, 256)
    picture = shaded(np.full((*shape, 3), colour, dtype=np.uint8), 0.93 + 0.1 * clouds(rng, shape, (4, 4)))
    return shaded(picture, 1 - 0.14 * (noise(rng, shape, (70, 90)) > 0.68))


def _coordinates(shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Rows and columns of a picture's pixels, from -1 to 1."""
    rows, columns = np.meshgrid(np.linspace(-1, 1, shape[0]), np.linspace(-1, 1, shape[1]), indexing="ij")
    return rows, columns


def _from_middle(shape: tuple[int, int], reach: float) -> np.ndarray:
    """1 in the middle of the picture, falling to 0 at ``reach`` of the way to the edge."""
    rows, columns = _coordinates(shape)
    return np.clip(1 - (rows**2 + columns**2) / reach**2, 0, 1)


def _scattered(
    rng: np.random.Generator, picture: np.ndarray, colours: list[Colour], count: int, length: int, reach: float
) -> np.ndarray:
    """Short strokes of the colours at random places within ``reach`` of the middle."""
    return _strokes(rng, picture, colours, rng.uniform(-reach, reach, (count, 2)), length)


def _strokes(
    rng: np.random.Generator, picture: np.ndarray, colours: list[Colour], places: np.ndarray, length: int
) -> np.ndarray:
    """Short strokes of the colours in random directions at places (n, 2) from -1 to 1, to the right and down."""
    out = np.ascontiguousarray(picture)
    size = np.array(out.shape[1::-1])
    turns = rng.uniform(0, np.pi, len(places))
    for i, (place, turn) in enumerate(zip(places, turns, strict=True)):
        middle = (place + 1) / 2 * size
        step = np.array([np.cos(turn), np.sin(turn)]) * length / 2
        start, end = (middle - step).round().astype(int), (middle + step).round().astype(int)
        colour = tuple(int(c) for c in colours[i % len(colours)])
        cv2.line(out, tuple(start.tolist()), tuple(end.tolist()), colour, 3, cv2.LINE_AA)
    return out
