"""HDF5 files in robomimic's layout, which hold many demonstrations: ``data/demo_0``, ``data/demo_1``, …

Each holds ``actions`` and, in ``obs``, pictures as ``<camera>_image`` beside what was measured of the robot. The
attribute ``env_args`` of ``data`` describes the simulation as JSON. ``next_obs``, where it is, repeats the pictures of
``obs`` one step later.
"""

from __future__ import annotations

import json
import math
import re
from functools import cached_property
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from vcage.base.errors import DamagedFile
from vcage.datasets.picture_links import read_link
from vcage.datasets.recordings.hdf5_columns import columns, table
from vcage.datasets.recordings.hdf5_layouts import Hdf5Recording, damage
from vcage.datasets.recordings.recording import Columns, act_grippers

DATA = "data"
DEMO = r"demo_(\d+)"
SUFFIX = "_image"
"""Ends the names of pictures; a camera's name goes without it."""

STATE = r"robot(\d+)_(joint_pos|gripper_qpos)"
"""What is taken for the state: joints of every robot in radians, then those of its gripper."""


class RobomimicDemo(Hdf5Recording):
    """One demonstration of a file.

    Commands of 7 numbers an arm are taken for robosuite's OSC_POSE: six of a pose, then the gripper, which is all that
    is known of grippers.

    Attributes:
        demo: its name, as in ``demo_0``.
    """

    LAYOUT = "robomimic"

    def __init__(self, path: Path, demo: str):
        super().__init__(path)
        self.demo = demo

    def __str__(self) -> str:
        return f"{self.path}:{self.demo}"

    @property
    def fps(self) -> float | None:
        return self._control_rate or super().fps

    @cached_property
    def _control_rate(self) -> float | None:
        with self._file() as file:
            rate = _control_rate(file[DATA])
        if rate is not None:
            self.notes.append(f"its frame rate is the control_freq of env_args, {rate:g} Hz")
        return rate

    def _part(self, file: h5py.File) -> h5py.Group:
        return file[f"{DATA}/{self.demo}"]

    def _picture_datasets(self, part: h5py.Group) -> dict[str, h5py.Dataset]:
        found = _pictures_in(part.get("obs"))
        if not found:
            raise DamagedFile(f"{self} holds no pictures in obs", hint="leave the demonstration out")
        if _pictures_in(part.get("next_obs")):
            self.notes.append("the pictures of next_obs, which are those of obs one step later, stay as they are")
        short = {name: name.removesuffix(SUFFIX) for name in found}
        return {name if short[name] in found else short[name]: found[name] for name in found}

    def _commands(self, part: h5py.Group) -> Columns | None:
        found = table(part, "actions")
        if found is None:
            return None
        numbers = found.values.shape[1]
        grippers = ", ".join(map(str, act_grippers(numbers)))
        note = f"of the {numbers} numbers of a command none is known to move a gripper"
        if grippers:
            note = f"of the {numbers} numbers of a command, counted from 0, {grippers} is taken for a gripper's"
        self.notes += [note] if note not in self.notes else []
        return Columns(found.values, tuple(f"action_{column}" for column in range(numbers)))

    def _measured(self, part: h5py.Group) -> Columns | None:
        obs = part["obs"]
        robots = [match for name in obs if (match := re.fullmatch(STATE, name))]
        robots.sort(key=lambda match: (int(match[1]), match[2] != "joint_pos"))
        return columns(obs, [match[0] for match in robots])


def open_robomimic(path: Path) -> list[RobomimicDemo]:
    """The demonstrations of an HDF5 file by their numbers; none where it has another layout, or none has pictures.

    Raises:
        DamagedFile: it is no HDF5, or is cut off.
    """
    with damage(path), h5py.File(path) as file:
        data = file.get(DATA)
        if not isinstance(data, h5py.Group):
            return []
        matches = [match for name in data if (match := re.fullmatch(DEMO, name))]
        demos = [match[0] for match in sorted(matches, key=lambda match: int(match[1]))]
        if not any(_pictures_in(data.get(f"{demo}/obs")) for demo in demos):
            return []
    return [RobomimicDemo(path, demo) for demo in demos]


def _pictures_in(group: Any) -> dict[str, h5py.Dataset]:
    """Name → pictures, (T, H, W, C) uint8, or the link to them; none where it is no group."""
    items = group.items() if isinstance(group, h5py.Group) else ()
    return {name: item for name, item in items if isinstance(item, h5py.Dataset) and _are_pictures(item)}


def _are_pictures(dataset: h5py.Dataset) -> bool:
    return read_link(dataset) is not None or (dataset.ndim == 4 and dataset.dtype == np.uint8)


def _control_rate(data: h5py.Group) -> float | None:
    """How often the robot was told something, and a picture taken, Hz; None where nothing says."""
    try:
        rate = json.loads(data.attrs["env_args"])["env_kwargs"]["control_freq"]
    except (KeyError, TypeError, ValueError):
        return None
    return float(rate) if isinstance(rate, (int, float)) and 0 < rate < math.inf else None
