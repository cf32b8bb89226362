"""A small A-frame board with a price on both sides."""

from __future__ import annotations

import cv2
import numpy as np

from assets.textures.labels import price_label
from assets.textures.till_faces import framed
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import six_sides, tiled
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

VARIANTS = {
    "chalk": ("TODAY", "1.50", (46, 52, 50), (244, 244, 238), materials.OAK[0]),
    "yellow": ("SALE", "2.99", (252, 212, 40), (206, 28, 34), (206, 28, 34)),
    "white": ("NEW", "0.89", (250, 250, 246), (30, 84, 160), (30, 84, 160)),
}
"""Variant → words, price, ground, ink, frame."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("price_sign", variant)
    words, price, ground, ink, frame = VARIANTS[variant]
    face = _price_board(words, price, ground, ink, frame)
    sheet = prints.atlas({"front": face, "back": face}, frame, (face.shape[1], face.shape[0]))
    boards = [_leaning_board(side, 0.088, 0.078) for side in (-1, 1)]
    hinge = solids.rounded_box((0.07, 0.01, 0.007), 0.002, (0, 0, 0.0735))
    parts = [paint(board, sheet, six_sides(), roughness=0.7) for board in boards]
    parts.append(paint(hinge, materials.plastic(rng, tuple(int(0.7 * c) for c in frame)), tiled(0.05), roughness=0.6))
    return BuiltObject(parts, [*boards, hinge.convex_hull], mass=0.09, friction=0.8)


def _leaning_board(side: int, width: float, height: float) -> solids.Solid:
    """One of two boards that lean against each other, flat at its foot; ``side`` is -1 for the front one."""
    section = [(0.027, 0.0), (0.0215, 0.0), (0.0, height), (0.0055, height)]
    return pieces.hull(*[[(x, side * y, z) for y, z in section] for x in (-width / 2, width / 2)])


def _price_board(words: str, price: str, ground: Colour, ink: Colour, frame: Colour) -> np.ndarray:
    """The face of a small sign: words and a price within a frame."""
    picture = price_label(price, (420, 370), ground, ink, words)
    return cv2.resize(framed(picture, frame, 0.07), (476, 426), interpolation=cv2.INTER_AREA)
