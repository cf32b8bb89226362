"""Isaac Lab's HDF5, robomimic's tree with other names: https://isaac-sim.github.io/IsaacLab (imitation learning)."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import ClassVar

import h5py

from vcage.datasets.recordings.columns import Columns
from vcage.datasets.recordings.hdf5_numbers import columns
from vcage.datasets.recordings.hdf5_recording import number_at
from vcage.datasets.recordings.robomimic import RobomimicDemo

STATE = ("joint_pos", "gripper_pos")
"""Keys of the state."""

POSE = ("eef_pos", "eef_quat", "gripper_pos")
"""Keys of the state if nobody recorded the joints."""

MARKS = (
    "initial_state/articulation",
    "states/articulation",
    "obs/datagen_info",
    "obs/joint_pos",
    "obs/gripper_pos",
    "obs/eef_quat",
)
"""Keys in a demonstration that Isaac Lab alone writes."""


class IsaacLabDemo(RobomimicDemo):
    """One demonstration of a file of Isaac Lab's, with a label of success."""

    LAYOUT = "isaac-lab"

    LEFT_OUT: ClassVar[Mapping[str, str]] = {
        r"^obs/actions$": "the commands once more",
        r"^(processed_actions|obs/datagen_info)": "notes of the generator of demonstrations",
        r"^obs/(object|cube|rigid)": "where objects are in the simulator",
    }

    @classmethod
    def wrote(cls, data: h5py.Group, demos: Collection[str]) -> bool:
        first = data[next(iter(demos))] if demos else data
        return any(mark in first for mark in MARKS)

    @property
    def _stated_rate(self) -> tuple[float, str] | None:
        step_s, decimation = (number_at(self._env_args, "sim_args", name) for name in ("dt", "decimation"))
        if super()._stated_rate or step_s is None or decimation is None:
            return super()._stated_rate
        return round(1 / (step_s * decimation), 6), "1 / (dt · decimation) of env_args"

    @property
    def rate_hint(self) -> str:
        return "give --fps N: 1 / (sim.dt · decimation) of the task's configuration, which the file does not hold"

    def _measured(self, part: h5py.Group) -> Columns | None:
        obs = part["obs"]
        wanted = STATE if "joint_pos" in obs else POSE
        return columns(obs, [name for name in wanted if name in obs]) or super()._measured(part)
