"""Views of objects from straight above: their symmetry, and which looks cannot be told apart.

Measured for the truth alone; nothing here is shared with what is scored. Objects are drawn in light from everywhere,
so that their shading turns with them, and compared as sharply as the top camera sees.

A turn counts as a symmetry when it changes the look by less than the pictures' other light does: two of the random
lights of the benchmark (their mean colour removed) change three quarters of the looks by up to 2.0 CIELAB units in
the mean over the silhouette and by up to 5.2 where they change it most, seen through a window of two pixels of the
top camera; the raster adds half a unit to the mean. A word of pale letters on a small lid, or a cap's seam, is less
than that; the face of a clock, the stem of a pepper, the print on a box are more.
"""

from __future__ import annotations

import functools

import cv2
import numpy as np

from vcage.objects.library import Library
from vcage.sim.appearance import Appearance
from vcage.sim.drawer import reference_view

Look = tuple[str, str]
"""Names of an asset and of its variant."""

METRES_PER_PIXEL = 0.0006
"""A third of the top camera's pixel: fine enough that its raster shows no turn."""

SOFTENING = 0.0017
"""Standard deviation of the blur before views are compared, metres: one pixel of the top camera."""

EVEN_LIGHT = Appearance(light_colour=(0.0, 0.0, 0.0), ambient=(1.0, 1.0, 1.0))

ORDERS = (12, 10, 9, 8, 6, 5, 4, 3, 2)
"""Orders that are tried, the highest first."""

ROUND_TURNS = np.radians([15, 33, 45, 71, 90, 120, 157, 180])
"""Turns that must all look the same for an object to be round."""

SHARPNESS = 0.0025
"""Standard deviation of the blur of looks that are turned, metres: the top camera's pixel and the mildest blur of
:func:`benchmarks._match.changes.soften`."""

WINDOW = 0.004
"""Standard deviation of the window of the strongest local difference, metres: about two pixels of the top camera."""

GROUND = 0.5
"""Grey that the object lies on: an outline that changes is a change of colour."""

MEAN_LIMIT, LOCAL_LIMIT = 2.5, 5.0
"""CIELAB units that a turn that nobody sees may change the look by, in the mean and in the window."""

COLOUR_LIMIT = 11.0
"""Grey levels: what 95 of 100 pixels of the silhouette of two looks that are alike may differ by at most."""

NEIGHBOURS = np.ones((3, 3), np.uint8)
"""A pixel differs by how far it lies outside the range of its neighbours: a print may be half a millimetre off."""

EDGE = np.ones((5, 5), np.uint8)
"""Silhouettes count as the same when each covers the other but for this much: less than a pixel of the top camera."""

UNCOVERED = 0.005
"""Share of a silhouette that the other may leave uncovered."""


@functools.cache
def library() -> Library:
    """The library with all that this machine has."""
    return Library.load()


@functools.cache
def _view(look: Look) -> np.ndarray:
    return reference_view(library().asset(*look).model, METRES_PER_PIXEL, EVEN_LIGHT)


@functools.cache
def symmetry(look: Look) -> int:
    """Order of rotational symmetry seen from above: 1 none, 0 any turn."""
    return symmetry_of(_view(look))


def symmetry_of(view: np.ndarray) -> int:
    """Order of rotational symmetry of a view (h, w, 4) uint8 RGBA about its middle."""
    view = _square(view, SHARPNESS)
    if all(_unseen(view, turn) for turn in ROUND_TURNS):
        return 0
    return next((n for n in ORDERS if all(_unseen(view, k * 2 * np.pi / n) for k in range(1, n // 2 + 1))), 1)


@functools.cache
def alike(a: Look, b: Look) -> bool:
    """True if two looks cannot be told apart from straight above: variants that differ in a label on their side."""
    first, second = _view(a), _view(b)
    return first.shape == second.shape and _same(_square(first, SOFTENING), _square(second, SOFTENING))


def _square(view: np.ndarray, blur: float) -> np.ndarray:
    """The view in the middle of a square that holds it at any turn, as float32; colours premultiplied and blurred by
    so many metres."""
    height, width = view.shape[:2]
    side = int(np.ceil(np.hypot(height, width))) + 2
    side += (side - height) % 2
    top, left = (side - height) // 2, (side - width) // 2
    square = np.zeros((side, side + (side - width) % 2, 4), np.float32)
    square[top : top + height, left : left + width] = view
    square[..., :3] *= square[..., 3:] / 255
    return cv2.GaussianBlur(square, (0, 0), blur / METRES_PER_PIXEL)


def _turned(view: np.ndarray, angle: float) -> np.ndarray:
    """The view turned about its middle by an angle in radians."""
    height, width = view.shape[:2]
    matrix = cv2.getRotationMatrix2D(((width - 1) / 2, (height - 1) / 2), float(np.degrees(angle)), 1.0)
    return cv2.warpAffine(view, matrix, (width, height), flags=cv2.INTER_LINEAR)


def _unseen(view: np.ndarray, turn: float) -> bool:
    """True if a view from :func:`_square` turned by an angle, radians, differs from itself by less than the limits."""
    other = _turned(view, turn)
    either = (view[..., 3] > 127) | (other[..., 3] > 127)
    if not either.any():
        return False
    difference = _lab(view) - _lab(other)
    mean = np.linalg.norm(difference, axis=-1)[either].mean()
    local = np.linalg.norm(cv2.GaussianBlur(difference, (0, 0), WINDOW / METRES_PER_PIXEL), axis=-1).max()
    return bool(mean <= MEAN_LIMIT and local <= LOCAL_LIMIT)


def _lab(view: np.ndarray) -> np.ndarray:
    """(h, w, 3) CIELAB of a view with premultiplied colours on the grey ground."""
    covered = view[..., 3:] / 255
    return cv2.cvtColor(np.clip(view[..., :3] / 255 + GROUND * (1 - covered), 0, 1), cv2.COLOR_RGB2LAB)


def _same(view: np.ndarray, other: np.ndarray) -> bool:
    """True if two views look the same: silhouettes that cover each other, and nearly the same colours."""
    before, after = ((one[..., 3] > 127).astype(np.uint8) for one in (view, other))
    if not (_covers(before, after) and _covers(after, before)):
        return False
    above, below = other - cv2.dilate(view, NEIGHBOURS), cv2.erode(view, NEIGHBOURS) - other
    difference = np.maximum(above, below)[..., :3].max(axis=-1)[(before | after) > 0]
    return float(np.percentile(difference, 95)) <= COLOUR_LIMIT


def _covers(one: np.ndarray, other: np.ndarray) -> bool:
    """True if a silhouette (h, w) of 0 and 1, grown by :data:`EDGE`, covers another."""
    return bool((other & ~np.asarray(cv2.dilate(one, EDGE), dtype=np.uint8)).sum() <= UNCOVERED * other.sum())
