"""HDF5 files in robomimic's layout, which hold many demonstrations: ``data/demo_0``, ``data/demo_1``, …

Each holds ``actions`` and, in ``obs``, pictures as ``<camera>_image`` beside measurements of the robot. The
attribute ``env_args`` of ``data`` describes the simulation as JSON. ``next_obs``, where it is, repeats the pictures of
``obs`` one step later.

LIBERO (https://libero-project.github.io/datasets) and Isaac Lab (https://isaac-sim.github.io/IsaacLab) write the same
tree with other names.
"""

from __future__ import annotations

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
from vcage.datasets.lerobot.episode import SubtaskSpan
from vcage.datasets.picture_links import read_link
from vcage.datasets.recordings.columns import Columns, act_grippers, columns
from vcage.datasets.recordings.hdf5_recording import Hdf5Recording, number_at
from vcage.datasets.recordings.passed_over import UNKNOWN

DATA = "data"
DEMO = r"demo_(\d+)"
SUFFIX = "_image"
"""Ends the names of pictures; a camera's name goes without it."""

JOINTS = r"robot(\d+)_(joint_pos|gripper_qpos)"
"""Keys of the state: joints of every robot in radians, then those of its gripper."""


class RobomimicDemo(Hdf5Recording):
    """One demonstration of a file.

    Commands of 7 numbers an arm are taken for robosuite's OSC_POSE: six of a pose, then the gripper. Nothing else says
    which numbers are a gripper's.
    """

    LAYOUT = "robomimic"
    PARTS = f"{DATA}/"
    COMMANDS = "actions"

    LEFT_OUT: ClassVar[Mapping[str, str]] = {
        r"^obs/object": "where objects are in the simulator",
        r"^obs/datagen_info": "notes of the generator of demonstrations",
        r"joint_pos_(cos|sin)$": "the joints once more",
    }

    @classmethod
    def found_in(cls, path: Path, file: h5py.File, keys: Collection[str]) -> list[Self]:
        """Return the demonstrations by their numbers; none where none has pictures."""
        data = file.get(DATA)
        if not isinstance(data, h5py.Group):
            return []
        demos = sorted((name for name in data if re.fullmatch(DEMO, name)), key=lambda name: int(name[len("demo_") :]))
        seen = any(_pictures_in(data.get(f"{demo}/obs")) for demo in demos)
        return [cls(path, demo) for demo in demos] if seen and cls.wrote(data, demos) else []

    @classmethod
    def wrote(cls, data: h5py.Group, demos: Collection[str]) -> bool:
        """True if the group of these demonstrations is of this layout, among those that share the tree."""
        del data, demos
        return True

    @property
    def _stated_rate(self) -> tuple[float, str] | None:
        rate = number_at(self._env_args, "env_kwargs", "control_freq")
        return None if rate is None else (rate, "the control_freq of env_args")

    def left_out(self) -> dict[str, str]:
        with self._file() as file:
            beside = [name for name in file if name != DATA]
            beside += [f"{DATA}/{name}" for name in file[DATA] if not re.fullmatch(DEMO, name)]
        groups = "names of groups of demonstrations"
        return super().left_out() | {name: groups if name == "mask" else UNKNOWN for name in sorted(beside)}

    @cached_property
    def _env_args(self) -> dict[str, Any]:
        """Description of the simulation in the file; empty if there is none."""
        return self._described("env_args")

    def _described(self, attribute: str) -> dict[str, Any]:
        """Return the JSON object in an attribute of the group of all demonstrations; empty where there is none."""
        with self._file() as file:
            try:
                found = parse_json(file[DATA].attrs[attribute], nan=True)
            except (KeyError, TypeError, AttributeError, ValueError):
                return {}
        return found if isinstance(found, dict) else {}

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
        found = super()._commands(part)
        if found is None:
            return None
        numbers = found.values.shape[1]
        grippers = ", ".join(map(str, act_grippers(numbers)))
        note = f"of the {numbers} numbers of a command none is known to move a gripper"
        if grippers:
            note = f"of the {numbers} numbers of a command, counted from 0, {grippers} is taken for a gripper's"
        return replace(found, names=found.numbered("action"), notes=(note,))

    def _measured(self, part: h5py.Group) -> Columns | None:
        obs = part["obs"]
        robots = [match for name in obs if (match := re.fullmatch(JOINTS, name))]
        robots.sort(key=lambda match: (int(match[1]), match[2] != "joint_pos"))
        return columns(obs, [match[0] for match in robots])


def _pictures_in(group: Any) -> dict[str, h5py.Dataset]:
    """Return name → pictures, (T, H, W, C) uint8, or the link to them; empty where it is no group."""
    items = group.items() if isinstance(group, h5py.Group) else ()
    datasets = {name: item for name, item in items if isinstance(item, h5py.Dataset)}
    arrays = {name for name, one in datasets.items() if one.ndim == 4 and one.dtype == np.uint8}
    return {name: one for name, one in datasets.items() if name in arrays or read_link(one) is not None}


class IsaacLabDemo(RobomimicDemo):
    """One demonstration of a file of Isaac Lab's, with a label of success."""

    LAYOUT = "isaac-lab"

    STATE: ClassVar[tuple[str, ...]] = ("joint_pos", "gripper_pos")
    """Keys of the state."""

    POSE: ClassVar[tuple[str, ...]] = ("eef_pos", "eef_quat", "gripper_pos")
    """Keys of the state if nobody recorded the joints."""

    MARKS: ClassVar[tuple[str, ...]] = (
        *("initial_state/articulation", "states/articulation", "obs/datagen_info"),
        *("obs/joint_pos", "obs/gripper_pos", "obs/eef_quat"),
    )
    """Keys in a demonstration that Isaac Lab alone writes."""

    LEFT_OUT: ClassVar[Mapping[str, str]] = {
        r"^obs/actions$": "the commands once more",
        r"^(processed_actions|obs/datagen_info)": "notes of the generator of demonstrations",
        r"^obs/(object|cube|rigid)": "where objects are in the simulator",
    }

    @classmethod
    def wrote(cls, data: h5py.Group, demos: Collection[str]) -> bool:
        first = data[next(iter(demos))] if demos else data
        return any(mark in first for mark in cls.MARKS)

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
        wanted = self.STATE if "joint_pos" in obs else self.POSE
        return columns(obs, [name for name in wanted if name in obs]) or super()._measured(part)


class LiberoDemo(RobomimicDemo):
    """One demonstration of a file of LIBERO's."""

    LAYOUT = "libero"

    STATE: ClassVar[tuple[str, ...]] = ("joint_states", "gripper_states", "ee_states")
    """The joints (7), the two fingers, and the end effector as position and axis-angle (6)."""

    SPLIT_POSE: ClassVar[tuple[str, ...]] = ("ee_pos", "ee_ori")
    """The end effector once more, in two parts."""

    MARKS: ClassVar[tuple[str, ...]] = ("problem_info", "bddl_file_name", "macros_image_convention")
    """Attributes of the group of demonstrations that LIBERO alone writes."""

    LEFT_OUT: ClassVar[Mapping[str, str]] = {
        r"^obs/ee_(pos|ori)$": "the same numbers as ee_states",
        r"^robot_states$": "gripper and end effector once more, as quaternion",
    }

    @classmethod
    def wrote(cls, data: h5py.Group, demos: Collection[str]) -> bool:
        named = any(f"{demo}/obs/{name}" in data for demo in demos for name in cls.STATE)
        return named or any(mark in data.attrs for mark in cls.MARKS)

    @property
    def task(self) -> str | None:
        texts = self._instructions
        return texts[0] if texts else super().task

    @property
    def subtasks(self) -> list[SubtaskSpan]:
        texts = self._instructions
        return [SubtaskSpan(texts[0], 0, self.frames, texts)] if len(texts) > 1 else []

    @property
    def rate_hint(self) -> str:
        return "give --fps N; LIBERO's own demonstrations have 20"

    @property
    def notes(self) -> list[str]:
        with self._file() as file:
            upside_down = file[DATA].attrs.get("macros_image_convention") == "opengl"
        note = (
            "its pictures are stored upside down (macros_image_convention is opengl) and stay so; turn them when they"
        )
        return super().notes + [f"{note} are read"] * upside_down

    @property
    def _instructions(self) -> list[str]:
        return instructions_of(self._described("problem_info").get("language_instruction"))

    def _measured(self, part: h5py.Group) -> Columns | None:
        obs = part["obs"]
        split = () if "ee_states" in obs else self.SPLIT_POSE
        return columns(obs, [name for name in (*self.STATE, *split) if name in obs]) or super()._measured(part)


def instructions_of(stated: Any) -> list[str]:
    """Return the instructions in a text, in a list of them, or in a list of the words of one; none in other values."""
    texts = [stated] if isinstance(stated, str) else stated if isinstance(stated, list) else []
    tidy = [" ".join(text.split()).strip('"') for text in texts if isinstance(text, str)]
    tidy = [text for text in tidy if text]
    if len(tidy) > 1 and not any(" " in text for text in tidy):
        return [" ".join(tidy)]
    return list(dict.fromkeys(tidy))
