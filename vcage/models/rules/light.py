"""The key light of a picture, measured on the shadows that its objects throw on the table."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.geometry import Camera
from vcage.models.rules.cutouts import Cutout

HEADINGS, LENGTHS = 24, tuple(np.arange(0.1, 1.05, 0.1))
"""Directions that are tried, and lengths of a shadow for each metre of height."""

FINER = (0.06, 0.04, 0.02, 0.02)
"""Steps in which the best of these is improved, metres for each metre of height."""

LENGTH_COSTS = 0.08
"""Of two fits that are nearly as good the shorter shadow is the likelier: correlation per metre for each metre."""

LEAST_FIT = 0.15
"""Correlation with the picture's darkening below which there is no light to speak of."""

NEAR = 81
"""Side of the square around an object's pixels where its shadow is looked for, pixels."""

TOP_SHARE = 0.75
"""How wide the top of an object is, as a share of its outline: most are rounded."""

FEWEST_PIXELS = 40
"""Of shadow, to say how dark it is."""

FAINTEST = 0.95
"""A shadow that leaves more of the light is none."""

GAMMA = 2.2
"""Of the picture, near enough to sRGB for ratios."""

_SCALE = 0.25


@dataclass(frozen=True)
class Light:
    """A distant light and what is left where it does not reach.

    Args:
        offset: (2,) where a shadow falls, metres on the table for each metre of height.
        left: (3,) share of the table's brightness in a shadow, as pixel values.
    """

    offset: np.ndarray
    left: np.ndarray

    def on_side(self, normals: np.ndarray) -> np.ndarray:
        """(…) brightness, as pixel values, of upright faces with unit normals (…, 2), where a level face has 1."""
        ambient = float(np.mean(self.left)) ** GAMMA
        return (ambient + (1 - ambient) * np.maximum(-normals @ self.offset, 0)) ** (1 / GAMMA)


def find_light(
    picture: np.ndarray, background: np.ndarray, items: Sequence[Cutout], camera: Camera, table: float
) -> Light | None:
    """The light of a picture whose objects stand on a table of that height; None where no shadow is seen."""
    objects = np.any([item.mask for item in items], axis=0).astype(np.uint8)
    if not objects.any():
        return None
    ratio = (picture.astype(np.float32) + 1) / (background.astype(np.float32) + 1)
    bare = cv2.dilate(objects, np.ones((5, 5), np.uint8)) == 0
    dark = np.where(bare, np.clip(1 - ratio.mean(axis=-1), 0, 0.6), 0).astype(np.float32)
    size = (int(dark.shape[1] * _SCALE), int(dark.shape[0] * _SCALE))
    small_dark = cv2.resize(dark, size, interpolation=cv2.INTER_AREA)
    near = bare & (cv2.dilate(objects, np.ones((NEAR, NEAR), np.uint8)) > 0)
    small_bare = cv2.resize(near.astype(np.float32), size, interpolation=cv2.INTER_AREA) > 0.5

    def fit(offset: np.ndarray) -> float:
        shade = _shadows(items, offset, camera, table, size)[small_bare]
        seen = small_dark[small_bare]
        if not shade.any() or seen.std() < 1e-6:
            return 0.0
        return float(np.corrcoef(shade, seen)[0, 1]) - LENGTH_COSTS * float(np.linalg.norm(offset))

    offset = _best_offset(fit)
    if fit(offset) < LEAST_FIT:
        return None
    full = _shadows(items, offset, camera, table, (dark.shape[1], dark.shape[0])) > 0
    core = cv2.erode(full.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool) & bare
    core &= dark > 1 - FAINTEST
    left = np.median(ratio[core], axis=0) if core.sum() > FEWEST_PIXELS else np.ones(3)
    return Light(offset, np.minimum(left, 1.0)) if left.mean() < FAINTEST else None


def _best_offset(fit: Callable[[np.ndarray], float]) -> np.ndarray:
    """(2,) where a shadow falls for each metre of height, of the best fit: tried on a grid, then improved in steps."""
    angles = np.linspace(0, 2 * np.pi, HEADINGS, endpoint=False)
    tried = [length * np.array([np.cos(a), np.sin(a)]) for a in angles for length in LENGTHS]
    offset = max(tried, key=fit)
    for step in FINER:
        around = [offset + step * np.array([dx, dy]) for dx in (0, -1, 1) for dy in (0, -1, 1)]
        offset = max(around, key=fit)
    return offset


def _shadows(
    items: Sequence[Cutout], offset: np.ndarray, camera: Camera, table: float, size: tuple[int, int]
) -> np.ndarray:
    """(h, w) uint8: 1 where the outlines of the objects, swept along the light, darken the table."""
    shade = np.zeros((size[1], size[0]), np.uint8)
    scale = np.array(size) / (camera.width, camera.height)
    for item in items:
        lower, upper = item.hull.min(axis=0), item.hull.max(axis=0)
        scale_to_box = item.half_size(0.0) / np.maximum((upper - lower) / 2, 1e-6)
        outline = (item.hull - (lower + upper) / 2) * scale_to_box
        tops = zip(item.box[:, 2], (1.0, TOP_SHARE), strict=True)
        swept = np.concatenate([item.centre + share * outline + offset * (z - table) for z, share in tops])
        pixels = camera.project(np.column_stack([swept, np.full(len(swept), table)])) * scale
        polygon = cv2.convexHull(np.rint(pixels * 16 - 8).astype(np.int32))
        cv2.fillConvexPoly(shade, polygon, (1,), shift=4)
    return shade
