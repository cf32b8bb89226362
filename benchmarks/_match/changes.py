"""Change pictures as image models do when they redraw: colour, sharpness, size, shadows, shapes by a few pixels.

Every function takes a (H, W, 3) uint8 RGB picture and a generator, and returns the changed picture and what was done,
in numbers, for ``truth.json``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import cv2
import numpy as np

Changed = tuple[np.ndarray, dict[str, Any]]

SIZES = ((512, 384), (768, 576), (1024, 768), (1184, 864))
"""Width and height of the pictures that image models answer with when asked for 4:3."""

WARP_GRID = 96
"""Distance of the knots of a local warp, pixels."""

SCALE = 0.06
"""Largest relative change of an object's size."""


def drift_colours(picture: np.ndarray, rng: np.random.Generator) -> Changed:
    """White balance, gamma, contrast and brightness, saturation and a little hue."""
    gains = rng.uniform(0.9, 1.1, 3)
    gamma, contrast = float(np.exp(rng.uniform(-0.25, 0.25))), rng.uniform(0.82, 1.2)
    brightness, saturation, hue = rng.uniform(-0.05, 0.05), rng.uniform(0.75, 1.25), rng.uniform(-4, 4)
    values = np.clip(picture.astype(np.float32) / 255 * gains, 0, 1) ** gamma
    values = np.clip((values - 0.5) * contrast + 0.5 + brightness, 0, 1).astype(np.float32)
    hls = cv2.cvtColor(values, cv2.COLOR_RGB2HSV)
    hls[..., 0] = (hls[..., 0] + hue) % 360
    hls[..., 1] = np.clip(hls[..., 1] * saturation, 0, 1)
    values = cv2.cvtColor(hls, cv2.COLOR_HSV2RGB)
    done = {"gains": gains, "gamma": gamma, "contrast": contrast, "brightness": brightness}
    return _picture(values * 255), _rounded({**done, "saturation": saturation, "hue_deg": hue})


def soften(picture: np.ndarray, rng: np.random.Generator) -> Changed:
    """Drawn in another size (half of the pictures stay in it), blurred, and packed as JPEG."""
    height, width = picture.shape[:2]
    size = SIZES[int(rng.integers(len(SIZES)))]
    sigma, quality, back = rng.uniform(0.5, 1.3), int(rng.integers(40, 81)), bool(rng.random() < 0.5)
    shrinks = size[0] < width
    picture = cv2.resize(picture, size, interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_CUBIC)
    # The blur is meant in pixels of the source: a large picture is as soft as a small one.
    picture = cv2.GaussianBlur(picture, (0, 0), sigma * max(1.0, size[0] / width) * (0.6 if shrinks else 1.0))
    if back:
        picture = cv2.resize(picture, (width, height), interpolation=cv2.INTER_CUBIC if shrinks else cv2.INTER_AREA)
    packed = cv2.imencode(".jpg", cv2.cvtColor(picture, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    picture = cv2.cvtColor(cv2.imdecode(packed, cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB)
    return picture, _rounded({"drawn_at": list(size), "kept_size": not back, "blur": sigma, "jpeg": quality})


def bend(
    picture: np.ndarray, masks: Mapping[str, np.ndarray], centres: Mapping[str, np.ndarray], rng: np.random.Generator
) -> Changed:
    """Objects drawn a little larger or smaller, and everything shifted by smooth local warps of a few pixels.

    Args:
        masks: (H, W) bool of each object.
        centres: (2,) pixel u, v that each object is scaled about.
    """
    height, width = picture.shape[:2]
    scales = {name: float(1 + rng.uniform(-SCALE, SCALE)) for name in masks}
    size = float(rng.uniform(2, 4))
    field = _smooth_field((height, width), size, rng) + _scale_field((height, width), masks, centres, scales)
    v, u = np.mgrid[:height, :width].astype(np.float32)
    bent = cv2.remap(picture, u + field[..., 0], v + field[..., 1], cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    return bent, _rounded({"warp_px": size, "scales": scales})


def _smooth_field(shape: tuple[int, int], size: float, rng: np.random.Generator) -> np.ndarray:
    """(H, W, 2) float32 displacements that vary slowly; the longest is ``size`` pixels."""
    rows, columns = (int(np.ceil(n / WARP_GRID)) + 3 for n in shape)
    knots = rng.normal(size=(rows, columns, 2)).astype(np.float32)
    fine = cv2.resize(knots, (columns * WARP_GRID, rows * WARP_GRID), interpolation=cv2.INTER_CUBIC)
    fine = fine[WARP_GRID : WARP_GRID + shape[0], WARP_GRID : WARP_GRID + shape[1]]
    return fine * (size / np.linalg.norm(fine, axis=-1).max())


def _scale_field(
    shape: tuple[int, int],
    masks: Mapping[str, np.ndarray],
    centres: Mapping[str, np.ndarray],
    scales: Mapping[str, float],
) -> np.ndarray:
    """(H, W, 2) float32 displacements that scale each object about its centre and fade out around it."""
    v, u = np.mgrid[: shape[0], : shape[1]].astype(np.float32)
    total, weights = np.zeros((*shape, 2), np.float32), np.full(shape, 1e-6, np.float32)
    for name, mask in masks.items():
        grown = cv2.dilate(mask.astype(np.uint8), np.ones((13, 13), np.uint8)).astype(np.float32)
        weight = cv2.GaussianBlur(grown, (0, 0), 4.0)
        offset = np.stack([u - centres[name][0] + 0.5, v - centres[name][1] + 0.5], axis=-1)
        total += (weight * (1 / scales[name] - 1))[..., None] * offset
        weights += weight
    return total / np.maximum(weights, 1.0)[..., None]


def shade(
    picture: np.ndarray,
    heights: Sequence[tuple[np.ndarray, float]],
    covered: np.ndarray,
    direction: np.ndarray,
    rng: np.random.Generator,
) -> Changed:
    """Soft shadows on the table beside the objects, as a painter adds them.

    Args:
        heights: (mask (H, W) bool, height in pixels) of each object.
        covered: (H, W) bool, where objects are: the table around them darkens, they hardly do.
        direction: (2,) unit vector in which shadows fall, u to the right, v down.
    """
    depth, length, soft = rng.uniform(0.12, 0.4), rng.uniform(0.25, 0.7), rng.uniform(3, 9)
    shadow = np.zeros(picture.shape[:2], np.float32)
    for mask, height in heights:
        for share in np.linspace(0.15, 1.0, 5):
            shift = direction * share * length * height
            matrix = np.array([[1, 0, shift[0]], [0, 1, shift[1]]], dtype=np.float32)
            moved = cv2.warpAffine(mask.astype(np.float32), matrix, picture.shape[1::-1])
            shadow = np.maximum(shadow, moved * (1.1 - 0.5 * share))
    shadow = np.clip(cv2.GaussianBlur(shadow, (0, 0), soft), 0, 1) * np.where(covered, 0.15, 1.0)
    shaded = picture.astype(np.float32) * (1 - depth * shadow[..., None])
    return _picture(shaded), _rounded({"shadow": depth, "shadow_length": length, "shadow_blur": soft})


def _picture(values: np.ndarray) -> np.ndarray:
    return np.clip(np.rint(values), 0, 255).astype(np.uint8)


def _rounded(values: Any) -> Any:
    """The same with every number as a plain one of four digits."""
    if isinstance(values, dict):
        return {key: _rounded(value) for key, value in values.items()}
    if isinstance(values, list | tuple | np.ndarray):
        return [_rounded(value) for value in values]
    return values if isinstance(values, bool | int | str) else round(float(values), 4)
