"""HDF5 files in robomimic's layout, which hold many demonstrations: ``data/demo_0``, ``data/demo_1``, …

Each holds ``actions`` and, in ``obs``, pictures as ``<camera>_image`` beside what was measured of the robot. The
attribute ``env_args`` of ``data`` describes the simulation as JSON. ``next_obs``, where it is, repeats the pictures of
``obs`` one step later.

LIBERO and Isaac Lab write the same tree with other names: :mod:`.libero`, :mod:`.isaac_lab`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Self

import h5py
import numpy as np

from vcage.base.errors import DamagedFile
from vcage.base.reading import parse_json
from vcage.datasets.picture_links import read_link
from vcage.datasets.recordings.columns import Columns, act_grippers
from vcage.datasets.recordings.hdf5_numbers import columns, numbers_of
from vcage.datasets.recordings.hdf5_recording import Hdf5Recording
from vcage.datasets.recordings.leftovers import UNKNOWN

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

    LEFT_OUT: ClassVar[Mapping[str, str]] = {
        r"^obs/object": "where objects are in the simulator",
        r"^obs/datagen_info": "notes of the generator of demonstrations",
        r"joint_pos_(cos|sin)$": "the joints once more",
    }

    def __init__(self, path: Path, demo: str):
        super().__init__(path, int(demo.removeprefix("demo_")))
        self.demo = demo

    def __str__(self) -> str:
        return f"{self.path}:{self.demo}"

    @classmethod
    def found_in(cls, path: Path, file: h5py.File, keys: Collection[str]) -> list[Self]:
        """The demonstrations by their numbers; none where none has pictures."""
        data = file.get(DATA)
        if not isinstance(data, h5py.Group):
            return []
        matches = [match for name in data if (match := re.fullmatch(DEMO, name))]
        demos = [match[0] for match in sorted(matches, key=lambda match: int(match[1]))]
        seen = any(_pictures_in(data.get(f"{demo}/obs")) for demo in demos)
        return [cls(path, demo) for demo in demos] if seen and cls.wrote(data, demos) else []

    @classmethod
    def wrote(cls, data: h5py.Group, demos: Collection[str]) -> bool:
        """Check that the group of these demonstrations is of this layout, of those that share the tree."""
        del data, demos
        return True

    def name(self, root: Path) -> str:
        return f"{super().name(root)}.{self.demo}"

    @property
    def fps(self) -> float | None:
        return self._control_rate or super().fps

    @property
    def notes(self) -> list[str]:
        rate = self._control_rate
        told = [] if rate is None else [f"its frame rate is the control_freq of env_args, {rate:g} Hz"]
        return super().notes + told

    def left_out(self) -> dict[str, str]:
        with self._file() as file:
            beside = [name for name in file if name != DATA]
            beside += [f"{DATA}/{name}" for name in file[DATA] if not re.fullmatch(DEMO, name)]
        groups = "names of groups of demonstrations"
        return super().left_out() | {name: groups if name == "mask" else UNKNOWN for name in sorted(beside)}

    @cached_property
    def _control_rate(self) -> float | None:
        """How often the robot was told something, and a picture taken, Hz; None where nothing says."""
        kwargs = self._env_args.get("env_kwargs")
        rate = kwargs.get("control_freq") if isinstance(kwargs, dict) else None
        return float(rate) if isinstance(rate, (int, float)) and 0 < rate < math.inf else None

    @cached_property
    def _env_args(self) -> dict[str, Any]:
        """Description of the simulation in the file; empty if there is none."""
        return self._described("env_args")

    def _described(self, attribute: str) -> dict[str, Any]:
        """The JSON object in an attribute of the group of all demonstrations; empty where there is none."""
        with self._file() as file:
            try:
                found = parse_json(file[DATA].attrs[attribute], nan=True)
            except (KeyError, TypeError, AttributeError, ValueError):
                return {}
        return found if isinstance(found, dict) else {}

    def _part(self, file: h5py.File) -> h5py.Group:
        return file[f"{DATA}/{self.demo}"]

    def _picture_datasets(self, part: h5py.Group) -> dict[str, h5py.Dataset]:
        found = _pictures_in(part.get("obs"))
        if not found:
            raise DamagedFile(f"{self} holds no pictures in obs", hint="leave the demonstration out")
        short = {name: name.removesuffix(SUFFIX) for name in found}
        return {name if short[name] in found else short[name]: found[name] for name in found}

    def _camera_notes(self) -> list[str]:
        with self._file() as file:
            repeated = bool(_pictures_in(self._part(file).get("next_obs")))
        note = "the pictures of next_obs, which are those of obs one step later, stay as they are"
        return [note] * repeated + super()._camera_notes()

    def _commands(self, part: h5py.Group) -> Columns | None:
        found = numbers_of(part, "actions")
        if found is None:
            return None
        numbers = found.values.shape[1]
        grippers = ", ".join(map(str, act_grippers(numbers)))
        note = f"of the {numbers} numbers of a command none is known to move a gripper"
        if grippers:
            note = f"of the {numbers} numbers of a command, counted from 0, {grippers} is taken for a gripper's"
        return replace(found, names=tuple(f"action_{column}" for column in range(numbers)), notes=(note,))

    def _measured(self, part: h5py.Group) -> Columns | None:
        obs = part["obs"]
        robots = [match for name in obs if (match := re.fullmatch(STATE, name))]
        robots.sort(key=lambda match: (int(match[1]), match[2] != "joint_pos"))
        return columns(obs, [match[0] for match in robots])


def _pictures_in(group: Any) -> dict[str, h5py.Dataset]:
    """Name → pictures, (T, H, W, C) uint8, or the link to them; none where it is no group."""
    items = group.items() if isinstance(group, h5py.Group) else ()
    return {name: item for name, item in items if isinstance(item, h5py.Dataset) and _are_pictures(item)}


def _are_pictures(dataset: h5py.Dataset) -> bool:
    return read_link(dataset) is not None or (dataset.ndim == 4 and dataset.dtype == np.uint8)
