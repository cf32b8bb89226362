"""What a policy observes in a run: pictures, joints, poses of objects and the instruction, and their spaces."""

from __future__ import annotations

import string
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from vcage.base.geometry import Pose
from vcage.datasets.episode import state_names
from vcage.schema.robot import Robot
from vcage.schema.scene import Scene
from vcage.sim.world import World

LONGEST_INSTRUCTION = 1000
"""Characters of an instruction in an observation, at most."""


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
    def of(cls, scene: Scene, parts: Mapping[str, int]) -> StateLayout:
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


def names_of_joints(robot: Robot) -> list[str]:
    """A name for each number of ``agent_pos`` and of an action, as in the recordings."""
    return state_names({name: len(arm.home) for name, arm in robot.arms.items()})


def agent_pos(world: World) -> NDArray[np.float32]:
    """(D,) measured joints (rad) and gripper openings (0 closed, 1 open), as :func:`names_of_joints` names them."""
    return np.concatenate([world.arms[name].qpos for name in sorted(world.arms)]).astype(np.float32)


def observation_space(
    robot: Robot, cameras: Sequence[str], state: StateLayout | None, words: Iterable[str]
) -> gymnasium.spaces.Dict:
    """The space of observations.

    Args:
        robot: of the run.
        cameras: whose pictures are observed.
        state: of the objects; None if it is not observed.
        words: sentences of the run, which may hold other characters than ASCII.
    """
    characters = frozenset(string.printable).union(*words)
    unbounded = {"low": -np.inf, "high": np.inf, "dtype": np.float32}
    spaces: dict[str, gymnasium.Space[Any]] = {
        "agent_pos": gymnasium.spaces.Box(shape=(len(names_of_joints(robot)),), **unbounded),
        "instruction": gymnasium.spaces.Text(LONGEST_INSTRUCTION, charset=characters),
    }
    if state is not None:
        spaces["environment_state"] = gymnasium.spaces.Box(shape=(len(state.names),), **unbounded)
    if cameras:
        spaces["pixels"] = gymnasium.spaces.Dict(
            {name: _picture_space(robot.cameras[name].height, robot.cameras[name].width) for name in cameras}
        )
    return gymnasium.spaces.Dict(spaces)


def _picture_space(height: int, width: int) -> gymnasium.spaces.Box:
    return gymnasium.spaces.Box(0, 255, (height, width, 3), np.uint8)
