"""Free room and material, measured on convex pieces.

Rectangles are found on a grid of 1 mm: a cell is covered when its middle is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import ArrayLike

from vcage.objects.convex import Convex


@dataclass(frozen=True)
class OpeningSettings:
    """Settings of the measurements.

    Args:
        cell_m: edge of a grid cell.
        same_height_m: heights closer than this count as equal.
        touch_m: a contact point this close to the surface counts as in the material.
        wall_share: share of the depth from which sloping walls count: an object in a bowl does not need the
            bowl's flat bottom.
        foot_m: height above the floor from which walls count for an object that stands in a container with a
            flat bottom; a handle over a tray does not lower its walls then.
    """

    cell_m: float = 0.001
    same_height_m: float = 0.0015
    touch_m: float = 0.001
    wall_share: float = 0.5
    foot_m: float = 0.003


SETTINGS = OpeningSettings()


@dataclass(frozen=True)
class Opening:
    """The room at a functional point, in the object frame, metres.

    Args:
        centre: (2,) centre of the largest axis-aligned free rectangle around the point.
        size: (2,) its edge lengths.
        floor: height of the receiving surface.
        rim: height of the highest thing around it; equal to ``floor`` for a bare surface.
    """

    centre: tuple[float, float]
    size: tuple[float, float]
    floor: float
    rim: float

    @property
    def depth(self) -> float:
        """Height of the rim above the floor, metres."""
        return self.rim - self.floor


def grasped_width(pieces: Sequence[Convex], point: ArrayLike, axis: ArrayLike) -> float:
    """Return the distance between fingers that close along ``axis`` around ``point``, metres.

    Inside material it is the thickness there, such as a wall's. In the hollow of a mug or a ring it is the distance
    between the outer faces. It is 0 where there is material on one side only, or none.

    Args:
        pieces: the collision shape.
        point: (3,) between the fingers, metres.
        axis: (3,) unit vector.
    """
    stretches = material_along(pieces, point, axis)
    for start, end in stretches:
        if start <= SETTINGS.touch_m and end >= -SETTINGS.touch_m:
            return end - start
    around = bool(stretches) and stretches[0][0] < 0 < stretches[-1][1]
    return stretches[-1][1] - stretches[0][0] if around else 0.0


def closed_width(pieces: Sequence[Convex], points: ArrayLike, axis: ArrayLike, opening: float) -> float:
    """Return the distance between fingers that close along ``axis`` until both meet material, metres.

    Args:
        pieces: the collision shape.
        points: (k, 3) between the fingers, over all their surface, metres.
        axis: (3,) unit vector.
        opening: from which they close, metres.
    """
    found = np.concatenate([piece.intervals(points, axis) for piece in pieces])
    within = np.clip(found[found[:, 0] < found[:, 1]], -opening / 2, opening / 2)
    within = within[within[:, 0] < within[:, 1]]
    return float(np.ptp(within)) if len(within) else 0.0


def material_along(pieces: Sequence[Convex], point: ArrayLike, axis: ArrayLike) -> list[tuple[float, float]]:
    """Stretches (t0, t1) of material along the line through ``point``, in order, joined where pieces touch.

    Args:
        pieces: the collision shape.
        point: (3,) metres, where t is 0.
        axis: (3,) unit vector.
    """
    joined: list[tuple[float, float]] = []
    for start, end in sorted(i for piece in pieces if (i := piece.interval(point, axis)) is not None):
        if joined and start <= joined[-1][1] + 1e-4:
            joined[-1] = (joined[-1][0], max(joined[-1][1], end))
        else:
            joined.append((start, end))
    return joined


def room_inside(pieces: Sequence[Convex], point: Sequence[float], *, standing: bool = False) -> Opening:
    """The largest free rectangle around ``point`` between the walls above its height.

    Args:
        standing: the room of an object standing on the floor as a box; otherwise of an object dropped there.
    """
    floor = _support_height(pieces, point)
    rim = max(float(piece.vertices[:, 2].max()) for piece in pieces)
    from_height = SETTINGS.foot_m if standing else SETTINGS.wall_share * (rim - floor)
    blocked = _grid(pieces, floor + max(SETTINGS.same_height_m, from_height), np.inf)
    return _opening(~blocked, pieces, point, floor, rim)


def room_under_roof(pieces: Sequence[Convex], point: Sequence[float]) -> Opening:
    """The largest free rectangle of the floor around ``point`` up to the ceiling over it: an oven, a shelf.

    Its rim is the ceiling.

    Raises:
        ValueError: there is no ceiling, or no room under it.
    """
    floor = _support_height(pieces, point)
    spans = [i for piece in pieces if (i := piece.interval(point, (0.0, 0.0, 1.0))) is not None]
    above = [point[2] + start for start, _ in spans if point[2] + start > floor + SETTINGS.same_height_m]
    if not above:
        raise ValueError(f"nothing is over the functional point {tuple(point)}")
    ceiling = float(min(above))
    carried = _grid(pieces, floor - SETTINGS.same_height_m, floor + SETTINGS.same_height_m)
    blocked = _grid(pieces, floor + SETTINGS.same_height_m, ceiling - SETTINGS.same_height_m)
    return _opening(carried & ~blocked, pieces, point, floor, ceiling)


def surface_on_top(pieces: Sequence[Convex], point: Sequence[float]) -> Opening:
    """The largest rectangle around ``point`` of the surface at its height that nothing stands on."""
    floor = _support_height(pieces, point)
    carried = _grid(pieces, floor - SETTINGS.same_height_m, floor + SETTINGS.same_height_m)
    blocked = _grid(pieces, floor + SETTINGS.same_height_m, np.inf)
    top = max(float(piece.vertices[:, 2].max()) for piece in pieces)
    rim = top if top > floor + SETTINGS.same_height_m else floor
    return _opening(carried & ~blocked, pieces, point, floor, rim)


def _support_height(pieces: Sequence[Convex], point: Sequence[float]) -> float:
    """Height of the material under ``point``, which must be near the point's own height."""
    spans = [i for piece in pieces if (i := piece.interval(point, (0.0, 0.0, 1.0))) is not None]
    tops = [end for start, end in spans if abs(end) < 0.005]
    if not tops:
        raise ValueError(f"no surface within 5 mm of the functional point {tuple(point)}")
    return float(point[2] + max(tops))


def _frame(pieces: Sequence[Convex]) -> tuple[np.ndarray, np.ndarray]:
    """Lower corner (2,) and shape (columns, rows) of a grid that is centred over all pieces."""
    points = np.concatenate([piece.vertices[:, :2] for piece in pieces])
    lower, upper = points.min(axis=0), points.max(axis=0)
    shape = np.ceil((upper - lower) / SETTINGS.cell_m - 1e-6).astype(int)
    return (lower + upper - shape * SETTINGS.cell_m) / 2, shape


def _grid(pieces: Sequence[Convex], low: float, high: float) -> np.ndarray:
    """(rows, columns) bool: cells over whose middle some piece has material between the heights."""
    lower, (columns, rows) = _frame(pieces)
    covered = np.zeros((rows, columns), dtype=bool)
    x, y = (lower[i] + (np.arange(n) + 0.5) * SETTINGS.cell_m for i, n in enumerate((columns, rows)))
    for piece in pieces:
        shadow = piece.shadow(low, high)
        if len(shadow) < 3 or np.ptp(shadow, axis=0).min() < 1e-6:
            continue
        outline = cv2.convexHull(shadow.astype(np.float32)).reshape(-1, 2).astype(np.float64)
        edge = np.roll(outline, -1, axis=0) - outline
        turn = np.sign(np.cross(edge, np.roll(edge, -1, axis=0)).sum())
        u, v = (np.flatnonzero((t >= s.min()) & (t <= s.max())) for t, s in ((x, outline[:, 0]), (y, outline[:, 1])))
        if len(u) and len(v):
            across = edge[:, :1, None] * (y[v][None, :, None] - outline[:, 1, None, None])
            along = edge[:, 1:, None] * (x[u][None, None, :] - outline[:, 0, None, None])
            covered[v[0] : v[-1] + 1, u[0] : u[-1] + 1] |= (turn * (across - along) >= -1e-12).all(axis=0)
    return covered


def _opening(free: np.ndarray, pieces: Sequence[Convex], point: Sequence[float], floor: float, rim: float) -> Opening:
    lower, _ = _frame(pieces)
    column, row = np.floor((np.asarray(point[:2]) - lower) / SETTINGS.cell_m).astype(int)
    rectangle = largest_rectangle(free, int(row), int(column))
    if rectangle is None:
        raise ValueError(f"no free room at the functional point {tuple(point)}")
    r0, r1, c0, c1 = rectangle
    corner, size = lower + np.array([c0, r0]) * SETTINGS.cell_m, np.array([c1 - c0, r1 - r0]) * SETTINGS.cell_m
    centre = corner + size / 2
    return Opening((float(centre[0]), float(centre[1])), (float(size[0]), float(size[1])), floor, rim)


def largest_rectangle(free: np.ndarray, row: int, column: int) -> tuple[int, int, int, int] | None:
    """The largest all-true rectangle (row0, row1, column0, column1), half open, that holds a cell, if any.

    Grows the rows upwards and downwards from the cell; for each pair of limits the widest run of columns that are
    free in all rows is the meet of the rows' runs around the cell's column.

    Args:
        free: (rows, columns) bool.
        row, column: of the cell.
    """
    rows, columns = free.shape
    if not (0 <= row < rows and 0 <= column < columns and free[row, column]):
        return None
    blocked = ~free
    left = np.array([np.flatnonzero(line[: column + 1])[-1] + 1 if line[: column + 1].any() else 0 for line in blocked])
    right = np.array([column + np.argmax(line[column:]) if line[column:].any() else columns for line in blocked])
    usable = free[:, column]
    top = row
    while top > 0 and usable[top - 1]:
        top -= 1
    bottom = row + 1
    while bottom < rows and usable[bottom]:
        bottom += 1
    up_left = np.maximum.accumulate(left[top : row + 1][::-1])  # limits when rows row…row-i are taken
    up_right = np.minimum.accumulate(right[top : row + 1][::-1])
    down_left = np.maximum.accumulate(left[row:bottom])
    down_right = np.minimum.accumulate(right[row:bottom])
    c0 = np.maximum(up_left[:, None], down_left[None])
    c1 = np.minimum(up_right[:, None], down_right[None])
    heights = np.arange(len(up_left))[:, None] + np.arange(len(down_left))[None] + 1
    i, j = np.unravel_index(np.argmax((c1 - c0) * heights), heights.shape)
    return row - int(i), row + int(j) + 1, int(c0[i, j]), int(c1[i, j])
