"""A six-sided jar of honey, 0.062 m across its flats and 0.09 m high, with a golden lid."""

from __future__ import annotations

import cv2
import numpy as np

from assets.textures import kitchen
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_above, tiled
from vcage.objects.modelling.parts import BuiltObject, Mapping, paint, variant_rng

VARIANTS = {
    "blossom": ("BLOSSOM", (236, 160, 30)),
    "forest": ("FOREST", (130, 66, 20)),
    "cream": ("CREAMED", (240, 214, 150)),
}
"""Variant → words, honey."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("honey_jar", variant)
    words, honey = VARIANTS[variant]
    apothem, shoulder, height = 0.031, 0.062, 0.09
    six = _hexagon(apothem)
    levels = [
        (0.9, 0.0),
        (0.985, 0.002),
        (1.0, 0.005),
        (1.0, shoulder - 0.004),
        (0.95, shoulder),
        (0.84, shoulder + 0.005),
    ]
    body = solids.closed_rings([np.column_stack([six * s, np.full(6, z)]) for s, z in levels])
    lid = [
        (0, 0.066),
        (0.0268, 0.066),
        (0.028, 0.068),
        (0.028, height - 0.002),
        (0.0265, height),
        (0.0245, height - 0.0008),
        (0, height - 0.0008),
    ]
    golden = prints.disc(materials.plastic(rng, (206, 160, 58), 192), (0.5, 0.5), 0.4, (226, 184, 84))
    golden = kitchen.with_motif(golden, _bee(), (0.5, 0.5), 0.5)
    parts = [
        paint(body, kitchen.syrup(rng, honey), tiled(0.1), roughness=0.1, crease=25),
        paint(solids.revolved(lid, 40), golden, from_above(), roughness=0.3, metallic=0.2),
    ]
    front = prints.canvas(192, 224, (252, 240, 206))
    front = prints.rectangle(front, (0, 0), (1, 0.05), (176, 110, 24))
    front = prints.rectangle(front, (0, 0.95), (1, 1), (176, 110, 24))
    front = kitchen.with_motif(front, _bee(), (0.5, 0.3), 0.44)
    front = prints.text(front, "HONEY", (0.5, 0.64), 0.2, (96, 52, 14))
    front = prints.text(front, words, (0.5, 0.83), 0.11, (140, 84, 24))
    parts += [paint(_panel(turn, apothem), front, _panel_mapping(turn), roughness=0.6) for turn in (0, 120, 240)]
    hulls = [
        pieces.hull(*[np.column_stack([six * s, np.full(6, z)]) for s, z in levels]),
        pieces.stack([(0.0268, 0.064), (0.028, 0.068), (0.028, height - 0.002), (0.0265, height)]),
    ]
    return BuiltObject(parts, hulls, mass=0.5, friction=0.6)


def _hexagon(apothem: float) -> np.ndarray:
    """(6, 2) corners, counter-clockwise, with flats to the front and to the back."""
    angle = np.radians(np.arange(6) * 60)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1) * apothem / np.cos(np.pi / 6)


def _panel(turn: float, apothem: float) -> solids.Solid:
    """A thin label on one flat of the hexagonal jar; 0 is the front."""
    return solids.moved(solids.box((0.0335, 0.0006, 0.04), (0, -apothem, 0.011)), turn=turn)


def _panel_mapping(turn: float) -> Mapping:
    """The picture upright on a panel that was turned about the z axis."""

    def mapping(corners: np.ndarray, _normals: np.ndarray) -> np.ndarray:
        angle = np.radians(turn)
        across = corners[..., 0] * np.cos(angle) + corners[..., 1] * np.sin(angle)
        return np.stack([across / 0.0335 + 0.5, (corners[..., 2] - 0.011) / 0.04], axis=-1)

    return mapping


def _bee(size: int = 128) -> np.ndarray:
    """A bee as a motif on black."""
    picture = np.zeros((size, size, 3), dtype=np.uint8)
    for x, turn in ((0.36, -30), (0.64, 30)):
        cv2.ellipse(
            picture, (round(x * size), round(0.34 * size)), (size // 9, size // 4), turn, 0, 360, (226, 236, 240), -1
        )
    cv2.ellipse(picture, (size // 2, round(0.56 * size)), (size // 3, size // 5), 0, 0, 360, (246, 190, 40), -1)
    body = (picture == (246, 190, 40)).all(axis=2)
    columns = np.arange(size)[None] / size
    stripes = (((columns > 0.36) & (columns < 0.44)) | ((columns > 0.54) & (columns < 0.62)) | (columns > 0.74)) & body
    picture[stripes] = (46, 34, 24)
    return picture
