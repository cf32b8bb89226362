"""Which turns of an object nobody sees from above, and how far two headings are apart when those are the same.

A plate has no heading and a plain box has two that look alike: asking a picture for more would report noise as error,
and turn objects for nothing.
"""

from __future__ import annotations

import cv2
import numpy as np

from vcage.igsc.alignment import LIGHTNESS
from vcage.models.offline.colour import to_lab

SIDE = 96
"""Pictures are compared at this size, pixels."""

ORDERS = (8, 6, 5, 4, 3, 2)
"""Orders that are tried, the highest first."""

ROUND_ANGLES = np.radians([17.0, 41.0, 73.0, 101.0, 139.0, 163.0])
"""An object that looks the same at all of these is round: no n-fold symmetry has them all."""

OUTLINE = 0.95
"""Least overlap (intersection over union) of the outline with itself turned."""

ALIKE, EXCEPTION = 9.0, 16.0
"""Colour distances, Lab units: of the pixels that differ most, one in twelve may exceed the first and one in fifty the
second. The reference's light comes from one side, so the same face turned is somewhat lighter or darker."""


def rotational_symmetry(reference: np.ndarray) -> int:
    """The n-fold rotational symmetry of an object seen from above: 1 none, 0 round.

    Both the outline and the colours must come back, so a box with a print on top has none.

    Args:
        reference: (h, w, 4) uint8 RGBA of the object alone from straight above; alpha 0 where it is not. An empty
            picture has no symmetry.
    """
    lab, mask = _normalised(reference)
    if not mask.any():
        return 1
    if all(_same(lab, mask, angle) for angle in ROUND_ANGLES):
        return 0
    for order in ORDERS:
        if all(_same(lab, mask, 2 * np.pi * k / order) for k in range(1, order // 2 + 1)):
            return order
    return 1


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


def _normalised(reference: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(SIDE, SIDE, 3) Lab and (SIDE, SIDE) alpha in [0, 1] of the object, centred, its extent filling the picture."""
    if reference.ndim != 3 or reference.shape[2] != 4 or not (reference[..., 3] > 127).any():
        return np.zeros((SIDE, SIDE, 3), np.float32), np.zeros((SIDE, SIDE), np.float32)
    alpha = (reference[..., 3] > 127).astype(np.float32)
    v, u = np.nonzero(alpha)
    centre = np.array([u.mean(), v.mean()])
    radius = float(np.hypot(u - centre[0], v - centre[1]).max()) + 1
    zoom = (SIDE / 2 - 3) / radius
    shrunk = cv2.GaussianBlur(reference[..., :3], (0, 0), max(0.8, 0.5 / zoom))
    shift = np.array([[zoom, 0, (SIDE - 1) / 2 - zoom * centre[0]], [0, zoom, (SIDE - 1) / 2 - zoom * centre[1]]])
    lab = cv2.warpAffine(to_lab(shrunk), shift, (SIDE, SIDE), flags=cv2.INTER_LINEAR)
    mask = cv2.warpAffine(cv2.GaussianBlur(alpha, (0, 0), max(0.5, 0.4 / zoom)), shift, (SIDE, SIDE))
    return lab * np.float32([LIGHTNESS, 1, 1]), mask


def _same(lab: np.ndarray, mask: np.ndarray, angle: float) -> bool:
    turn = cv2.getRotationMatrix2D(((SIDE - 1) / 2, (SIDE - 1) / 2), float(np.degrees(angle)), 1.0)
    turned, other = cv2.warpAffine(lab, turn, (SIDE, SIDE)), cv2.warpAffine(mask, turn, (SIDE, SIDE)) > 0.5
    inside = mask > 0.5
    if (inside & other).sum() < OUTLINE * (inside | other).sum():
        return False
    both = cv2.erode((inside & other).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    away = np.sqrt(((lab - turned) ** 2).sum(axis=-1))[both if both.any() else inside & other]
    return bool((away > ALIKE).mean() < 1 / 12 and (away > EXCEPTION).mean() < 1 / 50)
