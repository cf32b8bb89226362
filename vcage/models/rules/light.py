"""The key light of a picture, measured on the shadows that its objects throw on the table."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.geometry import Camera
from vcage.models.rules.cutouts import Cutout


@dataclass(frozen=True)
class LightSettings:
    """The search for the key light of a picture.

    Args:
        headings: directions that are tried.
        lengths: lengths of a shadow for each metre of height that are tried.
        finer: steps for improving the best of these, metres for each metre of height.
        length_costs: the shorter shadow is the likelier of two similar fits: correlation per
            metre for each metre.
        least_fit: correlation with the picture's darkening below which no light is assumed.
        near_px: side of the square around an object's pixels in which its shadow is searched.
        top_share: how wide the top of an object is, as a share of its outline: most are rounded.
        fewest_px: pixels of shadow that are needed to say how dark it is.
        faintest_share: a shadow that leaves more of the light is none.
        gamma: of the picture, near enough to sRGB for ratios.
        scale: by which the picture is made smaller for the search.
    """

    headings: int = 24
    lengths: tuple[float, ...] = tuple(np.arange(0.1, 1.05, 0.1))
    finer: tuple[float, ...] = (0.06, 0.04, 0.02, 0.02)
    length_costs: float = 0.08
    least_fit: float = 0.15
    near_px: int = 81
    top_share: float = 0.75
    fewest_px: int = 40
    faintest_share: float = 0.95
    gamma: float = 2.2
    scale: float = 0.25


SETTINGS = LightSettings()


@dataclass(frozen=True)
class Light:
    """A distant light and the share of light in its shadow.

    Args:
        offset: (2,) where a shadow falls, metres on the table for each metre of height.
        left: (3,) share of the table's brightness in a shadow, as pixel values.
    """

    offset: np.ndarray
    left: np.ndarray

    def on_side(self, normals: np.ndarray) -> np.ndarray:
        """(…) brightness, as pixel values, of upright faces with unit normals (…, 2), where a level face has 1."""
        ambient = float(np.mean(self.left)) ** SETTINGS.gamma
        return (ambient + (1 - ambient) * np.maximum(-normals @ self.offset, 0)) ** (1 / SETTINGS.gamma)


def find_light(
    picture: np.ndarray, background: np.ndarray, items: Sequence[Cutout], camera: Camera, table: float
) -> Light | None:
    """The light of a picture with objects on a table of that height; None where no shadow is seen."""
    objects = np.any([item.mask for item in items], axis=0).astype(np.uint8)
    if not objects.any():
        return None
    ratio = (picture.astype(np.float32) + 1) / (background.astype(np.float32) + 1)
    bare = cv2.dilate(objects, np.ones((5, 5), np.uint8)) == 0
    dark = np.where(bare, np.clip(1 - ratio.mean(axis=-1), 0, 0.6), 0).astype(np.float32)
    size = (int(dark.shape[1] * SETTINGS.scale), int(dark.shape[0] * SETTINGS.scale))
    small_dark = cv2.resize(dark, size, interpolation=cv2.INTER_AREA)
    near = bare & (cv2.dilate(objects, np.ones((SETTINGS.near_px, SETTINGS.near_px), np.uint8)) > 0)
    small_bare = cv2.resize(near.astype(np.float32), size, interpolation=cv2.INTER_AREA) > 0.5

    def fit(offset: np.ndarray) -> float:
        shade = _shadows(items, offset, camera, table, size)[small_bare]
        seen = small_dark[small_bare]
        if not shade.any() or seen.std() < 1e-6:
            return 0.0
        return float(np.corrcoef(shade, seen)[0, 1]) - SETTINGS.length_costs * float(np.linalg.norm(offset))

    offset = _best_offset(fit)
    if fit(offset) < SETTINGS.least_fit:
        return None
    full = _shadows(items, offset, camera, table, (dark.shape[1], dark.shape[0])) > 0
    core = cv2.erode(full.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool) & bare
    core &= dark > 1 - SETTINGS.faintest_share
    left = np.median(ratio[core], axis=0) if core.sum() > SETTINGS.fewest_px else np.ones(3)
    return Light(offset, np.minimum(left, 1.0)) if left.mean() < SETTINGS.faintest_share else None


def _best_offset(fit: Callable[[np.ndarray], float]) -> np.ndarray:
    """(2,) where a shadow falls for each metre of height, of the best fit: tried on a grid, then improved in steps."""
    angles = np.linspace(0, 2 * np.pi, SETTINGS.headings, endpoint=False)
    tried = [length * np.array([np.cos(a), np.sin(a)]) for a in angles for length in SETTINGS.lengths]
    offset = max(tried, key=fit)
    for step in SETTINGS.finer:
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
        tops = zip(item.box[:, 2], (1.0, SETTINGS.top_share), strict=True)
        swept = np.concatenate([item.centre + share * outline + offset * (z - table) for z, share in tops])
        pixels = camera.project(np.column_stack([swept, np.full(len(swept), table)])) * scale
        polygon = cv2.convexHull(np.rint(pixels * 16 - 8).astype(np.int32))
        cv2.fillConvexPoly(shade, polygon, (1,), shift=4)
    return shade
