"""The observations of a policy in a run: pictures, joints, poses of objects and the instruction, and their spaces."""

from __future__ import annotations

import string
from collections.abc import Iterable, Sequence
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from vcage.datasets.environment_state import StateLayout
from vcage.datasets.episode import state_names
from vcage.evaluation.instruction_space import Instruction
from vcage.schema.robot import Robot
from vcage.sim.world import World

LONGEST_INSTRUCTION = 1000
"""Characters of an instruction in an observation, at most."""


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
        "instruction": Instruction(LONGEST_INSTRUCTION, charset=characters),
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
