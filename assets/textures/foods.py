"""Food: crusts, crumbs, skins, peel and cut cheese, and grains scattered over them."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from vcage.objects.modelling.noise import Colour, blend, clouds, noise, over, shaded

PALE = (232, 192, 128)


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
        brown = np.sqrt(from_middle(shape, 1.15)) * (0.5 + 0.6 * clouds(rng, shape, (4, 4)))
        picture = over(picture, (180, 108, 46), np.clip(brown, 0, 0.8))
    return picture


def peel(rng: np.random.Generator, colour: Colour) -> np.ndarray:
    """Citrus peel: an even colour with fine dimples."""
    shape = (256, 256)
    picture = shaded(np.full((*shape, 3), colour, dtype=np.uint8), 0.93 + 0.1 * clouds(rng, shape, (4, 4)))
    return shaded(picture, 1 - 0.14 * (noise(rng, shape, (70, 90)) > 0.68))


def coordinates(shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Rows and columns of a picture's pixels, from -1 to 1."""
    rows, columns = np.meshgrid(np.linspace(-1, 1, shape[0]), np.linspace(-1, 1, shape[1]), indexing="ij")
    return rows, columns


def from_middle(shape: tuple[int, int], reach: float) -> np.ndarray:
    """1 in the middle of the picture, falling to 0 at ``reach`` of the way to the edge."""
    rows, columns = coordinates(shape)
    return np.clip(1 - (rows**2 + columns**2) / reach**2, 0, 1)


def scattered(
    rng: np.random.Generator, picture: np.ndarray, colours: Sequence[Colour], count: int, length: int, reach: float
) -> np.ndarray:
    """Short strokes of the colours at random places within ``reach`` of the middle."""
    return strokes(rng, picture, colours, rng.uniform(-reach, reach, (count, 2)), length)


def strokes(
    rng: np.random.Generator, picture: np.ndarray, colours: Sequence[Colour], places: np.ndarray, length: int
) -> np.ndarray:
    """Short strokes of the colours in random directions at places (n, 2) from -1 to 1, to the right and down."""
    out = np.ascontiguousarray(picture).copy()
    size = np.array(out.shape[1::-1])
    turns = rng.uniform(0, np.pi, len(places))
    for i, (place, turn) in enumerate(zip(places, turns, strict=True)):
        middle = (place + 1) / 2 * size
        step = np.array([np.cos(turn), np.sin(turn)]) * length / 2
        start, end = (middle - step).round().astype(int), (middle + step).round().astype(int)
        colour = tuple(int(c) for c in colours[i % len(colours)])
        cv2.line(out, tuple(start.tolist()), tuple(end.tolist()), colour, 3, cv2.LINE_AA)
    return out


def glossy_skin(rng: np.random.Generator, low: Colour, high: Colour, pole: Colour | None = None) -> np.ndarray:
    """An even skin around an upright fruit, rows from the top down; ``pole`` tints it around the stem."""
    shape = (256, 256)
    picture = blend(low, high, clouds(rng, shape, (4, 4)))
    if pole is not None:
        from_top = np.linspace(0, 1, shape[0])[:, None] + 0.06 * (clouds(rng, shape, (3, 12)) - 0.5)
        picture = over(picture, pole, np.clip(1 - from_top / 0.22, 0, 1) * 0.65)
    return picture


def cheese(rng: np.random.Generator, colour: Colour, veins: Colour | None = None, size: int = 256) -> np.ndarray:
    """Cut cheese; blue cheese has veins."""
    shape = (size, size)
    picture = shaded(np.full((*shape, 3), colour, dtype=np.uint8), 0.95 + 0.08 * clouds(rng, shape, (5, 5)))
    if veins is not None:
        lines = np.clip(1 - np.abs(clouds(rng, shape, (5, 5), 4) - 0.5) * 20, 0, 1)
        picture = over(picture, veins, lines * (clouds(rng, shape, (4, 4)) > 0.45) * 0.75)
        picture = over(picture, veins, np.clip((noise(rng, shape, (22, 22)) - 0.82) * 6, 0, 0.8))
    return picture
