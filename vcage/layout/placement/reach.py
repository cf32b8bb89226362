"""Where on the table a robot's arms reach, as rectangles that the placement can use.

Inverse kinematics is asked at the nodes of a grid of the world, once for each robot: what is known of a node is kept in
the user's cache and serves every workspace that it lies in.
"""

from __future__ import annotations

import hashlib
import json
import logging
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from vcage.base.errors import DamagedFile, MissingStage, OutputFolderError, PartlyDone
from vcage.base.files import cache_dir, read_json, sha256_file, write_json
from vcage.base.geometry import Pose
from vcage.layout.validation import as_workspace
from vcage.objects.asset import Asset
from vcage.schema.robot import Arm, Robot
from vcage.schema.scene import Role
from vcage.sim.kinematics import kinematics_of
from vcage.sim.robots import package_file

logger = logging.getLogger(__name__)

CELL = 0.05
"""Grid of the reach map, metres; its nodes are the world's multiples of it."""

GRASP_HEIGHTS = (0.03, 0.22)
"""Heights above the table at which an arm must reach an object that is moved, metres."""

YAWS = tuple(np.radians(degrees) for degrees in (0.0, 45.0, 90.0, 135.0))
"""Headings of the gripper that one arm must reach at a point; half a turn on is the same grasp."""

VERSION = 1
"""Of what a node's answer means; raised when kinematics or the question change, so that older maps are not used."""

Node = tuple[int, int]
"""A node of the grid, in cells from the world's origin."""


class Reaching(Protocol):
    """Whether a pose of the gripper frame in the world can be reached."""

    def reachable(self, pose: Pose) -> bool: ...


def robot_reach(
    robot: Robot, workspace: ArrayLike, heights: Sequence[float], folder: Path | None = None, every: bool = False
) -> np.ndarray:
    """Rectangles (m, 2, 2) of the plane in which some arm reaches straight down at all heights and headings.

    A cell of the grid counts when one arm reaches all of its corners, so no point of a rectangle is a guess
    between two that work. They are cut to the workspace.

    The kinematics are not even built when the whole workspace is known from the cache. A damaged map is made again; one
    that cannot be written is told and does without.

    Args:
        workspace: (2, 2) lower and upper corner, metres.
        heights: z of the gripper frame's origin that must be reached, metres.
        folder: where maps are kept, the user's cache if None.
        every: what all arms reach instead, each by itself.

    Raises:
        UsageError: the workspace has no inside.
    """
    bounds = as_workspace(workspace)
    maps = {name: _ReachMap(arm, heights, folder) for name, arm in robot.arms.items()}
    found = _rectangles({name: known.reaches for name, known in maps.items()}, bounds, every)
    for known in maps.values():
        known.save()
    return found


def reach_for(asset: Asset, role: Role, reach: np.ndarray) -> np.ndarray | None:
    """Where an object may stand at any heading, so that what its role needs of it is reached; None for anywhere.

    Of what is moved those are the contact points, of what receives it the functional points. What has moving parts is
    operated at its handles, which its middle says nothing about.

    Args:
        reach: (m, 2, 2) rectangles where an arm reaches, metres.

    Returns:
        (k, 2, 2) rectangles for its middle; where they would be none, ``reach`` itself, and a warning.
    """
    if role == "context" or asset.articulated:
        return None
    points = asset.annotation.contact_points if role == "content" else asset.annotation.functional_points
    radius = max((float(np.hypot(*point.position[:2])) for point in points), default=0.0)
    inset = reach + np.array([[radius], [-radius]])
    inset = inset[np.all(inset[:, 0] < inset[:, 1], axis=1)]
    if len(inset):
        return inset
    logger.warning(
        "nowhere on the table can %s be reached all around, %.0f mm from its middle", asset.name, 1000 * radius
    )
    return reach


# --- what is asked of inverse kinematics ---------------------------------------------------------------


def _reaches(arm: Reaching, node: Node, heights: Sequence[float]) -> bool:
    """Whether an arm reaches straight down at a node, at all heights and headings."""
    x, y = CELL * node[0], CELL * node[1]
    for height in heights:
        for yaw in YAWS:
            down = Pose.from_yaw([x, y, height], yaw) * Pose(q=[0, 1, 0, 0])
            if not (arm.reachable(down) or arm.reachable(down * Pose(q=[0, 0, 0, 1]))):
                return False
    return True


class _ReachMap:
    """What is known of one arm's reach, kept as ``reach/<key>.json``: for each node that was asked, the answer.

    The key is of all that an answer depends on, the arm's record, its URDF, the heights and the grid; not of the
    workspace.
    """

    def __init__(self, arm: Arm, heights: Sequence[float], folder: Path | None):
        self._arm, self._heights = arm, heights
        self._path = (folder or cache_dir("reach")) / f"{_key(arm, heights)}.json"
        self._known = _read(self._path)
        self._changed = False

    def reaches(self, node: Node) -> bool:
        if node not in self._known:
            self._known[node] = _reaches(kinematics_of(self._arm), node, self._heights)
            self._changed = True
        return self._known[node]

    def save(self) -> None:
        if not self._changed:
            return
        nodes = [[*node, int(reached)] for node, reached in sorted(self._known.items())]
        try:
            write_json(self._path, {"cell_m": CELL, "nodes": nodes})
        except (OutputFolderError, PartlyDone) as error:
            logger.warning("the reach map is not kept: %s", error.message)


def _key(arm: Arm, heights: Sequence[float]) -> str:
    question = {
        "version": VERSION,
        "arm": arm.model_dump(mode="json", exclude={"urdf", "srdf"}),
        "urdf": sha256_file(package_file(arm.urdf)),
        "heights": [round(float(height), 6) for height in heights],
        "yaws": YAWS,
        "cell": CELL,
    }
    return hashlib.sha256(json.dumps(question, sort_keys=True).encode()).hexdigest()[:32]


def _read(path: Path) -> dict[Node, bool]:
    """The nodes of a map; none when there is no map, or one that is damaged."""
    try:
        nodes = read_json(path)["nodes"]
        return {(int(i), int(j)): bool(reached) for i, j, reached in nodes}
    except MissingStage:
        return {}
    except (DamagedFile, KeyError, TypeError, ValueError, OSError) as error:
        logger.warning("the reach map %s is damaged and is made again: %s", path.name, error)
        return {}


# --- rectangles ----------------------------------------------------------------------------------------


def _rectangles(reaches: Mapping[str, Callable[[Node], bool]], bounds: np.ndarray, every: bool = False) -> np.ndarray:
    """Maximal rectangles (m, 2, 2) of the cells that some arm, or every arm, reaches, cut to the bounds."""
    first = np.floor(bounds[0] / CELL + 1e-9).astype(int)
    last = np.maximum(np.ceil(bounds[1] / CELL - 1e-9).astype(int), first + 1)
    columns, rows = (range(int(a), int(b) + 1) for a, b in zip(first, last, strict=True))
    cells = np.full((len(columns) - 1, len(rows) - 1), every)
    for ask in reaches.values():
        # A pose out of reach costs the most, so cells that another arm has decided are not asked about again.
        nodes = np.zeros((len(columns), len(rows)), dtype=bool)
        for i, j in np.argwhere(_corners(cells if every else ~cells)):
            nodes[i, j] = ask((columns[i], rows[j]))
        reached = nodes[:-1, :-1] & nodes[1:, :-1] & nodes[:-1, 1:] & nodes[1:, 1:]
        cells = cells & reached if every else cells | reached
    xs, ys = (np.clip(CELL * np.array(axis), *bounds[:, k]) for k, axis in enumerate((columns, rows)))
    return _merge(cells, xs, ys)


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
