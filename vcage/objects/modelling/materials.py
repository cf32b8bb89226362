"""Materials that cover a whole surface: wood, cardboard, plastic, glaze, metal, paper, cloth; seamless."""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling.noise import Colour, blend, clouds, noise, over, shaded

OAK = ((150, 104, 62), (206, 164, 112))

WALNUT = ((66, 42, 28), (122, 84, 56))

PINE = ((196, 148, 92), (232, 196, 144))

BEECH = ((198, 152, 110), (228, 190, 150))


def wood(
    rng: np.random.Generator, colours: tuple[Colour, Colour] = OAK, size: int = 256, boards: int = 1
) -> np.ndarray:
    """Wood with the grain along the rows; ``boards`` strips of slightly different tone.

    Args:
        rng: seeds the picture.
        colours: of the dark and the light rings.
        size: edge length of the picture, pixels.
        boards: strips that lie side by side.
    """
    shape = (size, size)
    warp = clouds(rng, shape, (5, 2), 3)
    rings = 0.5 + 0.5 * np.sin(2 * np.pi * (warp * 7 + np.arange(size, dtype=np.float32)[:, None] * 3 / size))
    fibre = noise(rng, shape, (size // 2, 6))
    picture = blend(*colours, 0.25 + 0.4 * rings * clouds(rng, shape, (6, 3), 2) + 0.45 * fibre)
    pores = noise(rng, shape, (size // 2, 10)) > 0.93
    picture = over(picture, np.asarray(colours[0]) * 0.7, pores * 0.35)
    if boards > 1:
        tone = rng.uniform(0.88, 1.06, boards)
        strip = np.arange(size) * boards // size
        picture = shaded(picture, np.repeat(tone[strip][:, None], size, axis=1))
        picture[np.flatnonzero(np.diff(strip, append=-1))] = (np.asarray(colours[0]) * 0.45).astype(np.uint8)
    return picture


def cardboard(rng: np.random.Generator, colour: Colour = (186, 144, 96), size: int = 256) -> np.ndarray:
    """Corrugated cardboard: fine flutes along the columns, with flecks of fibre.

    Args:
        rng: seeds the picture.
        colour: RGB.
        size: edge length of the picture, pixels.
    """
    shape = (size, size)
    flutes = 0.5 + 0.5 * np.sin(np.arange(size) * 2 * np.pi * 32 / size)[None]
    tone = 0.94 + 0.08 * clouds(rng, shape, (6, 6)) + 0.02 * flutes
    picture = shaded(np.full((*shape, 3), colour, dtype=np.uint8), tone)
    return over(picture, np.asarray(colour) * 0.7, (noise(rng, shape, (96, 128)) > 0.95) * 0.3)


def plastic(rng: np.random.Generator, colour: Colour, size: int = 64) -> np.ndarray:
    """A plain colour with a breath of unevenness.

    Args:
        rng: seeds the picture.
        colour: RGB.
        size: edge length of the picture, pixels.
    """
    return shaded(np.full((size, size, 3), colour, dtype=np.uint8), 0.97 + 0.05 * clouds(rng, (size, size), (3, 3)))


def speckled(
    rng: np.random.Generator, colour: Colour, dots: Colour, share: float = 0.05, size: int = 256
) -> np.ndarray:
    """A ground with small soft dots, as of stoneware glaze or fruit skin.

    Args:
        rng: seeds the picture.
        colour: of the ground.
        dots: their colour.
        share: of the surface that dots cover.
        size: edge length of the picture, pixels.
    """
    picture = plastic(rng, colour, size)
    spots = noise(rng, (size, size), (size // 4, size // 4))
    limit = np.quantile(spots, 1 - share)
    return over(picture, dots, np.clip((spots - limit) * 12, 0, 0.8))


def brushed(rng: np.random.Generator, colour: Colour = (196, 198, 202), size: int = 128) -> np.ndarray:
    """Brushed metal.

    Args:
        rng: seeds the picture.
        colour: RGB.
        size: edge length of the picture, pixels.
    """
    return shaded(
        np.full((size, size, 3), colour, dtype=np.uint8), 0.9 + 0.15 * noise(rng, (size, size), (size // 2, 3))
    )


def felt(rng: np.random.Generator, colour: Colour, size: int = 128) -> np.ndarray:
    """Felt or another rough cloth.

    Args:
        rng: seeds the picture.
        colour: RGB.
        size: edge length of the picture, pixels.
    """
    shape = (size, size)
    return shaded(
        np.full((*shape, 3), colour, dtype=np.uint8),
        0.72 + 0.3 * noise(rng, shape, (64, 64)) + 0.25 * clouds(rng, shape),
    )


def page_edges(rng: np.random.Generator, colour: Colour = (238, 232, 214), size: int = 128) -> np.ndarray:
    """The edges of a pile of sheets: fine lines along the rows.

    Args:
        rng: seeds the picture.
        colour: RGB.
        size: edge length of the picture, pixels.
    """
    lines = np.repeat(rng.uniform(0.8, 1.0, size)[:, None], size, axis=1)
    return shaded(np.full((size, size, 3), colour, dtype=np.uint8), lines * (0.97 + 0.05 * clouds(rng, (size, size))))


def wicker(rng: np.random.Generator, colour: Colour = (176, 128, 78), size: int = 256, weave: int = 8) -> np.ndarray:
    """Woven strips, over and under by turns.

    Args:
        rng: seeds the picture.
        colour: RGB.
        size: edge length of the picture, pixels.
        weave: strands across the picture.
    """
    rows, columns = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    cell = size // weave
    over_under = ((rows // cell + columns // cell) % 2).astype(bool)
    across = np.sin(np.pi * (rows % cell) / cell) * (0.75 + 0.25 * np.sin(np.pi * (columns % cell) / cell))
    down = np.sin(np.pi * (columns % cell) / cell) * (0.75 + 0.25 * np.sin(np.pi * (rows % cell) / cell))
    tone = 0.6 + 0.5 * np.where(over_under, across, down)
    return shaded(
        np.full((size, size, 3), colour, dtype=np.uint8), tone * (0.9 + 0.2 * clouds(rng, (size, size), (8, 8)))
    )


REFLECTIONS = ((0.06, 0.035, -0.30), (0.17, 0.06, 0.22), (0.33, 0.03, -0.26), (0.46, 0.05, 0.3), (0.62, 0.04, -0.34))
"""Dark and bright streaks of a room as a round body shows it: position and width as shares of a turn, strength."""


def polished(colour: Colour, size: int = 256) -> np.ndarray:
    """Polished metal to be wrapped once around a body of revolution: upright streaks, seamless."""
    share = (np.arange(size) + 0.5) / size
    tone = np.full(size, 0.95)
    for position, width, strength in (*REFLECTIONS, (0.82, 0.07, 0.2)):
        distance = np.abs((share - position + 0.5) % 1 - 0.5)
        tone += strength * np.exp(-((distance / width) ** 2))
    picture = np.full((size // 4, size, 3), colour, dtype=np.uint8)
    return shaded(picture, np.broadcast_to(tone, picture.shape[:2]))
