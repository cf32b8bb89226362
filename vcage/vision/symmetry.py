"""Which turns of an object nobody sees from above, and how far two headings are apart when those are the same.

A plate has no heading and a plain box has two that look alike: asking a picture for more would report noise as error,
and turn objects for nothing.
"""

from __future__ import annotations

import cv2
import numpy as np

from vcage.vision.pose_score import LIGHTNESS

ORDERS = (8, 6, 5, 4, 3, 2)
"""Orders that are tried, the highest first."""

ROUND_ANGLES = np.radians([17.0, 41.0, 73.0, 101.0, 139.0, 163.0])
"""An object that looks the same at all of these is round: no n-fold symmetry has them all."""

BLUR, WINDOW = 1.4, 2.7
"""Standard deviations, pixels of the reference, of the blur before looks are compared and of the window of the
strongest local difference: the sharpness of the top camera, and two of its pixels."""

OUTLINE = 25.0
"""Colour distance of the object to what is around it: its outline's raster must not count as much as its colours."""

MEAN_LIMIT, LOCAL_LIMIT = 4.0, 5.0
"""Colour distances, weighted Lab units, of a turn that nobody sees: in the mean over the object, and in the window. A
slope of the lightness is taken away before: the reference's light comes from one side."""

MARGIN = 6
"""Empty pixels around the object at any turn."""


def rotational_symmetry(reference: np.ndarray) -> int:
    """The n-fold rotational symmetry of an object seen from above: 1 none, 0 round.

    Both the outline and the colours must come back, so a box with a print on top has none.

    Args:
        reference: (h, w, 4) uint8 RGBA of the object alone from straight above; alpha 0 where it is not. An empty
            picture has no symmetry.
    """
    if reference.ndim != 3 or reference.shape[2] != 4 or not (reference[..., 3] > 127).any():
        return 1
    look = _centred(reference)
    if all(_same(look, angle) for angle in ROUND_ANGLES):
        return 0
    return next((n for n in ORDERS if all(_same(look, 2 * np.pi * k / n) for k in range(1, n // 2 + 1))), 1)


def yaw_error(a: float, b: float, order: int) -> float:
    """How far two headings are apart, radians in [0, π / order]; 0 for a round object (order 0).

    Raises:
        ValueError: the order is negative.
    """
    if order < 0:
        raise ValueError(f"no symmetry has the order {order}")
    if order == 0:
        return 0.0
    period = 2 * np.pi / order
    return float(abs((a - b + period / 2) % period - period / 2))


def smallest_turn(angle: float, order: int) -> float:
    """The smallest of the turns that look the same on an object of n-fold symmetry (0: round), radians."""
    if order == 0:
        return 0.0
    period = 2 * np.pi / max(order, 1)
    return float((angle + period / 2) % period - period / 2)


def _centred(reference: np.ndarray) -> np.ndarray:
    """(n, n, 4) float32 blurred look with premultiplied colours in [0, 1], the middle of its outline in the middle."""
    solid = (reference[..., 3] > 127).astype(np.float32)
    v, u = np.nonzero(solid)
    centre = np.array([u.mean(), v.mean()])
    side = 2 * (int(np.hypot(u - centre[0], v - centre[1]).max()) + MARGIN) + 1
    look = np.dstack([reference[..., :3].astype(np.float32) / 255 * solid[..., None], solid])
    shift = np.column_stack([np.eye(2), (side - 1) / 2 - centre])
    return cv2.GaussianBlur(cv2.warpAffine(look, shift, (side, side), flags=cv2.INTER_LINEAR), (0, 0), BLUR)


def _same(look: np.ndarray, angle: float) -> bool:
    side = len(look)
    turn = cv2.getRotationMatrix2D(((side - 1) / 2, (side - 1) / 2), float(np.degrees(angle)), 1.0)
    turned = cv2.warpAffine(look, turn, (side, side), flags=cv2.INTER_LINEAR)
    either = (look[..., 3] > 0.5) | (turned[..., 3] > 0.5)
    ground = look[..., :3].sum(axis=(0, 1)) / look[..., 3].sum()
    away = (_measured(look, ground) - _measured(turned, ground)) * np.array([LIGHTNESS, 1, 1, OUTLINE], np.float32)
    _level(away[..., 0], (look[..., 3] > 0.9) & (turned[..., 3] > 0.9))
    local = np.linalg.norm(cv2.GaussianBlur(away, (0, 0), WINDOW), axis=-1).max()
    return bool(local <= LOCAL_LIMIT and np.linalg.norm(away, axis=-1)[either].mean() <= MEAN_LIMIT)


def _measured(look: np.ndarray, ground: np.ndarray) -> np.ndarray:
    """(n, n, 4) Lab of a look on a ground of its mean colour, and its alpha."""
    covered = look[..., 3:]
    return np.dstack([cv2.cvtColor(np.clip(look[..., :3] + ground * (1 - covered), 0, 1), cv2.COLOR_RGB2LAB), covered])


def _level(lightness: np.ndarray, inside: np.ndarray) -> None:
    """Take the plane that fits best inside a mask away from a picture (n, n), there."""
    v, u = np.nonzero(inside)
    if len(v) > 20:
        plane = np.stack([np.ones(len(v)), u / len(inside), v / len(inside)], axis=1)
        lightness[v, u] -= plane @ np.linalg.lstsq(plane, lightness[v, u], rcond=None)[0]
