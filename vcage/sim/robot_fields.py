"""Fields of a RoboTwin embodiment's ``config.yml``, with complaints that name them and defaults that are warnings."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from vcage.base.errors import DamagedFile, InputFileError, SchemaMismatch

DEFAULTS: dict[str, Any] = {
    "gripper_bias": 0.12,
    "robot_pose": [[0.0, -0.65, 0.74, 0.70710678, 0.0, 0.0, 0.70710678]],
    "delta_matrix": np.eye(3).tolist(),
    "global_trans_matrix": np.eye(3).tolist(),
    "joint_stiffness": 1000.0,
    "joint_damping": 200.0,
}
"""What is assumed for fields that are left out: metres, and wxyz quaternions."""


def wrong(path: Path, name: str, message: str) -> SchemaMismatch:
    """The error for a field that the robot cannot be made with."""
    return SchemaMismatch(
        f"{path}: field {name}: {message}", hint="mend the field", details={"path": str(path), "field": name}
    )


def numbers(path: Path, name: str, value: Any, count: int) -> np.ndarray:
    """(count,) the finite numbers in a list.

    Raises:
        SchemaMismatch: it is something else.
    """
    if not isinstance(value, list) or len(value) != count or not all(is_number(x) for x in value):
        raise wrong(path, name, f"got {value!r}; expected {count} numbers")
    return np.array(value, dtype=np.float64)


def read_fields(path: Path) -> Fields:
    """Read a config.

    Raises:
        InputFileError: there is no such file.
        DamagedFile: it is not YAML, or holds no fields.
    """
    import yaml

    if not path.is_file():
        raise InputFileError(
            f"{path}: missing; expected the config of a RoboTwin embodiment",
            hint="give a folder like assets/embodiments/franka-panda",
            details={"path": str(path)},
        )
    try:
        data = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise DamagedFile(f"{path} is not valid YAML: {error}", hint="mend the file") from error
    if not isinstance(data, dict):
        raise DamagedFile(f"{path}: expected fields, got {type(data).__name__}", hint="mend the file")
    return Fields(path, data)


class Fields:
    """The fields of a config; every method names the field that it complains of.

    Args:
        path: of the file.
        data: what was read from it.
    """

    def __init__(self, path: Path, data: dict[str, Any]):
        self.path, self.data = path, data
        self.warnings: list[str] = []

    def get(self, name: str) -> Any:
        """The value of a field, or its default with a warning."""
        if self.data.get(name) is not None:
            return self.data[name]
        if name not in DEFAULTS:
            raise wrong(self.path, name, "missing; expected a value")
        note = f"{self.path}: field {name}: missing; {DEFAULTS[name]} is assumed"
        if note not in self.warnings:
            self.warnings.append(note)
        return DEFAULTS[name]

    def side(self, name: str, index: int, single: Callable[[Any], bool]) -> tuple[Any, str]:
        """The entry for an arm and what to call it; ``single`` tells a value for both arms from a list of two."""
        value = self.get(name)
        if single(value):
            return value, name
        if not isinstance(value, list) or len(value) not in (1, 2):
            raise wrong(self.path, name, f"got {value!r}; expected one entry for each of the two arms, or one for both")
        place = min(index, len(value) - 1)
        return value[place], f"{name}.{place}"

    def number(self, name: str) -> float:
        """A finite number."""
        value = self.get(name)
        if not is_number(value):
            raise wrong(self.path, name, f"got {value!r}; expected a number")
        return float(value)

    def positive(self, name: str) -> float:
        """A number above 0."""
        value = self.number(name)
        if value <= 0:
            raise wrong(self.path, name, f"got {value:g}; expected a number above 0")
        return value

    def file(self, name: str) -> Path:
        """A file that is named from the config's folder on."""
        value = self.get(name)
        path = self.path.parent / str(value)
        if not path.is_file():
            raise wrong(self.path, name, f"{value!r} is missing; expected the file {path}")
        return path


def is_number(value: Any) -> bool:
    """Whether a value is a finite number that a float can hold; YAML's integers have no limit."""
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        return False
    return -sys.float_info.max <= value <= sys.float_info.max
