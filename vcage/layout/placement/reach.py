"""Where on the table a robot's arms reach and its camera sees, as rectangles that the placement can use.

Inverse kinematics is asked at the nodes of a grid of the world, once for each robot: what is known of a node is kept in
the user's cache and serves every workspace that it lies in.
"""

from __future__ import annotations

import functools
import hashlib
import itertools
import json
import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from vcage.base.errors import DamagedFile, MissingStage, OutputFolderError, PartlyDone
from vcage.base.files import cache_dir, read_json, sha256_file, write_json
from vcage.base.geometry import Camera, Pose
from vcage.layout.validation import as_workspace
from vcage.objects.asset import Asset
from vcage.schema.robot import Arm, Robot
from vcage.schema.scene import Role
from vcage.sim.cameras import overview
from vcage.sim.kinematics import TILTS, kinematics_of, leaning
from vcage.sim.robots import package_file

logger = logging.getLogger(__name__)

CELL = 0.05
"""Grid of the reach map, metres; its nodes are the world's multiples of it."""

GRASP_HEIGHTS = (0.03, 0.22)
"""Heights above the table at which an arm must reach an object that is moved, metres; where no arm does straight down,
the lowest, and as much higher as the hand comes straight to a grasp, tilted."""

YAWS = tuple(np.radians(degrees) for degrees in (0.0, 45.0, 90.0, 135.0))
"""Headings of the gripper that one arm must reach at a point; half a turn on is the same grasp."""

EITHER = ((0, 1), (0, 3), (2, 1), (2, 3))
"""Sets of them, by number, of which one is enough for a hand that may also turn by a quarter."""

HEIGHT_STEP = 0.03
"""Between the heights of maps of tilted hands, metres."""

CROSSWISE = 0.3
"""Cosine between two directions that are about a quarter turn apart."""

VERSION = 2
"""Of what a node's answer means; raised when kinematics or the question change, so that older maps are not used."""

Node = tuple[int, int]
"""A node of the grid, in cells from the world's origin."""


class Reaching(Protocol):
    """Whether a pose of the gripper frame in the world can be reached."""

    def reachable(self, pose: Pose) -> bool: ...


@dataclass(frozen=True)
class Tilted:
    """What a tilted hand must reach where something stands.

    Args:
        headings: sets of numbers of :data:`YAWS`; all headings of one of the sets.
        higher: how much higher than the lowest grasp it lets go of what it brings, metres.
    """

    headings: tuple[tuple[int, ...], ...] = (tuple(range(len(YAWS))),)
    higher: float = 0.0

    @classmethod
    def of(cls, asset: Asset, role: Role, yaw: float | None = None) -> Tilted:
        """What it takes to move something, or to put something into it.

        A hand may choose its heading where it puts something down, and where it takes what it can close on in two
        directions, such as a block.

        Args:
            asset, role: what it is.
            yaw: its heading, where that is known.
        """
        kind = asset.annotation
        if role == "receptacle":
            rims = [asset.opening(point).rim for point in kind.functional_points if point.link is None]
            # Rounded up, so that things of about one height share a map.
            return cls(EITHER, float(np.ceil(max(rims, default=0.0) / HEIGHT_STEP - 1e-9)) * HEIGHT_STEP)
        closings = [np.array(point.closing[:2]) for point in kind.carrying_points]
        if yaw is not None and closings:
            return cls(tuple(sorted({_beside(yaw + float(np.arctan2(y, x))) for x, y in closings})))
        crosswise = any(abs(float(a @ b)) < CROSSWISE for a, b in itertools.combinations(closings, 2))
        return cls(EITHER) if crosswise else cls()


def _beside(heading: float) -> tuple[int, ...]:
    """Numbers of the :data:`YAWS` to both sides of where the fingers close along, or of the one that it is."""
    turns = (heading - np.pi / 2) % np.pi / (np.pi / len(YAWS))  # at heading 0 they close along y
    sides = {int(np.floor(turns + 1e-6)), int(np.ceil(turns - 1e-6))}
    return tuple(sorted(side % len(YAWS) for side in sides))


def robot_reach(
    robot: Robot,
    workspace: ArrayLike,
    heights: Sequence[float],
    folder: Path | None = None,
    every: bool = False,
    tilted: Tilted | None = None,
) -> np.ndarray:
    """Rectangles (m, 2, 2) of the plane in which some arm reaches straight down at all heights and headings.

    Where none does, arms that can reach a grasp with the hand tilted, and lift what it holds clear of the table, do as
    well. A cell of the grid counts when one arm reaches all of its corners, so no point of a rectangle is a guess
    between two that work; and when the robot's overview (:func:`~vcage.sim.cameras.overview`) sees all of them at the
    lowest height. They are cut to the workspace.

    The kinematics are not even built when the whole workspace is known from the cache. A damaged map is made again; one
    that cannot be written is told and does without.

    Args:
        workspace: (2, 2) lower and upper corner, metres.
        heights: z of the gripper frame's origin that must be reached, metres.
        folder: where maps are kept, the user's cache if None.
        every: what all arms reach instead, each by itself.
        tilted: what a tilted hand must reach; a grasp at the lowest height, at all headings, if None.

    Raises:
        UsageError: the workspace has no inside.
    """
    bounds = as_workspace(workspace)
    hand = tilted or Tilted()
    low = min(heights) + hand.higher
    straight = [_ReachMap(arm, _Question(tuple(heights)), folder) for arm in robot.arms.values()]
    leaning = [
        _ReachMap(arm, _Question((low, low + arm.gripper.approach), TILTS, hand.headings), folder)
        for arm in robot.arms.values()
    ]
    columns, rows = (_axis(*bounds[:, k]) for k in range(2))
    seen = _seen(overview(robot), columns, rows, min(heights))
    reached = _cells(straight, columns, rows, seen, every=False)
    cells = _cells(leaning, columns, rows, seen & ~reached, every)
    cells |= _cells(straight, columns, rows, reached, every=True) if every else reached
    for known in (*straight, *leaning):
        known.save()
    xs, ys = (np.clip(CELL * np.array(axis), *bounds[:, k]) for k, axis in enumerate((columns, rows)))
    return _merge(cells, xs, ys)


def reach_for(asset: Asset, role: Role, reach: np.ndarray) -> np.ndarray | None:
    """Where an object may stand at any heading, so that what its role needs of it is reached; None for anywhere.

    Of what is moved those are the contact points, of what receives it the functional points, of a tool those that it
    has. What has moving parts is operated at its handles, which its middle says nothing about.

    Args:
        reach: (m, 2, 2) rectangles where an arm reaches, metres.

    Returns:
        (k, 2, 2) rectangles for its middle; where they would be none, ``reach`` itself, and a warning.
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


# --- what is asked of inverse kinematics ---------------------------------------------------------------


@dataclass(frozen=True)
class _Question:
    """What an arm must reach at a node.

    Args:
        heights: z of the gripper frame, metres.
        tilts: of the hand about its closing axis, radians; one of them must do at all heights.
        headings: as of :class:`Tilted`.
    """

    heights: tuple[float, ...]
    tilts: tuple[float, ...] = (0.0,)
    headings: tuple[tuple[int, ...], ...] = Tilted().headings


def _reaches(arm: Reaching, node: Node, asked: _Question) -> bool:
    """Whether an arm reaches a node at all headings that it must."""
    x, y = CELL * node[0], CELL * node[1]

    @functools.cache
    def lifts(number: int) -> bool:
        return any(_lifts(arm, x, y, asked.heights, YAWS[number], tilt) for tilt in asked.tilts)

    return any(all(map(lifts, some)) for some in asked.headings)


def _lifts(arm: Reaching, x: float, y: float, heights: Sequence[float], yaw: float, tilt: float) -> bool:
    """Whether an arm reaches a point at all heights with one heading and tilt of the hand."""
    for height in heights:
        down = Pose.from_yaw([x, y, height], yaw) * Pose(q=[0, 1, 0, 0])
        if not any(arm.reachable(pose) for pose in leaning(down, (tilt,))):
            return False
    return True


class _ReachMap:
    """What is known of one arm's reach, kept as ``reach/<key>.json``: for each node that was asked, the answer.

    The key is of all that an answer depends on, the arm's record, its URDF, the question and the grid; not of the
    workspace.
    """

    def __init__(self, arm: Arm, asked: _Question, folder: Path | None):
        self._arm, self._asked = arm, asked
        self._path = (folder or cache_dir("reach")) / f"{_key(arm, asked)}.json"
        self._known = _read(self._path)
        self._changed = False

    def reaches(self, node: Node) -> bool:
        if node not in self._known:
            self._known[node] = _reaches(kinematics_of(self._arm), node, self._asked)
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


def _key(arm: Arm, asked: _Question) -> str:
    question = {
        "version": VERSION,
        "arm": arm.model_dump(mode="json", exclude={"urdf", "srdf"}),
        "urdf": sha256_file(package_file(arm.urdf)),
        "heights": [round(float(height), 6) for height in asked.heights],
        "yaws": YAWS,
        "tilts": asked.tilts,
        "headings": asked.headings,
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


def _axis(lower: float, upper: float) -> range:
    """The nodes along one axis that the cells between two bounds lie between."""
    first = int(np.floor(lower / CELL + 1e-9))
    return range(first, max(int(np.ceil(upper / CELL - 1e-9)), first + 1) + 1)


def _seen(camera: Camera | None, columns: range, rows: range, height: float) -> np.ndarray:
    """(nx, ny) bool: the cells of which a camera sees all corners at a height; all where there is none."""
    x, y = np.meshgrid(CELL * np.array(columns), CELL * np.array(rows), indexing="ij")
    points = np.stack([x, y, np.full_like(x, height)], axis=-1)
    return _whole(np.ones(x.shape, dtype=bool) if camera is None else camera.sees(points))


def _whole(nodes: np.ndarray) -> np.ndarray:
    """(nx, ny) bool: the cells all corners (nx + 1, ny + 1) of which are true."""
    return nodes[:-1, :-1] & nodes[1:, :-1] & nodes[:-1, 1:] & nodes[1:, 1:]


def _cells(maps: Sequence[_ReachMap], columns: range, rows: range, among: np.ndarray, every: bool) -> np.ndarray:
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
