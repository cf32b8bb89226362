"""Faces of the things around a till: screens, receipts, payment signs, mats, coins and price boards."""

from __future__ import annotations

import cv2
import numpy as np

from vcage.objects.textures import prints
from vcage.objects.textures.labels import INK, payment_code, price_label, stamped
from vcage.objects.textures.noise import Colour

PAPER: Colour = (250, 249, 244)


def framed(picture: np.ndarray, colour: Colour, share: float = 0.07) -> np.ndarray:
    """The picture within a border; ``share`` of its height wide."""
    edge = round(share * picture.shape[0])
    rows, columns = picture.shape[:2]
    out = prints.canvas(columns + 2 * edge, rows + 2 * edge, colour)
    out[edge:-edge, edge:-edge] = picture
    return out


def bars(picture: np.ndarray, lower: tuple[float, float], upper: tuple[float, float]) -> np.ndarray:
    """The picture with the sign for a bar code, upright stripes, between two corners."""
    ends = np.cumsum([0, 3, 2, 1, 2, 1, 1, 3, 2, 1, 1, 2, 2]) / 21
    for start, end in zip(ends[:-1:2], ends[1::2], strict=True):
        x0, x1 = (lower[0] + share * (upper[0] - lower[0]) for share in (start, end))
        picture = prints.rectangle(picture, (x0, lower[1]), (x1, upper[1]), INK)
    return picture


def waves(picture: np.ndarray, centre: tuple[float, float], height: float, colour: Colour) -> np.ndarray:
    """The picture with the sign for cards that pay without contact: four arcs, each larger than the last."""
    rows, columns = picture.shape[:2]
    out = picture.copy()
    at = (round(centre[0] * columns - 0.5 * height * rows), round(centre[1] * rows))
    for i in range(4):
        radius = round((0.22 + 0.26 * i) * height * rows)
        thickness = max(2, round(0.09 * height * rows))
        cv2.ellipse(out, at, (radius, radius), 0, -38, 38, tuple(int(c) for c in colour), thickness, cv2.LINE_AA)
    return out


def payment_screen() -> np.ndarray:
    """The screen of a card terminal that waits for a card."""
    picture = prints.canvas(324, 288, (24, 62, 110))
    picture = prints.rectangle(picture, (0, 0), (1, 0.17), (240, 244, 248))
    picture = prints.text(picture, "TOTAL", (0.5, 0.085), 0.11, (24, 62, 110))
    picture = prints.text(picture, "12.50", (0.5, 0.37), 0.25, (255, 255, 255))
    picture = prints.text(picture, "TAP OR INSERT CARD", (0.5, 0.6), 0.075, (206, 222, 240))
    return waves(picture, (0.5, 0.81), 0.22, (120, 220, 150))


def receipt(size: tuple[int, int], rows: int) -> np.ndarray:
    """A printed receipt of (width, height) pixels: a heading, ``rows`` lines with prices, and the total."""
    picture = prints.canvas(*size, PAPER)
    step = 1 / (rows + 4)
    letters = 0.85 * step
    picture = prints.text(picture, "CORNER SHOP", (0.5, 1.1 * step), letters, INK)
    rng = np.random.default_rng(rows)
    for i in range(rows):
        y = (2.4 + i) * step
        end = rng.uniform(0.35, 0.6)
        picture = prints.rectangle(picture, (0.08, y - 0.18 * step), (end, y + 0.18 * step), (120, 120, 122))
        picture = prints.rectangle(picture, (0.76, y - 0.18 * step), (0.92, y + 0.18 * step), (120, 120, 122))
    y = (2.9 + rows) * step
    picture = prints.text(picture, "TOTAL", (0.25, y), letters, INK)
    return prints.text(picture, "12.50", (0.78, y), letters, INK)


def payment_poster(rng: np.random.Generator, ground: Colour, brand: str) -> np.ndarray:
    """The front of a payment sign: a heading, a square code on white, and the name of the service."""
    picture = prints.canvas(440, 620, ground)
    picture = prints.text(picture, "SCAN TO PAY", (0.5, 0.1), 0.085, (255, 255, 255))
    code = framed(payment_code(rng), (255, 255, 255), 0.05)
    picture = stamped(picture, code, (0.5, 0.49))
    picture = prints.rectangle(picture, (0, 0.82), (1, 1), PAPER)
    return prints.text(picture, brand, (0.5, 0.905), 0.09, ground)


def customer_floor(ground: Colour, ink: Colour) -> np.ndarray:
    """The face of a counter mat for the customer's side: the word in a double frame, and lines of studs."""
    picture = prints.canvas(1080, 720, ground)
    light = tuple(min(255, c + 14) for c in ground)
    for row in range(20):
        for column in range(30):
            picture = prints.disc(picture, ((column + 0.5) / 30, (row + 0.5) / 20), 0.008, light)
    for inset, thickness in ((0.035, 0.014), (0.065, 0.005)):
        picture = _frame(picture, inset, thickness, ink)
    picture = prints.rectangle(picture, (0.14, 0.36), (0.86, 0.64), ground)
    return prints.text(picture, "CUSTOMER", (0.5, 0.5), 0.19, ink)


def _frame(picture: np.ndarray, inset: float, thickness: float, colour: Colour) -> np.ndarray:
    """The picture with a rectangle of lines; inset and thickness as shares of its height."""
    rows, columns = picture.shape[:2]
    out = picture.copy()
    edge, wide = round(inset * rows), max(1, round(thickness * rows))
    corners = ((edge, edge), (columns - edge, rows - edge))
    return cv2.rectangle(out, *corners, tuple(int(c) for c in colour), wide)


def coin_floor(size: tuple[int, int], ground: Colour, value: str, metal: Colour) -> np.ndarray:
    """The floor of a coin cup: a large coin with its value."""
    picture = prints.canvas(*size, ground)
    dark = tuple(int(0.7 * c) for c in metal)
    for radius, colour in ((0.36, dark), (0.345, metal), (0.29, dark), (0.275, metal)):
        picture = prints.disc(picture, (0.5, 0.5), radius, colour)
    return prints.text(picture, value, (0.5, 0.5), 0.3, tuple(int(0.4 * c) for c in metal))


def note_floor(size: tuple[int, int], ground: Colour) -> np.ndarray:
    """The floor of a compartment for banknotes: the outline of an invented note."""
    picture = prints.canvas(*size, ground)
    tint, dark = (150, 186, 160), (70, 110, 88)
    picture = prints.rectangle(picture, (0.12, 0.14), (0.88, 0.86), dark)
    picture = prints.rectangle(picture, (0.13, 0.17), (0.87, 0.83), tint)
    picture = prints.rectangle(picture, (0.15, 0.23), (0.85, 0.77), dark)
    picture = prints.rectangle(picture, (0.157, 0.25), (0.843, 0.75), tint)
    picture = prints.disc(picture, (0.5, 0.5), 0.21, dark)
    picture = prints.text(picture, "20", (0.5, 0.5), 0.22, tint)
    return prints.text(prints.text(picture, "20", (0.23, 0.5), 0.16, dark), "20", (0.77, 0.5), 0.16, dark)


def slotted_floor(size: tuple[int, int], colour: Colour) -> np.ndarray:
    """The floor of a plastic basket: rows of dark slots."""
    picture = prints.canvas(*size, colour)
    dark = tuple(int(0.42 * c) for c in colour)
    for row in range(7):
        for column in range(12):
            x, y = (column + 0.78) / 12.56, (row + 0.78) / 7.56
            picture = prints.rectangle(picture, (x - 0.022, y - 0.034), (x + 0.022, y + 0.034), dark)
    return picture


def price_board(words: str, price: str, ground: Colour, ink: Colour, frame: Colour) -> np.ndarray:
    """The face of a small sign: words and a price within a frame."""
    picture = price_label(price, (420, 370), ground, ink, words)
    return cv2.resize(framed(picture, frame, 0.07), (476, 426), interpolation=cv2.INTER_AREA)
