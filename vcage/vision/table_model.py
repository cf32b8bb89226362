"""Salience of each pixel over the table, whatever became of the table's colour, texture and light.

Two models of the empty table are fitted robustly to the picture: a smooth colour field, and the same plus the known
picture of the empty table. The one with less residual is used, so a table that an image model repainted is
described by the picture itself.

Shade and colour are separated: more or less light scales (L + 16, a, b) of CIELAB as a whole, as all three are
differences of cube roots of linear light. No shadow explains a deviation across that direction.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.geometry import Camera
from vcage.schema.scene import Table
from vcage.vision.colour import to_lab


@dataclass(frozen=True)
class TableModelSettings:
    """Fit of the table and scale of the salience.

    Args:
        stride_px: spacing of the pixels that are fitted, along each side.
        rounds: of reweighted least squares.
        least_grain: smallest deviation of a table's colours from its model, by compression and noise, Lab units.
        half_salience: deviation, in units of the grain, at which a pixel has the salience 1/2.
        darkening_share: weight of mere darkening, which may be a shadow.
        informed_share: the known picture is used where it leaves a smaller share of the grain: fitted to a table
            repainted, it only adds its own pattern.
        edge_px: strip along the table's edge that is left out; an edited picture may bend it.
    """

    stride_px: int = 6
    rounds: int = 8
    least_grain: float = 0.8
    half_salience: float = 4.0
    darkening_share: float = 0.35
    informed_share: float = 0.9
    edge_px: int = 4


SETTINGS = TableModelSettings()
THIN = np.s_[:: SETTINGS.stride_px, :: SETTINGS.stride_px]


@dataclass(frozen=True)
class TableModel:
    """The salience of a picture, and the fit behind it.

    Args:
        salience: (H, W) float32 in [0, 1]: 0 is table or its shadow, 1 surely not.
        known: True if the picture of the empty table improved the fit.
    """

    salience: np.ndarray
    known: bool


def fit_table(
    picture: np.ndarray, background: np.ndarray | None = None, region: np.ndarray | None = None
) -> TableModel:
    """The better of the models of the table in a picture.

    Args:
        picture: (H, W, 3) uint8.
        background: (H, W, 3) uint8, the empty table as it was, or None.
        region: (H, W) bool, the table; None for the whole picture.
    """
    values = _shifted_lab(picture)
    region = np.ones(values.shape[:2], bool) if region is None or not region.any() else region
    plain = _deviation(values, _fit(values, _smooth_terms(values.shape[:2]), region))
    grain, known = _grain(plain, region), False
    if background is not None:
        light = _shifted_lab(background)[..., :1] / 100
        informed = _deviation(values, _fit(values, np.dstack([_smooth_terms(values.shape[:2]), light]), region))
        better = _grain(informed, region)
        if better.sum() < SETTINGS.informed_share * grain.sum():
            plain, grain, known = informed, better, True
    return TableModel(_salience(plain, grain) * region, known)


def table_region(camera: Camera, table: Table) -> np.ndarray:
    """(H, W) bool, the pixels of the table's top in the camera's picture, without a strip along its edge."""
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.array(table.size) / 2 + table.centre
    pixels = camera.project(np.column_stack([corners, np.full(4, table.height)]))
    drawn = np.zeros((camera.height, camera.width), np.uint8)
    if not np.all(np.isfinite(pixels)):
        return ~drawn.astype(bool)
    cv2.fillConvexPoly(drawn, np.round(np.clip(pixels, -1e4, 1e4)).astype(np.int32), (1,))
    return cv2.erode(drawn, np.ones((2 * SETTINGS.edge_px + 1,) * 2, np.uint8), borderValue=(1,)) > 0


def _shifted_lab(picture: np.ndarray) -> np.ndarray:
    """(H, W, 3) float32 L + 16, a, b of the slightly blurred picture."""
    return to_lab(cv2.GaussianBlur(picture, (0, 0), 1.0)) + np.array([16, 0, 0], np.float32)


def _smooth_terms(shape: tuple[int, ...]) -> np.ndarray:
    """(H, W, 6) terms of a quadratic field over the picture."""
    v, u = np.meshgrid(*(np.linspace(-1, 1, n, dtype=np.float32) for n in shape), indexing="ij")
    return np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=-1)


def _fit(values: np.ndarray, terms: np.ndarray, region: np.ndarray) -> np.ndarray:
    """(H, W, 3) the terms fitted to the majority of the region's values."""
    design, wanted = terms[THIN][region[THIN]].astype(np.float64), values[THIN][region[THIN]].astype(np.float64)
    if len(design) < 4 * terms.shape[-1]:
        return np.broadcast_to(np.median(values[region], axis=0), values.shape)
    left, coefficients = wanted - np.median(wanted, axis=0), np.zeros((design.shape[1], 3))
    for _ in range(SETTINGS.rounds):
        away = left / np.maximum(_spread(left), 0.5)
        weight = 1 / (1 + (away * away).sum(axis=1) / 4) ** 2
        weighted = design * weight[:, None]
        ridge = 1e-6 * weight.sum() * np.eye(design.shape[1])
        coefficients = np.linalg.solve(weighted.T @ design + ridge, weighted.T @ wanted)
        left = wanted - design @ coefficients
    return terms @ coefficients.astype(np.float32)


def _deviation(values: np.ndarray, table: np.ndarray) -> np.ndarray:
    """(H, W, 4) deviation from the table's colour: along its shade (negative is darker), then across it."""
    squared = (table * table).sum(axis=-1)
    share = (values * table).sum(axis=-1) / np.maximum(squared, 1.0)
    return np.dstack([(share - 1) * np.sqrt(squared), values - share[..., None] * table])


def _grain(deviation: np.ndarray, region: np.ndarray) -> np.ndarray:
    return np.maximum(_spread(deviation[THIN][region[THIN]]), SETTINGS.least_grain)


def _spread(values: np.ndarray) -> np.ndarray:
    """Robust standard deviations of (n, k) values around zero."""
    return 1.4826 * np.median(np.abs(values), axis=0)


def _salience(deviation: np.ndarray, grain: np.ndarray) -> np.ndarray:
    """(H, W) in [0, 1] from deviations in units of the grain; darkening alone counts less."""
    z = deviation / grain.astype(np.float32)
    shade = np.where(z[..., 0] < 0, SETTINGS.darkening_share * z[..., 0], z[..., 0])
    squares = shade * shade + (z[..., 1:] ** 2).sum(axis=-1)
    return (squares / (squares + SETTINGS.half_salience**2)).astype(np.float32)
