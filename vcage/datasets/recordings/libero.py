"""LIBERO's HDF5, robomimic's tree with other names: https://libero-project.github.io/datasets."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, ClassVar

import h5py

from vcage.datasets.lerobot.episode import SubtaskSpan
from vcage.datasets.recordings.columns import Columns
from vcage.datasets.recordings.hdf5_numbers import columns
from vcage.datasets.recordings.robomimic import DATA, RobomimicDemo

STATE = ("joint_states", "gripper_states", "ee_states")
"""The joints (7), the two fingers, and the end effector as position and axis-angle (6)."""

SPLIT_POSE = ("ee_pos", "ee_ori")
"""The end effector once more, in two parts."""

MARKS = ("problem_info", "bddl_file_name", "macros_image_convention")
"""Attributes of the group of demonstrations that LIBERO alone writes."""


class LiberoDemo(RobomimicDemo):
    """One demonstration of a file of LIBERO's."""

    LAYOUT = "libero"

    LEFT_OUT: ClassVar[Mapping[str, str]] = {
        r"^obs/ee_(pos|ori)$": "the same numbers as ee_states",
        r"^robot_states$": "gripper and end effector once more, as quaternion",
    }

    @classmethod
    def wrote(cls, data: h5py.Group, demos: Collection[str]) -> bool:
        named = any(f"{demo}/obs/{name}" in data for demo in demos for name in STATE)
        return named or any(mark in data.attrs for mark in MARKS)

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
        split = () if "ee_states" in obs else SPLIT_POSE
        return columns(obs, [name for name in (*STATE, *split) if name in obs]) or super()._measured(part)


def instructions_of(stated: Any) -> list[str]:
    """Return the instructions in a text, in a list of them, or in a list of the words of one; none in other values."""
    texts = [stated] if isinstance(stated, str) else stated if isinstance(stated, list) else []
    tidy = [" ".join(text.split()).strip('"') for text in texts if isinstance(text, str)]
    tidy = [text for text in tidy if text]
    if len(tidy) > 1 and not any(" " in text for text in tidy):
        return [" ".join(tidy)]
    return list(dict.fromkeys(tidy))
