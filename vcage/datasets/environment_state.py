"""The state of a scene's objects as one vector, in an order that an environment and a data set share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import UsageError
from vcage.base.geometry import Pose
from vcage.datasets.episode import EpisodeData
from vcage.schema.scene import Scene


@dataclass(frozen=True)
class StateLayout:
    """The order of the numbers of ``environment_state``.

    For each object of the run's scene, in the order of the scene: position in the world (metres), the first two columns
    of its rotation matrix, and the positions of its moving parts (metres or radians). Objects that an episode adds as
    clutter are left out, so that all episodes of a run have the same numbers.

    Args:
        objects: id → number of its moving parts.
    """

    objects: Mapping[str, int]

    @classmethod
    def of(cls, scene: Scene, parts: Mapping[str, int]) -> Self:
        """The layout for a run's scene; ``parts`` has the number of moving parts of the objects with some."""
        return cls({o.id: parts.get(o.id, 0) for o in scene.objects})

    @property
    def names(self) -> list[str]:
        """A name for each number, such as ``plate.x``, ``plate.r21`` (row 2, column 1) and ``cabinet.part1``."""
        pose = [*"xyz", *(f"r{row}{column}" for column in (1, 2) for row in (1, 2, 3))]
        return [
            f"{name}.{what}"
            for name, parts in self.objects.items()
            for what in (*pose, *(f"part{number}" for number in range(1, parts + 1)))
        ]

    def values(self, poses: Mapping[str, Pose], joints: Mapping[str, NDArray[Any]]) -> NDArray[np.float32]:
        """(N,) the numbers for poses and joints of objects."""
        rows = [
            np.concatenate([poses[name].p, poses[name].rotation()[:, :2].T.ravel(), joints.get(name, ())])
            for name in self.objects
        ]
        return np.concatenate(rows).astype(np.float32)

    def of_episode(self, episode: EpisodeData) -> NDArray[np.float32]:
        """(T, N) the numbers of each frame of an episode.

        Raises:
            UsageError: an object is missing there, or has another number of moving parts; names it.
        """
        moving = {name: joints.shape[1] for name, joints in episode.object_joints.items()}
        there = {name: moving.get(name, 0) for name in episode.object_poses}
        for name, parts in self.objects.items():
            if there.get(name) != parts:
                found = "is missing" if name not in there else f"has {there[name]} moving parts"
                raise UsageError(
                    f"{name} {found} in an episode; the run's scene has it with {parts}",
                    hint="collect again after a change of the scene, or export without --environment-state",
                )
        return np.stack([self._row(episode, frame) for frame in range(episode.frames)])

    def _row(self, episode: EpisodeData, frame: int) -> NDArray[np.float32]:
        poses = {name: Pose(rows[frame, :3], rows[frame, 3:]) for name, rows in episode.object_poses.items()}
        return self.values(poses, {name: rows[frame] for name, rows in episode.object_joints.items()})
