"""Rotational symmetry of objects seen from above, and the smallest of the turns that look the same under it.

A plate has no heading, and a plain box has two that look alike. Without symmetry, noise would count as an error and
objects would be turned for nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from vcage.vision.pose_score import LIGHTNESS

ORDERS = (8, 6, 5, 4, 3, 2)
"""Tested orders, the highest first."""

ROUND_ANGLES = np.radians([17.0, 41.0, 73.0, 101.0, 139.0, 163.0])
"""An object that looks the same at all of these is round: no n-fold symmetry has them all."""


@dataclass(frozen=True)
class SymmetrySettings:
    """Comparison of an object's look with the same look turned.

    Args:
        blur_px: standard deviation of the blur before looks are compared, pixels of the reference: the sharpness of
            the top camera.
        window_px: standard deviation of the window of the strongest local difference: two of the camera's pixels.
        outline: colour distance of the object to its surroundings, so that the raster of its outline does not count
            as much as its colours.
        mean_limit, local_limit: colour distances of an invisible turn, weighted Lab units: in the mean over the
            object, and in the window. The reference's light comes from one side, so a slope of the lightness is
            removed first.
        margin_px: empty pixels around the object at any turn.
    """

    blur_px: float = 1.4
    window_px: float = 2.7
    outline: float = 25.0
    mean_limit: float = 4.0
    local_limit: float = 5.0
    margin_px: int = 6


SETTINGS = SymmetrySettings()


def rotational_symmetry(reference: np.ndarray) -> int:
    """The n-fold rotational symmetry of an object seen from above: 1 none, 0 round.

    Both the outline and the colours must come back, so a box with a print on top has none.

    Args:
        reference: (h, w, 4) uint8 RGBA of the object alone from straight above; alpha 0 beside it. An empty
            picture has no symmetry.
    """
    if reference.ndim != 3 or reference.shape[2] != 4 or not (reference[..., 3] > 127).any():
        return 1
    look = _centred(reference)
    if all(_same(look, angle) for angle in ROUND_ANGLES):
        return 0
    return next((n for n in ORDERS if all(_same(look, 2 * np.pi * k / n) for k in range(1, n // 2 + 1))), 1)


def smallest_turn(angle: float, order: int) -> float:
    """The smallest of the turns that look the same on an object of n-fold symmetry (0: round), radians.

    Raises:
        ValueError: the order is negative.
    """
    if order < 0:
        raise ValueError(f"no symmetry has the order {order}")
    if order == 0:
        return 0.0
    period = 2 * np.pi / order
    return float((angle + period / 2) % period - period / 2)


def _centred(reference: np.ndarray) -> np.ndarray:
    """(n, n, 4) float32 blurred look with premultiplied colours in [0, 1], the middle of its outline in the middle."""
    solid = (reference[..., 3] > 127).astype(np.float32)
    v, u = np.nonzero(solid)
    centre = np.array([u.mean(), v.mean()])
    side = 2 * (int(np.hypot(u - centre[0], v - centre[1]).max()) + SETTINGS.margin_px) + 1
    look = np.dstack([reference[..., :3].astype(np.float32) / 255 * solid[..., None], solid])
    shift = np.column_stack([np.eye(2), (side - 1) / 2 - centre])
    moved = cv2.warpAffine(look, shift, (side, side), flags=cv2.INTER_LINEAR)
    return cv2.GaussianBlur(moved, (0, 0), SETTINGS.blur_px)


def _same(look: np.ndarray, angle: float) -> bool:
    side = len(look)
    turn = cv2.getRotationMatrix2D(((side - 1) / 2, (side - 1) / 2), float(np.degrees(angle)), 1.0)
    turned = cv2.warpAffine(look, turn, (side, side), flags=cv2.INTER_LINEAR)
    either = (look[..., 3] > 0.5) | (turned[..., 3] > 0.5)
    ground = look[..., :3].sum(axis=(0, 1)) / look[..., 3].sum()
    weights = np.array([LIGHTNESS, 1, 1, SETTINGS.outline], np.float32)
    away = (_measured(look, ground) - _measured(turned, ground)) * weights
    _level(away[..., 0], (look[..., 3] > 0.9) & (turned[..., 3] > 0.9))
    local = np.linalg.norm(cv2.GaussianBlur(away, (0, 0), SETTINGS.window_px), axis=-1).max()
    return bool(local <= SETTINGS.local_limit and np.linalg.norm(away, axis=-1)[either].mean() <= SETTINGS.mean_limit)


def _measured(look: np.ndarray, ground: np.ndarray) -> np.ndarray:
    """(n, n, 4) Lab of a look on a ground of its mean colour, and its alpha."""
    covered = look[..., 3:]
    return np.dstack([cv2.cvtColor(np.clip(look[..., :3] + ground * (1 - covered), 0, 1), cv2.COLOR_RGB2LAB), covered])


def _level(lightness: np.ndarray, inside: np.ndarray) -> None:
    """Subtract from a picture (n, n), inside a mask, its best-fitting plane."""
    v, u = np.nonzero(inside)
    if len(v) > 20:
        plane = np.stack([np.ones(len(v)), u / len(inside), v / len(inside)], axis=1)
        lightness[v, u] -= plane @ np.linalg.lstsq(plane, lightness[v, u], rcond=None)[0]
