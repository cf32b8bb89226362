"""What a till reads and shows: bar codes with price labels, square payment codes, seven-segment displays."""

from __future__ import annotations

import cv2
import numpy as np

from vcage.objects.modelling import prints
from vcage.objects.modelling.noise import Colour

CODE_AT = 0.75
"""Where a wrapped label faces to the right, as a share of its width."""

INK: Colour = (22, 22, 24)

_LEFT_ODD = [
    "0001101",
    "0011001",
    "0010011",
    "0111101",
    "0100011",
    "0110001",
    "0101111",
    "0111011",
    "0110111",
    "0001011",
]
"""Seven modules of each digit in the left half, odd parity; 1 is a bar."""

_PARITY = ("LLLLLL", "LLGLGG", "LLGGLG", "LLGGGL", "LGLLGG", "LGGLLG", "LGGGLL", "LGLGLG", "LGLGGL", "LGGLGL")
"""Which code (L odd, G even) the six digits on the left take, by the first digit, which has no bars of its own."""

QUIET = (11, 7)
"""Modules of white that EAN-13 asks for left and right of the bars."""

_SEGMENTS = ("abcdef", "bc", "abged", "abgcd", "fgbc", "afgcd", "afgedc", "abc", "abcdefg", "abcdfg")
"""Segments that light up for each digit: a at the top, then clockwise, g in the middle."""


def with_check_digit(twelve: str) -> str:
    """Thirteen digits of an EAN-13: the check digit makes the weighted sum (1, 3, 1, 3…) a multiple of ten.

    Raises:
        ValueError: not twelve digits.
    """
    if len(twelve) != 12 or not (twelve.isascii() and twelve.isdigit()):
        raise ValueError(f"expected 12 digits, got {twelve!r}")
    total = sum(int(digit) * (3 if i % 2 else 1) for i, digit in enumerate(twelve))
    return twelve + str(-total % 10)


def ean13_modules(digits: str) -> np.ndarray:
    """(95,) bool: which modules of an EAN-13 are bars.

    Raises:
        ValueError: not thirteen digits, or the check digit is wrong.
    """
    if digits != with_check_digit(digits[:12]):
        raise ValueError(f"{digits!r} is no EAN-13: expected {with_check_digit(digits[:12])!r}")
    left = []
    for digit, code in zip(digits[1:7], _PARITY[int(digits[0])], strict=True):
        odd = _LEFT_ODD[int(digit)]
        left.append(odd if code == "L" else _inverted(odd)[::-1])
    right = [_inverted(_LEFT_ODD[int(digit)]) for digit in digits[7:]]
    bits = "101" + "".join(left) + "01010" + "".join(right) + "101"
    return np.array([bit == "1" for bit in bits])


def _inverted(bits: str) -> str:
    return bits.translate(str.maketrans("01", "10"))


def product_code(*names: str) -> str:
    """An invented EAN-13, always the same for the same names; it starts with 2, which shops use within their walls."""
    seed = "/".join(names).encode()
    digits = np.random.default_rng(list(seed)).integers(0, 10, 11)
    return with_check_digit("2" + "".join(str(d) for d in digits))


def barcode(digits: str, module: int = 2, share: float = 0.62) -> np.ndarray:
    """A white field with the bars of an EAN-13, the guard bars longer, and the digits below.

    Args:
        digits: thirteen, with the right check digit.
        module: width of the narrowest bar, pixels.
        share: height of the field over its width.
    """
    bars = ean13_modules(digits)
    width = (len(bars) + sum(QUIET)) * module
    height = round(width * share)
    picture = prints.canvas(width, height, (252, 252, 250))
    top, foot = round(0.06 * height), round(0.78 * height)
    for i in np.flatnonzero(bars):
        guard = i < 3 or 45 <= i < 50 or i >= 92
        x = (QUIET[0] + int(i)) * module
        picture[top : foot + (round(0.1 * height) if guard else 0), x : x + module] = INK
    for words, middle in ((digits[0], 5.5), (digits[1:7], QUIET[0] + 24), (digits[7:], QUIET[0] + 71)):
        picture = prints.text(picture, words, (middle * module / width, 0.9), 0.17, INK)
    return picture


def stamped(picture: np.ndarray, stamp: np.ndarray, centre: tuple[float, float]) -> np.ndarray:
    """The picture with another one laid on it, pixel for pixel; ``centre`` as shares from the upper left.

    Raises:
        ValueError: the stamp does not lie within the picture.
    """
    rows, columns = stamp.shape[:2]
    x = round(centre[0] * picture.shape[1] - columns / 2)
    y = round(centre[1] * picture.shape[0] - rows / 2)
    if x < 0 or y < 0 or x + columns > picture.shape[1] or y + rows > picture.shape[0]:
        raise ValueError(f"a stamp of {columns} x {rows} pixels leaves a picture of {picture.shape[1::-1]}")
    out = picture.copy()
    out[y : y + rows, x : x + columns] = stamp
    return out


def coded(
    picture: np.ndarray, names: tuple[str, ...], centre: tuple[float, float], module: int = 2, share: float = 0.62
) -> np.ndarray:
    """The picture with the bar code of the product that has these names; see :func:`barcode`."""
    return stamped(picture, barcode(product_code(*names), module, share), centre)


def payment_code(rng: np.random.Generator, count: int = 29, module: int = 8) -> np.ndarray:
    """A square code as phones scan it to pay: finder, alignment and timing patterns around random modules."""
    dark = rng.random((count, count)) < 0.5
    dark[6, :], dark[:, 6] = np.arange(count) % 2 == 0, np.arange(count) % 2 == 0
    finder = np.ones((7, 7), dtype=bool)
    finder[1:6, 1:6] = False
    finder[2:5, 2:5] = True
    for rows, columns in ((slice(0, 8), slice(0, 8)), (slice(0, 8), slice(-8, None)), (slice(-8, None), slice(0, 8))):
        dark[rows, columns] = False
    dark[:7, :7], dark[:7, -7:], dark[-7:, :7] = finder, finder, finder
    dark[-9:-4, -9:-4] = True
    dark[-8:-5, -8:-5] = False
    dark[-7, -7] = True
    framed = np.kron(np.pad(dark, 3), np.ones((module, module), dtype=bool))
    return np.where(framed[..., None], np.array(INK), 255).astype(np.uint8)


def display(
    number: str, size: tuple[int, int], lit: Colour, ground: Colour, *, ghost: float = 0.12, cells: int = 0
) -> np.ndarray:
    """A seven-segment display that shows a number, to the right.

    Args:
        number: digits, points and blanks; a point takes no place of its own.
        size: (width, height), pixels.
        lit: colour of segments that are on; the others show it with the share ``ghost``.
        cells: how many digits there is room for; as many as the number has when 0.
    """
    width, height = size
    picture = prints.canvas(width, height, ground)
    places = [c for c in number if c != "."]
    cells = max(cells, len(places))
    tall = min(0.76 * height, 1.5 * width / (cells + 0.5))
    step = tall * 0.66
    left = width - 0.5 * (width - cells * step) - len(places) * step
    dim = tuple(int((1 - ghost) * g + ghost * c) for g, c in zip(ground, lit, strict=True))
    at = -1
    for character in number:
        if character == ".":
            middle = (round(left + (at + 1) * step - 0.03 * tall), round((height + tall) / 2 - 0.05 * tall))
            cv2.circle(picture, middle, max(1, round(0.06 * tall)), tuple(int(c) for c in lit), -1, cv2.LINE_AA)
            continue
        at += 1
        on = "" if character == " " else _SEGMENTS[int(character)]
        corner = (left + at * step + 0.08 * tall, (height - tall) / 2)
        for segment in "abcdefg":
            _segment(picture, segment, corner, tall, lit if segment in on else dim)
    return picture


def _segment(picture: np.ndarray, name: str, corner: tuple[float, float], tall: float, colour: Colour) -> None:
    """Draw one segment of a digit whose upper left is ``corner`` and whose height is ``tall``."""
    wide, half, gap = 0.46 * tall, 0.5 * tall, 0.05 * tall
    x, y = corner
    ends = {
        "a": ((x + gap, y), (x + wide - gap, y)),
        "b": ((x + wide, y + gap), (x + wide, y + half - gap)),
        "c": ((x + wide, y + half + gap), (x + wide, y + tall - gap)),
        "d": ((x + gap, y + tall), (x + wide - gap, y + tall)),
        "e": ((x, y + half + gap), (x, y + tall - gap)),
        "f": ((x, y + gap), (x, y + half - gap)),
        "g": ((x + gap, y + half), (x + wide - gap, y + half)),
    }[name]
    (x0, y0), (x1, y1) = ends
    thickness = max(1, round(0.1 * tall))
    start, end = (round(x0), round(y0)), (round(x1), round(y1))
    cv2.line(picture, start, end, tuple(int(c) for c in colour), thickness, cv2.LINE_AA)


def price_label(price: str, size: tuple[int, int], ground: Colour, ink: Colour, words: str = "") -> np.ndarray:
    """A price in large figures with small cents, and a line of words above it.

    Args:
        price: with a point: ``2.99``.
        size: (width, height), pixels.
    """
    whole, cents = price.split(".")
    picture = prints.canvas(*size, ground)
    large, small = 0.62, 0.3
    lift = 0.58 if words else 0.5
    picture = prints.text(picture, whole, (0.5 - 0.055 * len(cents), lift), large, ink)
    shift = 0.28 * large * len(whole) * size[1] / size[0]
    picture = prints.text(picture, cents, (0.5 + shift + 0.04, lift - 0.14), small, ink)
    if words:
        picture = prints.text(picture, words, (0.5, 0.15), 0.15, ink)
    return picture
