"""Faces of packed products: fronts with a name and a picture of what is inside, sides with facts and a bar code.

Faces are drawn at the size of the atlas cell that they fill, so that bars stay sharp.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from vcage.objects.textures import prints
from vcage.objects.textures.labels import coded
from vcage.objects.textures.noise import Colour, blend

CREAM: Colour = (252, 246, 230)


def darker(colour: Colour, factor: float = 0.6) -> Colour:
    """The colour times a factor."""
    return tuple(min(255, int(factor * c)) for c in colour)


def fading(size: tuple[int, int], top: Colour, bottom: Colour) -> np.ndarray:
    """A picture of (width, height) pixels that fades from one colour to another."""
    share = np.linspace(0, 1, size[1])[:, None] * np.ones((1, size[0]))
    return blend(top, bottom, share)


def ellipse(
    picture: np.ndarray,
    centre: tuple[float, float],
    radii: tuple[float, float],
    colour: Colour,
    turn: float = 0.0,
    angles: tuple[float, float] = (0, 360),
) -> np.ndarray:
    """The picture with a filled ellipse or a piece of it; ``radii`` are shares of the picture's height."""
    rows, columns = picture.shape[:2]
    at = (round(centre[0] * columns), round(centre[1] * rows))
    axes = (max(1, round(radii[0] * rows)), max(1, round(radii[1] * rows)))
    colour = tuple(int(c) for c in colour)
    return cv2.ellipse(picture.copy(), at, axes, turn, *angles, colour, -1, cv2.LINE_AA)


def brand(
    picture: np.ndarray, words: str, centre: tuple[float, float], height: float, ink: Colour, edge: Colour
) -> np.ndarray:
    """The picture with bold words that have an outline, as brand names do."""
    for reach, colour in ((0.085 * height, edge), (0.03 * height, ink)):
        across = reach * picture.shape[0] / picture.shape[1]
        for turn in np.linspace(0, 2 * np.pi, 12, endpoint=False):
            shifted = (centre[0] + across * np.cos(turn), centre[1] + reach * np.sin(turn))
            picture = prints.text(picture, words, shifted, height, colour)
    return picture


def facts(
    size: tuple[int, int], ground: Colour, names: tuple[str, ...], module: int = 2, share: float = 0.62
) -> np.ndarray:
    """A side panel: a table of facts in grey lines above, the product's bar code (see ``barcode``) below."""
    ink = (120, 116, 108)
    picture = prints.canvas(*size, ground)
    picture = prints.rectangle(picture, (0.1, 0.06), (0.9, 0.46), (250, 250, 246))
    rng = np.random.default_rng(sum(map(ord, "".join(names))))
    for i in range(7):
        y = 0.1 + 0.05 * i
        end = 0.5 + 0.12 * rng.random()
        picture = prints.rectangle(picture, (0.15, y), (end, y + 0.014), ink)
        picture = prints.rectangle(picture, (0.76, y), (0.85, y + 0.014), ink)
    return coded(picture, names, (0.5, 0.74), module, share)


def flakes(picture: np.ndarray, rng: np.random.Generator, colours: Sequence[Colour], ring: bool) -> np.ndarray:
    """A bowl of cereals with milk in the lower half of the picture; ``ring`` for rings instead of flakes."""
    picture = ellipse(picture, (0.5, 0.78), (0.33, 0.24), (56, 92, 160), angles=(0, 180))
    picture = ellipse(picture, (0.5, 0.78), (0.33, 0.1), (240, 244, 250))
    picture = ellipse(picture, (0.5, 0.78), (0.3, 0.08), (250, 250, 244))
    aspect = picture.shape[0] / picture.shape[1]
    for i in range(46):
        turn, reach = rng.uniform(0, 2 * np.pi), np.sqrt(rng.random())
        lift = 0.09 * (1 - reach) * rng.random()
        centre = (0.5 + 0.26 * aspect * reach * np.cos(turn), 0.77 + 0.065 * reach * np.sin(turn) - lift)
        colour = colours[i % len(colours)]
        picture = ellipse(picture, (centre[0], centre[1] + 0.005), (0.034, 0.022), darker(colour), rng.uniform(0, 180))
        picture = ellipse(picture, centre, (0.032, 0.02), colour, rng.uniform(0, 180))
        if ring:
            picture = ellipse(picture, centre, (0.011, 0.007), darker(colour, 0.5))
    return picture


def cookie(
    picture: np.ndarray, rng: np.random.Generator, centre: tuple[float, float], radius: float, *, dark: bool
) -> np.ndarray:
    """The picture with a round cookie; dark ones are sandwiches with cream, light ones have chocolate drops."""
    dough = (62, 40, 30) if dark else (206, 150, 84)
    aspect = picture.shape[0] / picture.shape[1]
    picture = prints.disc(picture, (centre[0] + 0.01, centre[1] + 0.03), radius, darker(dough, 0.5))
    picture = prints.disc(picture, centre, radius, dough)
    if dark:
        for share, colour in ((0.82, darker(dough, 1.35)), (0.72, dough), (0.34, darker(dough, 1.35)), (0.26, dough)):
            picture = prints.disc(picture, centre, share * radius, colour)
        for turn in np.linspace(0, 2 * np.pi, 14, endpoint=False):
            at = (centre[0] + 0.54 * radius * aspect * np.cos(turn), centre[1] + 0.54 * radius * np.sin(turn))
            picture = prints.disc(picture, at, 0.07 * radius, darker(dough, 1.5))
        return picture
    picture = prints.disc(picture, centre, 0.86 * radius, darker(dough, 1.1))
    for _ in range(11):
        turn, reach = rng.uniform(0, 2 * np.pi), 0.78 * radius * np.sqrt(rng.random())
        at = (centre[0] + reach * aspect * np.cos(turn), centre[1] + reach * np.sin(turn))
        picture = prints.disc(picture, at, 0.13 * radius, (66, 36, 20))
    return picture


def fruit(picture: np.ndarray, kind: str, centre: tuple[float, float], radius: float) -> np.ndarray:
    """The picture with an apple, a cut orange or two cherries; ``radius`` as a share of the picture's height."""
    x, y = centre
    across = radius * picture.shape[0] / picture.shape[1]
    if kind == "orange":
        picture = prints.disc(picture, centre, radius, (240, 140, 30))
        picture = prints.disc(picture, centre, 0.88 * radius, (255, 232, 180))
        for i in range(8):
            start = 45 * i + 4
            picture = ellipse(picture, centre, (0.8 * radius, 0.8 * radius), (250, 160, 40), angles=(start, start + 37))
        return picture
    if kind == "apple":
        for side in (-1, 1):
            picture = ellipse(picture, (x + 0.33 * side * across, y), (0.72 * radius, 0.95 * radius), (196, 34, 40))
        picture = ellipse(
            picture, (x - 0.45 * across, y - 0.3 * radius), (0.16 * radius, 0.3 * radius), (240, 130, 120)
        )
        stalk = ((x - 0.05 * across, y - 1.3 * radius), (x + 0.05 * across, y - 0.7 * radius))
        picture = prints.rectangle(picture, *stalk, (90, 60, 30))
        return ellipse(
            picture, (x + 0.42 * across, y - 1.1 * radius), (0.4 * radius, 0.17 * radius), (84, 150, 60), -25
        )
    for side in (-1, 1):
        at = (x + 0.55 * side * across, y + 0.3 * radius)
        top = (x + 0.1 * across, y - 1.1 * radius)
        rows, columns = picture.shape[:2]
        ends = [(round(p[0] * columns), round(p[1] * rows)) for p in (at, top)]
        picture = cv2.line(picture.copy(), *ends, (90, 130, 50), max(1, round(0.1 * radius * rows)), cv2.LINE_AA)
        picture = prints.disc(picture, at, 0.55 * radius, (160, 16, 44))
        shine = (at[0] - 0.18 * across, at[1] - 0.2 * radius)
        picture = prints.disc(picture, shine, 0.12 * radius, (244, 170, 180))
    return ellipse(picture, (x + 0.4 * across, y - 1.05 * radius), (0.35 * radius, 0.16 * radius), (84, 150, 60), -20)


def crisps(picture: np.ndarray, rng: np.random.Generator, centre: tuple[float, float], radius: float) -> np.ndarray:
    """The picture with a fan of potato crisps."""
    across = radius * picture.shape[0] / picture.shape[1]
    for i, turn in enumerate((-35, 30, -12, 12, 0)):
        shift = np.sin(np.radians(turn))
        at = (centre[0] + across * shift, centre[1] + 0.1 * radius * abs(shift) + 0.16 * radius * i)
        gold = (242 - 4 * i, 196 - 5 * i, 92)
        picture = ellipse(picture, (at[0], at[1] + 0.05 * radius), (0.75 * radius, 0.42 * radius), darker(gold), turn)
        picture = ellipse(picture, at, (0.74 * radius, 0.4 * radius), gold, turn)
        for _ in range(9):
            spot = rng.uniform(-0.45, 0.45, 2) * (1.0, 0.5)
            place = (at[0] + across * spot[0], at[1] + radius * spot[1])
            picture = prints.disc(picture, place, 0.03 * radius, (190, 110, 40))
    return picture


def sweets(rng: np.random.Generator, size: tuple[int, int], colours: Sequence[Colour], share: float) -> np.ndarray:
    """A heap of round sweets behind clear plastic; ``share`` is a sweet's radius over the picture's height."""
    picture = prints.canvas(*size, darker(colours[0], 0.45))
    for _ in range(int(2.2 * size[0] / size[1] / share**2)):
        at = tuple(rng.random(2))
        colour = colours[rng.integers(len(colours))]
        picture = prints.disc(picture, at, 1.08 * share, darker(colour, 0.6))
        picture = prints.disc(picture, at, share, colour)
        shine = (at[0] - 0.3 * share * size[1] / size[0], at[1] - 0.35 * share)
        picture = prints.disc(picture, shine, 0.25 * share, darker(colour, 1.5))
    return picture


def chocolate_pieces(picture: np.ndarray, centre: tuple[float, float]) -> np.ndarray:
    """The picture with six squares of chocolate."""
    for i in range(3):
        for j in range(2):
            x, y = centre[0] - 0.09 + 0.075 * i, centre[1] - 0.2 + 0.21 * j
            picture = prints.rectangle(picture, (x, y), (x + 0.07, y + 0.19), (70, 40, 24))
            picture = prints.rectangle(picture, (x + 0.012, y + 0.035), (x + 0.058, y + 0.155), (104, 62, 38))
    return picture


def flash(picture: np.ndarray, centre: tuple[float, float], height: float, colour: Colour) -> np.ndarray:
    """The picture with a flash of lightning, ``height`` as a share of the picture's."""
    outline = np.array([(0.15, -0.5), (-0.3, 0.08), (-0.03, 0.08), (-0.15, 0.5), (0.3, -0.1), (0.03, -0.1)])
    rows, columns = picture.shape[:2]
    points = outline * height * rows * (0.6, 1.0) + np.array(centre) * (columns, rows)
    return cv2.fillPoly(picture.copy(), [points.round().astype(np.int32)], tuple(colour), cv2.LINE_AA)
