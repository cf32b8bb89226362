"""Reach maps: inverse kinematics asked at the nodes of a grid of the world, and the answers in the user's cache.

What is known of a node serves every workspace that it lies in. Where no arm reaches straight down, a tilted hand must
reach some headings and heights.
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

from vcage.base.errors import DamagedFile, MissingStage, OutputFolderError, PartlyDone
from vcage.base.files import cache_dir, read_json, sha256_file, write_json
from vcage.base.geometry import Pose
from vcage.objects.asset import Asset
from vcage.schema.robot import Arm
from vcage.schema.scene import Role
from vcage.sim.kinematics import kinematics_of, leaning
from vcage.sim.robots import package_file

logger = logging.getLogger(__name__)

YAWS = tuple(np.radians(degrees) for degrees in (0.0, 45.0, 90.0, 135.0))
"""Headings of the gripper that one arm must reach at a point; half a turn on is the same grasp."""

EITHER = ((0, 1), (0, 3), (2, 1), (2, 3))
"""Sets of them, by number, of which one is enough for a hand that may also turn by a quarter."""


@dataclass(frozen=True)
class ReachSettings:
    """Settings of the reach maps.

    Args:
        cell_m: of the grid; its nodes are the world's multiples of it.
        grasp_heights_m: above the table, at which an arm must reach an object that is moved; where no arm does straight
            down, the lowest, and as much higher as the hand comes straight to a grasp, tilted.
        height_step_m: between the heights of the maps of tilted hands.
        crosswise_cos: largest cosine between two directions that are about a quarter turn apart.
    """

    cell_m: float = 0.05
    grasp_heights_m: tuple[float, float] = (0.03, 0.22)
    height_step_m: float = 0.03
    crosswise_cos: float = 0.3


SETTINGS = ReachSettings()


@dataclass(frozen=True)
class Tilted:
    """Demands on a tilted hand where an object stands.

    Args:
        headings: sets of numbers of :data:`YAWS`; all headings of one of the sets.
        higher: height above the lowest grasp at which it lets go of its object, metres.
    """

    headings: tuple[tuple[int, ...], ...] = (tuple(range(len(YAWS))),)
    higher: float = 0.0

    @classmethod
    def of(cls, asset: Asset, role: Role, yaw: float | None = None) -> Tilted:
        """Return the demands of moving an object, or of putting something into it.

        A hand may choose its heading where it puts an object down, and where it takes an object with two closing
        directions, such as a block.

        Args:
            asset, role: of the object.
            yaw: its heading, where that is known.
        """
        kind = asset.annotation
        if role == "receptacle":
            rims = [asset.opening(point).rim for point in kind.functional_points if point.link is None]
            # Rounded up, so that things of about one height share a map.
            steps = float(np.ceil(max(rims, default=0.0) / SETTINGS.height_step_m - 1e-9))
            return cls(EITHER, steps * SETTINGS.height_step_m)
        closings = [np.array(point.closing[:2]) for point in kind.carrying_points]
        if yaw is not None and closings:
            return cls(tuple(sorted({_beside(yaw + float(np.arctan2(y, x))) for x, y in closings})))
        crosswise = any(abs(float(a @ b)) < SETTINGS.crosswise_cos for a, b in itertools.combinations(closings, 2))
        return cls(EITHER) if crosswise else cls()


def _beside(heading: float) -> tuple[int, ...]:
    """Numbers of the :data:`YAWS` on both sides of the fingers' closing direction, or the exact one."""
    turns = (heading - np.pi / 2) % np.pi / (np.pi / len(YAWS))  # at heading 0 they close along y
    sides = {int(np.floor(turns + 1e-6)), int(np.ceil(turns - 1e-6))}
    return tuple(sorted(side % len(YAWS) for side in sides))


VERSION = 2
"""Of what a node's answer means; raised when kinematics or the question change, so that older maps are not used."""

Node = tuple[int, int]
"""A node of the grid, in cells from the world's origin."""


class Reaching(Protocol):
    """An arm that knows if it reaches a pose of the gripper frame in the world."""

    def reachable(self, pose: Pose) -> bool: ...


@dataclass(frozen=True)
class Question:
    """Poses that an arm must reach at a node.

    Args:
        heights: z of the gripper frame, metres.
        tilts: of the hand about its closing axis, radians; one of them must do at all heights.
        headings: as of :class:`Tilted`.
    """

    heights: tuple[float, ...]
    tilts: tuple[float, ...] = (0.0,)
    headings: tuple[tuple[int, ...], ...] = Tilted().headings


def _reaches(arm: Reaching, node: Node, asked: Question) -> bool:
    """True if an arm reaches a node at all headings of one set."""
    x, y = SETTINGS.cell_m * node[0], SETTINGS.cell_m * node[1]

    @functools.cache
    def lifts(number: int) -> bool:
        return any(_lifts(arm, x, y, asked.heights, YAWS[number], tilt) for tilt in asked.tilts)

    return any(all(map(lifts, some)) for some in asked.headings)


def _lifts(arm: Reaching, x: float, y: float, heights: Sequence[float], yaw: float, tilt: float) -> bool:
    """True if an arm reaches a point at all heights with one heading and tilt of the hand."""
    for height in heights:
        down = Pose.from_yaw([x, y, height], yaw) * Pose(q=[0, 1, 0, 0])
        if not any(arm.reachable(pose) for pose in leaning(down, (tilt,))):
            return False
    return True


class ReachMap:
    """Known answers about one arm's reach by node, cached as ``reach/<key>.json``.

    The key is of all that an answer depends on, the arm's record, its URDF, the question and the grid; not of the
    workspace.
    """

    def __init__(self, arm: Arm, asked: Question, folder: Path | None):
        self._arm, self._asked = arm, asked
        self._path = (folder or cache_dir("reach")) / f"{_key(arm, asked)}.json"
        self._known = _read(self._path)
        self._changed = False

    def reaches(self, node: Node) -> bool:
        """True if the arm reaches a node."""
        if node not in self._known:
            self._known[node] = _reaches(kinematics_of(self._arm), node, self._asked)
            self._changed = True
        return self._known[node]

    def save(self) -> None:
        """Write new answers to the cache; a map that cannot be written is reported and skipped."""
        if not self._changed:
            return
        nodes = [[*node, int(reached)] for node, reached in sorted(self._known.items())]
        try:
            write_json(self._path, {"cell_m": SETTINGS.cell_m, "nodes": nodes})
        except (OutputFolderError, PartlyDone) as error:
            logger.warning("the reach map is not kept: %s", error.message)


def _key(arm: Arm, asked: Question) -> str:
    question = {
        "version": VERSION,
        "arm": arm.model_dump(mode="json", exclude={"urdf", "srdf"}),
        "urdf": sha256_file(package_file(arm.urdf)),
        "heights": [round(float(height), 6) for height in asked.heights],
        "yaws": YAWS,
        "tilts": asked.tilts,
        "headings": asked.headings,
        "cell": SETTINGS.cell_m,
    }
    return hashlib.sha256(json.dumps(question, sort_keys=True).encode()).hexdigest()[:32]


def _read(path: Path) -> dict[Node, bool]:
    """The nodes of a map; empty for a missing or damaged one."""
    try:
        nodes = read_json(path)["nodes"]
        return {(int(i), int(j)): bool(reached) for i, j, reached in nodes}
    except MissingStage:
        return {}
    except (DamagedFile, KeyError, TypeError, ValueError, OSError) as error:
        logger.warning("the reach map %s is damaged and is made again: %s", path.name, error)
        return {}
