"""ManiSkill's trajectories: groups ``traj_0``, ``traj_1``, … of an HDF5 file, described by a JSON file of its name.

Each holds T ``actions`` and T + 1 observations, the last of which follows the last action:
``obs/sensor_data/<camera>/rgb`` and ``obs/agent/qpos``. See
https://maniskill.readthedocs.io/en/latest/user_guide/datasets/demos.html.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Self

import h5py

from vcage.base.errors import DamagedFile
from vcage.datasets.recordings.columns import Columns, numbers_of
from vcage.datasets.recordings.hdf5_recording import Hdf5Recording, number_at, read_beside
from vcage.datasets.recordings.success import FAIL, SUCCESS, label_of, stated_failure, stored_label

TRAJECTORY = r"traj_(\d+)"

FIX_FILE = "fix the file, or remove it and give with options what it says"

STATE, FLAT = "obs/agent/qpos", "obs/state"
"""The robot's joints; or all numbers of the simulation in one row."""


class ManiSkillTrajectory(Hdf5Recording):
    """One trajectory of a file.

    Args:
        path: of the file.
        part: its name, as in ``traj_0``.
        labelled: true if the file's ``success`` is recorded: some trajectory of it ends with true.
    """

    LAYOUT = "maniskill"
    PICTURES = r"obs/(?:sensor_data|image)/([^/]+)/rgb"
    COMMANDS = "actions"
    SPARE_PICTURES = 1
    COLOURS_SURE = False

    LEFT_OUT: ClassVar[Mapping[str, str]] = {
        r"^obs/extra": "the task's own observations, such as poses of goals",
        r"^obs/state$": "all numbers of the simulation in one row",
    }

    def __init__(self, path: Path, part: str, labelled: bool = True):
        super().__init__(path, part)
        self._labelled = labelled

    @classmethod
    def found_in(cls, path: Path, file: h5py.File, keys: Collection[str]) -> list[Self]:
        """Return the trajectories by their numbers.

        Raises:
            DamagedFile: there are some, but without pictures.
        """
        names = sorted((name for name in file if re.fullmatch(TRAJECTORY, name)), key=lambda name: int(name[5:]))
        if names and not any(re.fullmatch(f"{TRAJECTORY}/{cls.PICTURES}", key) for key in keys):
            raise DamagedFile(
                f"{path} holds ManiSkill's trajectories without pictures",
                hint="let ManiSkill draw them: python -m mani_skill.trajectory.replay_trajectory "
                f"--traj-path {path} --save-traj --obs-mode rgb --use-env-states",
            )
        labelled = any(_succeeds(file[name]) for name in names)
        return [cls(path, name, labelled) for name in names]

    @property
    def _stated_rate(self) -> tuple[float, str] | None:
        places = (("env_kwargs", "sim_config"), ("env_kwargs",), ())
        rates = (number_at(self._environment, *place, "control_freq") for place in places)
        rate = next((rate for rate in rates if rate is not None), None)
        return None if rate is None else (rate, "the control_freq of its environment")

    @property
    def rate_hint(self) -> str:
        return "give --fps N: the control_freq of its environment, 20 unless it was changed"

    @property
    def task_guess(self) -> str | None:
        found = self._environment.get("env_id")
        return words_of(found) or None if isinstance(found, str) else None

    @property
    def companions(self) -> list[Path]:
        file = self._description_file
        return [file] if file.is_file() and not file.is_symlink() else []

    @property
    def failed(self) -> str | None:
        stated = self._described(SUCCESS)
        if stated is False or self._described(FAIL):
            return f"{'success is false' if stated is False else 'fail is true'} in {self._description_file.name}"
        with self._file() as file:
            return stated_failure(self._part(file), labelled=stated is None and self._labelled)

    @property
    def notes(self) -> list[str]:
        return [*super().notes, *self._label_notes(), *self._length_notes()]

    def _label_notes(self) -> Iterator[str]:
        file = self._description_file.name
        undescribed = bool(self.companions) and not self._episode
        if not self._labelled and self._episode.get(SUCCESS) in (None, []) and not undescribed:
            yield "no trajectory of its file ends with success, so nobody seems to have recorded that"
        if not self.companions:
            yield f"there is no {file}, which would describe it"
        if undescribed:
            what = "names no episodes" if "episodes" not in self._description else "does not describe it"
            yield f"{file} {what}, so it does not say whether it succeeded"

    def _length_notes(self) -> Iterator[str]:
        steps, motion = self._episode.get("elapsed_steps"), self.motion
        if isinstance(steps, int) and motion is not None and steps != len(motion.values):
            yield f"it has {len(motion.values)} actions, its elapsed_steps are {steps}"

    def left_out(self) -> dict[str, str]:
        last = {"the last picture": "it follows the last action, so that no action belongs to it"}
        return super().left_out() | last

    @cached_property
    def _description_file(self) -> Path:
        return self.path.with_suffix(".json")

    @cached_property
    def _environment(self) -> dict[str, Any]:
        """``env_info`` of the file's description; empty where nothing says."""
        found = self._description.get("env_info")
        return found if isinstance(found, dict) else {}

    @cached_property
    def _episode(self) -> dict[str, Any]:
        """Row of the description for this trajectory; empty where it has none.

        Raises:
            DamagedFile: the description is not understood.
        """
        rows = self._description.get("episodes", [])
        if not isinstance(rows, list):
            raise self._not_understood("episodes", rows, "a list")
        found: dict[str, Any] = {}
        for number, row in enumerate(rows):
            if not isinstance(row, dict):
                raise self._not_understood(f"episodes[{number}]", row, "an object")
            if self._episode_id(number, row.get("episode_id")) != self.number:
                continue
            if found:
                raise DamagedFile(f"{self._description_file} describes episode {self.number} twice", hint=FIX_FILE)
            found = row
        return found

    @cached_property
    def _description(self) -> dict[str, Any]:
        """Description of the file; empty where there is none."""
        found = read_beside(self._description_file)
        if found is not None and not isinstance(found, dict):
            raise self._not_understood("its content", found, "an object with env_info and episodes")
        return found or {}

    def _episode_id(self, row: int, stated: Any) -> int:
        """Return the number of the trajectory that a row of the description belongs to."""
        if type(stated) is int:
            return stated
        digits = re.fullmatch(r"\s*(?:traj_)?(\d+)(?:\.0)?\s*", str(stated))
        if digits is None:
            raise self._not_understood(f"episodes[{row}].episode_id", stated, "a number")
        return int(digits[1])

    def _described(self, name: str) -> bool | None:
        """Return a label of the description's row of this trajectory."""
        where = f"{self._description_file}: {name} of episode {self.number}"
        return label_of(self._episode.get(name), where, name)

    def _not_understood(self, field: str, found: Any, wanted: str) -> DamagedFile:
        return DamagedFile(f"{self._description_file}: {field} is {type(found).__name__}, not {wanted}", hint=FIX_FILE)

    def _commands(self, part: h5py.Group) -> Columns | None:
        found = super()._commands(part)
        return None if found is None else replace(found, names=found.numbered("action"))

    def _measured(self, part: h5py.Group) -> Columns | None:
        flat = STATE not in part
        found = numbers_of(part, FLAT if flat else STATE)
        if found is None:
            return None
        notes = ("its state is obs/state, all numbers of the simulation in one row",) * flat
        names = found.numbered("state" if flat else "qpos")
        return replace(found, values=found.values[:-1], names=names, notes=notes)


def words_of(environment: str) -> str:
    """Return the name of an environment as words: ``PickCube-v1`` is "Pick cube"."""
    plain = re.sub(r"-v\d+$", "", environment)
    parts = re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+", plain)
    return " ".join(parts).capitalize()


def _succeeds(part: h5py.Group) -> bool:
    """True for a label of success, and for one not understood, which is named where the trajectory is read."""
    with suppress(DamagedFile):
        return bool(stored_label(part, SUCCESS))
    return True
