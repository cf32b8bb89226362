"""Skins of fruit and vegetables, and what cheese and cake look like inside."""

from __future__ import annotations

import numpy as np

from vcage.objects.textures.noise import Colour, blend, clouds, noise, over, shaded


def glossy_skin(rng: np.random.Generator, low: Colour, high: Colour, pole: Colour | None = None) -> np.ndarray:
    """An even skin around an upright fruit, rows from the top down; ``pole`` tints it around the stem."""
    shape = (256, 256)
    picture = blend(low, high, clouds(rng, shape, (4, 4)))
    if pole is not None:
        from_top = np.linspace(0, 1, shape[0])[:, None] + 0.06 * (clouds(rng, shape, (3, 12)) - 0.5)
        picture = over(picture, pole, np.clip(1 - from_top / 0.22, 0, 1) * 0.65)
    return picture


def pear_skin(rng: np.random.Generator, low: Colour, high: Colour, blush: Colour) -> np.ndarray:
    """Pear: a blush on one side and small brown freckles."""
    shape = (256, 256)
    picture = blend(low, high, clouds(rng, shape, (4, 4)))
    side = 0.5 + 0.5 * np.cos(np.linspace(-np.pi, np.pi, shape[1]) - 0.9)[None]
    picture = over(picture, blush, np.clip(side * clouds(rng, shape, (3, 4)) * 1.5 - 0.35, 0, 0.8))
    return over(picture, (122, 92, 40), (noise(rng, shape, (64, 80)) > 0.93) * 0.6)


def potato_skin(rng: np.random.Generator, low: Colour, high: Colour) -> np.ndarray:
    """Earthy skin with darker eyes; seamless."""
    shape = (256, 256)
    picture = blend(low, high, clouds(rng, shape, (5, 5)))
    picture = over(picture, np.asarray(low) * 0.6, np.clip((noise(rng, shape, (9, 6)) - 0.84) * 6, 0, 0.7))
    picture = over(picture, np.asarray(low) * 0.7, (noise(rng, shape, (80, 60)) > 0.92) * 0.5)
    return shaded(picture, 0.9 + 0.16 * noise(rng, shape, (90, 90)))


def carrot_skin(rng: np.random.Generator, low: Colour, high: Colour) -> np.ndarray:
    """Rows run along the carrot: fine rings and short dark creases across it."""
    shape = (384, 128)
    picture = blend(low, high, clouds(rng, shape, (24, 2)))
    return over(picture, np.asarray(low) * 0.62, np.clip((noise(rng, shape, (56, 5)) - 0.83) * 6, 0, 0.6))


def egg_shell(rng: np.random.Generator, colour: Colour, freckled: bool) -> np.ndarray:
    """An egg's shell, brown ones with freckles; seamless."""
    shape = (256, 256)
    picture = shaded(np.full((*shape, 3), colour, dtype=np.uint8), 0.95 + 0.07 * clouds(rng, shape))
    if freckled:
        picture = over(picture, np.asarray(colour) * 0.6, np.clip((noise(rng, shape, (50, 50)) - 0.86) * 8, 0, 0.6))
    return picture


def pulp(rng: np.random.Generator, colour: Colour, size: int = 256) -> np.ndarray:
    """Moulded paper: matt, with short fibres."""
    shape = (size, size)
    picture = shaded(np.full((*shape, 3), colour, dtype=np.uint8), 0.88 + 0.16 * clouds(rng, shape, (20, 20), 3))
    picture = over(picture, np.asarray(colour) * 0.6, (noise(rng, shape, (60, 20)) > 0.93) * 0.35)
    return over(picture, (236, 234, 228), (noise(rng, shape, (24, 60)) > 0.94) * 0.35)


def cheese(rng: np.random.Generator, colour: Colour, veins: Colour | None = None, size: int = 256) -> np.ndarray:
    """Cut cheese; blue cheese has veins."""
    shape = (size, size)
    picture = shaded(np.full((*shape, 3), colour, dtype=np.uint8), 0.95 + 0.08 * clouds(rng, shape, (5, 5)))
    if veins is not None:
        lines = np.clip(1 - np.abs(clouds(rng, shape, (5, 5), 4) - 0.5) * 20, 0, 1)
        picture = over(picture, veins, lines * (clouds(rng, shape, (4, 4)) > 0.45) * 0.75)
        picture = over(picture, veins, np.clip((noise(rng, shape, (22, 22)) - 0.82) * 6, 0, 0.8))
    return picture


def sponge_cake(rng: np.random.Generator, colour: Colour, size: int = 192) -> np.ndarray:
    """The cut face of a cake with fine pores."""
    shape = (size, size)
    picture = shaded(np.full((*shape, 3), colour, dtype=np.uint8), 0.86 + 0.24 * clouds(rng, shape, (10, 10)))
    return over(picture, np.asarray(colour) * 0.66, np.clip((noise(rng, shape, (48, 48)) - 0.78) * 4, 0, 0.6))


def muffin_top(rng: np.random.Generator, colour: Colour, bits: Colour, count: int = 22, size: int = 256) -> np.ndarray:
    """A muffin seen from above: cracked crust, browner at its edge, with berries or pieces of chocolate."""
    shape = (size, size)
    axis = np.linspace(-1, 1, size)
    columns, rows = np.meshgrid(axis, axis)
    away = np.hypot(rows, columns)
    picture = blend(colour, np.asarray(colour) * 0.68, away * 0.9 + 0.7 * (clouds(rng, shape, (6, 6)) - 0.5))
    cracks = np.clip(1 - np.abs(clouds(rng, shape, (5, 5), 4) - 0.52) * 24, 0, 1) * (away < 0.8)
    picture = over(picture, np.asarray(colour) * 0.5, cracks * 0.4)
    for _ in range(count):
        turn, far = rng.uniform(0, 2 * np.pi), 0.62 * np.sqrt(rng.random())
        spot = np.hypot(rows - far * np.sin(turn), columns - far * np.cos(turn)) / rng.uniform(0.045, 0.085)
        picture = over(picture, bits, np.clip((1 - spot) * 5, 0, 0.95))
    return picture


def pleated(rng: np.random.Generator, colour: Colour, pleats: int = 24) -> np.ndarray:
    """A paper case: light and dark pleats around."""
    shape = (96, 20 * pleats)
    wave = np.abs(np.sin(np.arange(shape[1]) * np.pi / 20))[None] ** 0.7
    tone = (0.7 + 0.32 * wave) * (0.95 + 0.08 * clouds(rng, shape, (3, 12)))
    return shaded(np.full((*shape, 3), colour, dtype=np.uint8), tone)
