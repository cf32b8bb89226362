"""Where a known object may be in the target picture: all positions and headings at once, in a small picture.

The squared colour distance inside the turned mask, what of the inside is table and what of the surroundings is not are
all linear in (Lab, |Lab|², salience) of the patch around a position, so one matrix product compares every position
with every heading.
"""

from __future__ import annotations

import cv2
import numpy as np

from vcage.vision.object_templates import Crop, View
from vcage.vision.pose_score import LIGHTNESS, from_pixels, rotation

EXTENT, LONG_EXTENT = 14.0, 26.0
"""Longest side of a compact and of a very long object in the picture in which it is looked for, pixels."""

MARGIN = 5
"""The patches that are compared are wider than the object by this, pixels."""

HEADINGS, LONG_HEADINGS = 24, 40
"""Headings around the circle; the ends of a long object move faster."""

CHUNK = 1024
"""Positions that are compared at once: their windows stay in the processor's cache."""

COLOUR_SCALE = 20.0
"""Colour distance that weighs as much as an inside that is all table, Lab units."""

RING_SHARE = 0.6
"""Weight of what surrounds the object; neighbours may touch it."""

APART = 0.6
"""Least distance between two places, in square roots of the object's area."""

LEAST_SALIENCE = 0.25
"""A place of which less stands out of the table is not looked at."""


def propose(view: View, source: View, crop: Crop, count: int, headings: int, also: np.ndarray) -> np.ndarray:
    """(k, 4) poses to refine: the ``headings`` best headings at each of the ``count`` best places.

    Args:
        view, source: the target and the source picture.
        crop: the object, of the source.
        also: (n, 2) pixels where something was detected; looked at as well.
    """
    # Few sizes, so that objects share the smaller pictures.
    long = crop.extent * crop.extent > 2.5 * crop.area
    wanted = float(np.clip(EXTENT * np.sqrt(crop.extent**2 / crop.area), EXTENT, LONG_EXTENT))
    step = 2 ** (np.ceil(2 * np.log2(max(crop.extent / wanted, 1.0))) / 2)
    turns = LONG_HEADINGS if long else HEADINGS
    angles = np.arange(turns) * 2 * np.pi / turns
    side = 2 * int(np.ceil((crop.extent / step + MARGIN) / 2)) + 1
    weights, constant = _templates(source, crop, step, side, angles)
    level = view.level(step)
    size = np.array([level.shape[1], level.shape[0]]) / [view.lab.shape[1], view.lab.shape[0]]
    places = _places(level, crop.area / step**2, np.floor(also * size).astype(int))
    if not len(places):
        return np.zeros((0, 4))
    misfit = _misfits(_features(level), places, weights, side) + constant
    found = _apart(places, misfit.min(axis=1), count, max(1.5, APART * np.sqrt(crop.area) / step))
    poses = []
    for k in found:
        ranked = misfit[k]
        peaks = (ranked <= np.roll(ranked, 1)) & (ranked <= np.roll(ranked, -1))
        order = np.argsort(np.where(peaks, ranked, np.inf), kind="stable")[: min(headings, int(peaks.sum()))]
        poses += [(*((places[k] + 0.5) / size), angles[a], 0.0) for a in order]
    return from_pixels(crop, np.array(poses))


def _features(level: np.ndarray) -> np.ndarray:
    """(h, w, 5) weighted Lab, its square, salience."""
    lab = level[..., :3] * np.float32([LIGHTNESS, 1, 1])
    return np.dstack([lab, (lab * lab).sum(axis=-1), level[..., 3]])


def _templates(source: View, crop: Crop, step: float, side: int, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(5 side², headings) weights and (headings,) constants of the misfit."""
    level = np.dstack([source.level(step)[..., :3], _shrunk(crop.mask, source.level(step).shape)])
    size = np.array([level.shape[1], level.shape[0]]) / [crop.mask.shape[1], crop.mask.shape[0]]
    centre = crop.centre * size - 0.5
    columns, constants = [], []
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (5, 5))
    for angle in angles:
        turn = rotation(angle)
        shift = (side - 1) / 2 - turn @ centre
        turned = cv2.warpAffine(level, np.column_stack([turn, shift]), (side, side), flags=cv2.INTER_LINEAR)
        mask = turned[..., 3]
        lab = turned[..., :3] * np.float32([LIGHTNESS, 1, 1])
        ring = np.clip(cv2.dilate(mask, kernel) - mask, 0, 1)
        inside, around = mask / max(mask.sum(), 1e-6), ring / max(ring.sum(), 1e-6)
        colours = inside[..., None] / COLOUR_SCALE**2
        weights = np.dstack([-2 * colours * lab, colours, (RING_SHARE * around - inside)[..., None]])
        columns.append(weights.reshape(-1))
        constants.append(1 + (colours * lab * lab).sum())
    return np.stack(columns, axis=1).astype(np.float32), np.array(constants, np.float32)


def _shrunk(mask: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    return cv2.resize(mask.astype(np.float32), (shape[1], shape[0]), interpolation=cv2.INTER_AREA)


def _places(level: np.ndarray, area: float, also: np.ndarray) -> np.ndarray:
    """(n, 2) pixels (u, v) of the small picture where enough stands out for an object of that area."""
    around = cv2.GaussianBlur(level[..., 3], (0, 0), max(0.6, 0.25 * np.sqrt(area)))
    v, u = np.nonzero(around > LEAST_SALIENCE)
    inside = also[np.all((also >= 0) & (also < [level.shape[1], level.shape[0]]), axis=1)]
    return np.concatenate([np.stack([u, v], axis=1), inside]).astype(int)


def _misfits(features: np.ndarray, places: np.ndarray, weights: np.ndarray, side: int) -> np.ndarray:
    """(places, headings) linear part of the misfit."""
    half = side // 2
    padded = cv2.copyMakeBorder(features[..., :4], half, half, half, half, cv2.BORDER_REPLICATE)
    outside = cv2.copyMakeBorder(features[..., 4], half, half, half, half, cv2.BORDER_CONSTANT, value=0)
    # Channels first, in the weights as well: so rows of a window lie together, and are copied faster.
    padded = np.stack([*cv2.split(padded), outside])
    windows = np.lib.stride_tricks.sliding_window_view(padded, (side, side), axis=(1, 2))  # (5, h, w, P, P)
    windows = windows.transpose(1, 2, 0, 3, 4)
    weights = weights.reshape(side, side, 5, -1).transpose(2, 0, 1, 3).reshape(side * side * 5, -1)
    weights = np.ascontiguousarray(weights)
    found = [
        windows[chunk[:, 1], chunk[:, 0]].reshape(len(chunk), -1) @ weights
        for chunk in np.array_split(places, max(1, int(np.ceil(len(places) / CHUNK))))
    ]
    return np.concatenate(found)


def _apart(places: np.ndarray, misfit: np.ndarray, count: int, distance: float) -> list[int]:
    """Indices of the ``count`` best places that are no nearer to each other than ``distance``.

    Only places better than their neighbours are chosen: else the inside of one large object takes them all.
    """
    size = places.max(axis=0) + 1
    surface = np.full(size[::-1], np.inf, np.float32)
    surface[places[:, 1], places[:, 0]] = misfit
    around = cv2.erode(surface, np.ones((3, 3), np.uint8))
    left = np.where(misfit <= around[places[:, 1], places[:, 0]], misfit, np.inf).astype(np.float64)
    chosen: list[int] = []
    while len(chosen) < count:
        k = int(np.argmin(left))
        if not np.isfinite(left[k]):
            break
        chosen.append(k)
        left[np.hypot(*(places - places[k]).T) <= distance] = np.inf
    return chosen
