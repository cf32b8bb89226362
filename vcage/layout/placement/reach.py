"""Rectangles of the table that a robot's arms reach and its camera sees, for the placement."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from vcage.base.geometry import Camera
from vcage.layout.placement.reach_map import SETTINGS, Question, ReachMap, Tilted
from vcage.layout.validation import as_workspace
from vcage.objects.asset import Asset
from vcage.schema.robot import Robot
from vcage.schema.scene import Role
from vcage.sim.cameras import overview
from vcage.sim.kinematics import TILTS

logger = logging.getLogger(__name__)


def robot_reach(
    robot: Robot,
    workspace: ArrayLike,
    heights: Sequence[float],
    folder: Path | None = None,
    every: bool = False,
    tilted: Tilted | None = None,
) -> np.ndarray:
    """Rectangles (m, 2, 2) of the plane in which some arm reaches straight down at all heights and headings.

    Where none does, arms that can reach a grasp with the hand tilted, and lift the object clear of the table, do as
    well. A cell of the grid counts when one arm reaches all of its corners, so no point of a rectangle is a guess
    between two that work; and when the robot's overview (:func:`~vcage.sim.cameras.overview`) sees all of them at the
    lowest height. They are cut to the workspace.

    The kinematics are not even built when the whole workspace is known from the cache. A damaged map is made again.

    Args:
        workspace: (2, 2) lower and upper corner, metres.
        heights: z of the gripper frame's origin that must be reached, metres.
        folder: of the maps, the user's cache if None.
        every: True for the area that every arm reaches, not just some arm.
        tilted: demands on a tilted hand; a grasp at the lowest height, at all headings, if None.

    Raises:
        UsageError: the workspace has no inside.
    """
    bounds = as_workspace(workspace)
    hand = tilted or Tilted()
    low = min(heights) + hand.higher
    straight = [ReachMap(arm, Question(tuple(heights)), folder) for arm in robot.arms.values()]
    leaning = [
        ReachMap(arm, Question((low, low + arm.gripper.approach), TILTS, hand.headings), folder)
        for arm in robot.arms.values()
    ]
    columns, rows = (_axis(*bounds[:, k]) for k in range(2))
    seen = _visible_cells(overview(robot), columns, rows, min(heights))
    reached = _cells(straight, columns, rows, seen, every=False)
    cells = _cells(leaning, columns, rows, seen & ~reached, every)
    cells |= _cells(straight, columns, rows, reached, every=True) if every else reached
    for known in (*straight, *leaning):
        known.save()
    xs, ys = (np.clip(SETTINGS.cell_m * np.array(axis), *bounds[:, k]) for k, axis in enumerate((columns, rows)))
    return _merge(cells, xs, ys)


def reach_for(asset: Asset, role: Role, reach: np.ndarray) -> np.ndarray | None:
    """Rectangles in which an object may stand at any heading with all points of its role in reach.

    A moved object has contact points, a receptacle functional points, a tool the points it
    has. An articulated object is operated at its handles, which its middle says nothing about.

    Args:
        reach: (m, 2, 2) rectangles where an arm reaches, metres.

    Returns:
        (k, 2, 2) rectangles for its middle, None for anywhere; ``reach`` itself, with a warning, where there are none.
    """
    if role == "context" or asset.articulated:
        return None
    contacts, receiving = asset.annotation.contact_points, asset.annotation.functional_points
    points = contacts if role == "content" or (role == "tool" and not receiving) else receiving
    radius = max((float(np.hypot(*point.position[:2])) for point in points), default=0.0)
    inset = reach + np.array([[radius], [-radius]])
    inset = inset[np.all(inset[:, 0] < inset[:, 1], axis=1)]
    if len(inset):
        return inset
    logger.warning(
        "nowhere on the table can %s be reached all around, %.0f mm from its middle", asset.name, 1000 * radius
    )
    return reach


def _axis(lower: float, upper: float) -> range:
    """The nodes along one axis that the cells between two bounds lie between."""
    first = int(np.floor(lower / SETTINGS.cell_m + 1e-9))
    return range(first, max(int(np.ceil(upper / SETTINGS.cell_m - 1e-9)), first + 1) + 1)


def _visible_cells(camera: Camera | None, columns: range, rows: range, height: float) -> np.ndarray:
    """(nx, ny) bool: the cells with all corners in view of a camera at a height; all without one."""
    x, y = np.meshgrid(SETTINGS.cell_m * np.array(columns), SETTINGS.cell_m * np.array(rows), indexing="ij")
    points = np.stack([x, y, np.full_like(x, height)], axis=-1)
    return _whole(np.ones(x.shape, dtype=bool) if camera is None else camera.sees(points))


def _whole(nodes: np.ndarray) -> np.ndarray:
    """(nx, ny) bool: the cells with all corners (nx + 1, ny + 1) true."""
    return nodes[:-1, :-1] & nodes[1:, :-1] & nodes[:-1, 1:] & nodes[1:, 1:]


def _cells(maps: Sequence[ReachMap], columns: range, rows: range, among: np.ndarray, every: bool) -> np.ndarray:
    """(nx, ny) bool: the cells ``among`` some that some arm, or every arm, reaches."""
    cells = among.copy() if every else np.zeros_like(among)
    for known in maps:
        # A pose out of reach costs the most, so cells that another arm has decided are not asked about again.
        nodes = np.zeros((len(columns), len(rows)), dtype=bool)
        for i, j in np.argwhere(_corners(cells if every else among & ~cells)):
            nodes[i, j] = known.reaches((columns[i], rows[j]))
        reached = _whole(nodes)
        cells = cells & reached if every else cells | (among & reached)
    return cells


def _corners(cells: np.ndarray) -> np.ndarray:
    """(nx + 1, ny + 1) bool: the nodes at the corners of cells (nx, ny)."""
    wide = np.pad(cells, 1)
    return wide[:-1, :-1] | wide[1:, :-1] | wide[:-1, 1:] | wide[1:, 1:]


def _merge(cells: np.ndarray, xs: np.ndarray, ys: np.ndarray) -> np.ndarray:
    """Cells (nx, ny) as overlapping maximal rectangles (m, 2, 2): a box across a cell border must find room."""
    found = set()
    for i0, i1 in ((a, b) for a in range(len(cells)) for b in range(a + 1, len(cells) + 1)):
        columns = cells[i0:i1].all(axis=0)
        edges = np.flatnonzero(np.diff(np.concatenate([[0], columns.astype(np.int8), [0]])))
        found |= {(i0, i1, int(j0), int(j1)) for j0, j1 in edges.reshape(-1, 2)}
    maximal = [
        r
        for r in found
        if not any(r != s and s[0] <= r[0] and r[1] <= s[1] and s[2] <= r[2] and r[3] <= s[3] for s in found)
    ]
    return np.array([[[xs[i0], ys[j0]], [xs[i1], ys[j1]]] for i0, i1, j0, j1 in sorted(maximal)]).reshape(-1, 2, 2)
