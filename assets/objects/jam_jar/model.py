"""A jar of jam, 0.064 m across and 0.086 m high, with a checked lid."""

from __future__ import annotations

import cv2
import numpy as np

from assets.textures import kitchen
from vcage.objects.modelling import pieces, prints, solids
from vcage.objects.modelling.mappings import around, from_above, tiled
from vcage.objects.modelling.noise import Colour, noise, over, shaded
from vcage.objects.modelling.parts import BuiltObject, Mapping, paint, variant_rng

VARIANTS = {
    "strawberry": ("STRAWBERRY", (168, 22, 34), (206, 48, 44), (196, 36, 44), None),
    "apricot": ("APRICOT", (224, 126, 26), (244, 164, 60), (226, 140, 40), (240, 150, 50)),
    "blueberry": ("BLUEBERRY", (56, 30, 78), (34, 24, 66), (62, 82, 150), (70, 84, 160)),
}
"""Variant → words, jam, pieces of fruit in it, checks of the lid, round fruit on the label; None for strawberries."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("jam_jar", variant)
    words, jam, bits, checks, fruit = VARIANTS[variant]
    motif = _strawberry() if fruit is None else _round_fruit(fruit)
    radius, shoulder = 0.032, 0.064
    glass = [(0, 0.0015), (0.024, 0), (0.03, 0.002), (radius, 0.006), (radius, shoulder - 0.006)]
    glass = np.concatenate(
        [glass, solids.arc((radius - 0.006, shoulder - 0.006), 0.006, 10, 80, 5), [(0.026, 0.068), (0, 0.068)]]
    )
    lid = [
        (0, 0.066),
        (0.0285, 0.066),
        (0.0295, 0.068),
        (0.0295, 0.083),
        (0.028, 0.0855),
        (0.0255, 0.086),
        (0.0245, 0.0852),
        (0, 0.0852),
    ]
    side = [(0.02, 0.067), (0.02975, 0.067), (0.02975, 0.0815), (0.02, 0.0815)]
    band = [(0.02, 0.011), (radius + 0.0003, 0.011), (radius + 0.0003, 0.053), (0.02, 0.053)]
    label = _jar_label((words, "JAM  340 g"), (250, 244, 228), (110, 40, 36), motif)
    cloth = _gingham(rng, checks)
    parts = [
        paint(solids.revolved(glass, 44), kitchen.syrup(rng, jam, bits), tiled(0.08), roughness=0.12),
        paint(solids.revolved(lid, 44), cloth, from_above(), roughness=0.45),
        paint(solids.revolved(side, 44), _gingham(rng, checks, 4), _ribbon(4), roughness=0.45),
        paint(solids.revolved(band, 44), label, around(), roughness=0.6),
    ]
    hulls = [
        pieces.stack([(0.03, 0), (radius, 0.006), (radius, shoulder - 0.004), (0.028, 0.066)]),
        pieces.stack([(0.0295, 0.066), (0.0295, 0.083), (0.0265, 0.086)]),
    ]
    return BuiltObject(parts, hulls, mass=0.45, friction=0.6)


def _ribbon(period: int) -> Mapping:
    """Repeats a square picture around a lid's side; ``period`` times on each third of the way."""
    wrap = around()

    def mapping(corners: np.ndarray, normals: np.ndarray) -> np.ndarray:
        return wrap(corners, normals) * (3 * period, 1)

    return mapping


def _gingham(rng: np.random.Generator, colour: Colour, checks: int = 10, size: int = 256) -> np.ndarray:
    """Checked cotton: white, light and full squares."""
    stripe = (np.arange(size) * checks // size) % 2
    cover = (stripe[:, None] + stripe[None]) / 2
    cloth = over(np.full((size, size, 3), 248, dtype=np.uint8), colour, cover * 0.92)
    return shaded(cloth, 0.9 + 0.14 * noise(rng, (size, size), (size // 3, size // 3)))


def _jar_label(words: tuple[str, str], ground: Colour, ink: Colour, motif: np.ndarray | None = None) -> np.ndarray:
    """A wrap-around label (192, 768): two lines and a picture, in front and at the back.

    Args:
        words: large line and small line.
        motif: (n, n, 3) picture on its own, whose pure black is left out.
    """
    label = prints.canvas(768, 192, ground)
    for low, high in ((0.05, 0.08), (0.92, 0.95)):
        label = prints.rectangle(label, (0, low), (1, high), ink)
    for x in (0.25, 0.75):
        label = prints.text(label, words[0], (x, 0.72 if motif is not None else 0.42), 0.15, ink)
        label = prints.text(label, words[1], (x, 0.87 if motif is not None else 0.7), 0.1, ink)
        if motif is not None:
            label = kitchen.with_motif(label, motif, (x, 0.36), 0.5)
    return np.roll(label, 192, axis=1)  # one print in front, one at the back


def _strawberry(size: int = 128) -> np.ndarray:
    """A strawberry as a motif on black."""
    picture = np.zeros((size, size, 3), dtype=np.uint8)
    outline = [
        (0.5, 0.96),
        (0.24, 0.66),
        (0.14, 0.4),
        (0.28, 0.26),
        (0.5, 0.3),
        (0.72, 0.26),
        (0.86, 0.4),
        (0.76, 0.66),
    ]
    cv2.fillPoly(picture, [_pixels(outline, size)], (206, 28, 40), cv2.LINE_8)
    for x, y in ((0.34, 0.44), (0.5, 0.5), (0.66, 0.44), (0.42, 0.62), (0.58, 0.62), (0.5, 0.78)):
        cv2.circle(picture, (round(x * size), round(y * size)), size // 36, (250, 220, 120), -1)
    leaf = [(0.5, 0.4), (0.22, 0.34), (0.4, 0.24), (0.34, 0.08), (0.5, 0.2), (0.66, 0.08), (0.6, 0.24), (0.78, 0.34)]
    cv2.fillPoly(picture, [_pixels(leaf, size)], (70, 140, 60), cv2.LINE_8)
    return picture


def _round_fruit(colour: Colour, size: int = 128) -> np.ndarray:
    """Three round fruits with a leaf as a motif on black: apricots or berries."""
    picture = np.zeros((size, size, 3), dtype=np.uint8)
    leaf = [(0.5, 0.32), (0.6, 0.1), (0.86, 0.06), (0.76, 0.26)]
    cv2.fillPoly(picture, [_pixels(leaf, size)], (80, 140, 70), cv2.LINE_8)
    for i, (x, y) in enumerate(((0.34, 0.42), (0.66, 0.44), (0.5, 0.7))):
        shade = tuple(int(max(1, c * (0.86 + 0.07 * i))) for c in colour)
        cv2.circle(picture, (round(x * size), round(y * size)), round(0.22 * size), shade, -1)
        cv2.circle(picture, (round((x - 0.07) * size), round((y - 0.08) * size)), size // 22, (250, 240, 226), -1)
    return picture


def _pixels(points: list[tuple[float, float]], size: int) -> np.ndarray:
    return np.round(np.array(points) * size).astype(np.int32)
