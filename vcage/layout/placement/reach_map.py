"""Reach maps: inverse kinematics asked at the nodes of a grid of the world, and the answers in the user's cache.

What is known of a node serves every workspace that it lies in.
"""

from __future__ import annotations

import functools
import hashlib
import json
import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from vcage.base.errors import DamagedFile, MissingStage, OutputFolderError, PartlyDone
from vcage.base.files import cache_dir, read_json, sha256_file, write_json
from vcage.base.geometry import Pose
from vcage.layout.placement.tilted import YAWS, Tilted
from vcage.schema.robot import Arm
from vcage.sim.kinematics import kinematics_of, leaning
from vcage.sim.robots import package_file

logger = logging.getLogger(__name__)

VERSION = 2
"""Of what a node's answer means; raised when kinematics or the question change, so that older maps are not used."""

Node = tuple[int, int]
"""A node of the grid, in cells from the world's origin."""


@dataclass(frozen=True)
class ReachSettings:
    """Settings of the reach maps.

    Args:
        cell_m: of the grid; its nodes are the world's multiples of it.
        grasp_heights_m: above the table, at which an arm must reach an object that is moved; where no arm does straight
            down, the lowest, and as much higher as the hand comes straight to a grasp, tilted.
    """

    cell_m: float = 0.05
    grasp_heights_m: tuple[float, float] = (0.03, 0.22)


SETTINGS = ReachSettings()


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
        """Write new answers to the cache; a map that cannot be written is reported and does without."""
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
    """The nodes of a map; none when there is no map, or one that is damaged."""
    try:
        nodes = read_json(path)["nodes"]
        return {(int(i), int(j)): bool(reached) for i, j, reached in nodes}
    except MissingStage:
        return {}
    except (DamagedFile, KeyError, TypeError, ValueError, OSError) as error:
        logger.warning("the reach map %s is damaged and is made again: %s", path.name, error)
        return {}
