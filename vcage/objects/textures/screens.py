"""Pictures that devices show: screens, keyboards, keypads, dials and clock faces."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from PIL import Image, ImageDraw

from vcage.objects.textures import prints
from vcage.objects.textures.noise import Colour, blend, clouds

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


def keyboard_deck(size: tuple[int, int], case: Colour, keys: Colour, ink: Colour) -> np.ndarray:
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


def desktop(rng: np.random.Generator, size: tuple[int, int], bezel: Colour = (22, 22, 24)) -> np.ndarray:
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


def phone_screen(size: tuple[int, int], wallpaper: tuple[Colour, Colour]) -> np.ndarray:
    """A phone's home screen: the time, sixteen apps and a dock.

    Args:
        size: (width, height), pixels.
        wallpaper: its colours at the top and at the bottom.
    """
    width, height = size
    share = np.repeat(np.linspace(0, 1, height)[:, None], width, axis=1)
    picture = prints.text(blend(*wallpaper, share), "09:41", (0.5, 0.17), 0.1)
    picture = prints.text(picture, "Tuesday 14 May", (0.5, 0.255), 0.032)
    apps = [
        (240, 90, 80),
        (250, 190, 60),
        (90, 190, 110),
        (80, 150, 240),
        (160, 110, 220),
        (240, 240, 244),
        (60, 64, 74),
    ]
    for i in range(16):
        at = (0.155 + 0.23 * (i % 4), 0.37 + 0.115 * (i // 4))
        picture = _tile(picture, at, 0.078, apps[(3 * i + i // 4) % len(apps)])
    picture = prints.rectangle(picture, (0.05, 0.86), (0.95, 0.965), [int(c * 0.75 + 50) for c in wallpaper[1]])
    for i in range(4):
        picture = _tile(picture, (0.155 + 0.23 * i, 0.9125), 0.08, apps[(2 * i + 2) % len(apps)])
    return prints.disc(picture, (0.5, 0.03), 0.013, (10, 10, 12))


def microwave_door(size: tuple[int, int], frame: Colour) -> np.ndarray:
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
    shine = cv2.fillConvexPoly(np.zeros(picture.shape[:2], np.float32), glare.round().astype(np.int32), 0.12)
    return np.round(picture + shine[..., None] * (255 - picture.astype(np.float32))).astype(np.uint8)


def microwave_panel(size: tuple[int, int], ground: Colour, ink: Colour) -> np.ndarray:
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


def clock_face(size: int, ground: Colour, ink: Colour, hands: Colour, time: tuple[int, int] = (10, 9)) -> np.ndarray:
    """A round clock's face that fills the picture, with twelve numerals and two hands."""
    picture = prints.disc(prints.canvas(size, size, ground), (0.5, 0.5), 0.48, ground)
    for minute in range(60):
        picture = _ray(picture, minute * np.pi / 30, (0.43 if minute % 5 else 0.415, 0.455), 0.006, ink)
    for hour in range(1, 13):
        picture = prints.text(picture, str(hour), _on_circle(hour * np.pi / 6, 0.345), 0.1, ink)
    hour, minute = time
    picture = _ray(picture, (hour + minute / 60) * np.pi / 6, (-0.05, 0.2), 0.032, hands)
    picture = _ray(picture, minute * np.pi / 30, (-0.06, 0.32), 0.022, hands)
    picture = _ray(picture, 6.5 * np.pi / 6, (0, 0.24), 0.01, (206, 40, 36))
    return prints.disc(picture, (0.5, 0.5), 0.035, hands)


def minute_ring(size: int, ground: Colour, ink: Colour, labels: Sequence[str]) -> np.ndarray:
    """A round dial that fills the picture: marks at its edge, and labels in order counter-clockwise.

    The first label is at the picture's lower edge; turning the dial clockwise brings the next ones there.
    """
    picture = prints.canvas(size, size, ground)
    for mark in range(4 * len(labels)):
        length = 0.07 if mark % 4 == 0 else 0.035
        angle = np.pi + mark * 2 * np.pi / (4 * len(labels))
        picture = _ray(picture, angle, (0.485 - length, 0.485), 0.014 if mark % 4 == 0 else 0.007, ink)
    for i, label in enumerate(labels):
        angle = np.pi - i * 2 * np.pi / len(labels)
        turn = 180 - np.degrees(angle)
        picture = prints.text(picture, label, _on_circle(angle, 0.345), 0.1, ink, turn=turn)
    return picture


def _key(picture: np.ndarray, legend: str, at: tuple[float, float], ground: Colour, ink: Colour) -> np.ndarray:
    picture = prints.rectangle(picture, (at[0] - 0.115, at[1] - 0.037), (at[0] + 0.115, at[1] + 0.037), ground)
    return prints.text(picture, legend, at, 0.05, ink)


def _tile(picture: np.ndarray, at: tuple[float, float], height: float, colour: Colour) -> np.ndarray:
    """A square app with round corners; ``height`` is a share of the picture's."""
    rows, columns = picture.shape[:2]
    x, y, half = at[0] * columns, at[1] * rows, height * rows / 2
    out = Image.fromarray(picture)
    frame = (x - half, y - half, x + half, y + half)
    ImageDraw.Draw(out).rounded_rectangle(frame, radius=half / 2, fill=tuple(int(c) for c in colour))
    return np.asarray(out).copy()


def _on_circle(angle: float, radius: float) -> tuple[float, float]:
    """A point, as shares from the upper left, at an angle clockwise from the top."""
    return 0.5 + radius * float(np.sin(angle)), 0.5 - radius * float(np.cos(angle))


def _ray(picture: np.ndarray, angle: float, reach: tuple[float, float], width: float, colour: Colour) -> np.ndarray:
    """A line from one distance of the middle to another, at an angle clockwise from the top."""
    size = len(picture)
    start, end = (tuple(round(c * size) for c in _on_circle(angle, radius)) for radius in reach)
    ink = tuple(int(c) for c in colour)
    return cv2.line(np.ascontiguousarray(picture).copy(), start, end, ink, max(1, round(width * size)), cv2.LINE_AA)
