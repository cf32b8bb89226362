"""``config.yml`` of a RoboTwin embodiment: two arms, their joints, grippers, home, bases, and fixed cameras.

Most fields hold a list with one entry for each arm, left first; one entry serves for both. A missing field gets a
default, and every default is a warning.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, TypeVar

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    Field,
    ValidationError,
    ValidationInfo,
    field_validator,
)

from vcage.base.errors import DamagedFile, InputFileError
from vcage.base.problems import Problem, require_none
from vcage.base.reading import read_yaml

SIDES = ("left", "right")

DEFAULTS: dict[str, Any] = {
    "gripper_bias": 0.12,
    "robot_pose": [[0.0, -0.65, 0.74, 0.70710678, 0.0, 0.0, 0.70710678]],
    "delta_matrix": np.eye(3).tolist(),
    "global_trans_matrix": np.eye(3).tolist(),
    "joint_stiffness": 1000.0,
    "joint_damping": 200.0,
}
"""Values of missing fields: metres, and wxyz quaternions."""

T = TypeVar("T")


def _entries(single: Callable[[Any], bool]) -> BeforeValidator:
    """One or two entries; a ``single`` value serves for both arms."""
    return BeforeValidator(lambda value: [value] if single(value) else value)


def _finite(value: Any) -> float:
    """The number as a float; YAML's integers have no limit."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= np.finfo(np.float64).max:
        raise ValueError("expected a finite number")
    return float(value)


Number = Annotated[float, BeforeValidator(_finite)]
Positive = Annotated[Number, Field(gt=0)]
Vector = tuple[Number, Number, Number]


def _of_unit_length(vector: Vector) -> Vector:
    longest = max(map(abs, vector))
    if longest < 1e-6:
        raise ValueError("expected a direction")
    scaled = np.array(vector) / longest  # the square of a large number may overflow
    x, y, z = (scaled / np.linalg.norm(scaled)).tolist()
    return x, y, z


def _different(names: list[str]) -> list[str]:
    if len(set(names)) < len(names):
        raise ValueError("expected different names of joints, from the base on")
    return names


def _turned(pose: list[float]) -> list[float]:
    if not np.any(np.abs(pose[3:]) > 1e-6):
        raise ValueError("the quaternion is 0 0 0 0; expected w, x, y, z")
    return pose


def _rotation(rows: tuple[Vector, Vector, Vector]) -> tuple[Vector, Vector, Vector]:
    matrix = np.array(rows)
    if not np.allclose(matrix @ matrix.T, np.eye(3), atol=0.02) or np.linalg.det(matrix) <= 0:
        raise ValueError("expected a 3×3 rotation")
    return rows


def _existing(name: Any, info: ValidationInfo) -> Path:
    """A file whose name is relative to the config's folder."""
    path = (info.context or {})["folder"] / str(name)
    if not path.is_file():
        raise ValueError(f"{name!r} is missing; expected the file {path}")
    return path


def _unshifted(mimic: tuple[str, float, float]) -> tuple[str, float, float]:
    if abs(abs(mimic[1]) - 1) > 1e-6 or mimic[2] != 0:
        raise ValueError("expected the factor 1 or -1, and no offset")
    return mimic


Direction = Annotated[Vector, AfterValidator(_of_unit_length)]
Rotation = Annotated[tuple[Vector, Vector, Vector], AfterValidator(_rotation)]
File = Annotated[Path, BeforeValidator(_existing)]
Pose7 = Annotated[list[Number], Field(min_length=7, max_length=7), AfterValidator(_turned)]
JointNames = Annotated[list[str], Field(min_length=1), AfterValidator(_different)]
PerArm = Annotated[list[T], Field(min_length=1, max_length=2)]


class FixedCamera(BaseModel):
    """A camera that stands beside the robot: metres, and unit directions."""

    name: str = Field(min_length=1)
    position: Vector
    forward: Direction
    left: Direction

    @field_validator("left")
    @classmethod
    def _across(cls, left: Vector, info: ValidationInfo) -> Vector:
        if "forward" in info.data and np.linalg.norm(np.cross(info.data["forward"], left)) < 0.5:
            raise ValueError("lies along forward; expected a direction across it")
        return left

    @property
    def up(self) -> np.ndarray:
        """(3,) of unit length."""
        up = np.cross(self.forward, self.left)
        return up / np.linalg.norm(up)


class Fingers(BaseModel):
    """The joints of a gripper: the first finger's, and (joint, factor, offset) of its followers."""

    base: str
    mimic: list[Annotated[tuple[str, Number, Number], AfterValidator(_unshifted)]] = []

    @property
    def joints(self) -> list[tuple[str, bool]]:
        """(joint, reversed) of each finger: a reversed one stands at minus the position of the first."""
        return [(self.base, False), *((joint, factor < 0) for joint, factor, _ in self.mimic)]


@dataclass(frozen=True)
class ArmConfig:
    """The fields of one arm.

    Args:
        joints: of the arm, from the base on.
        ee_joint: the joint whose frame the gripper's frame is given in.
        fingers: (joint, reversed) of each finger, see :attr:`Fingers.joints`.
        closed, open: positions of the first finger.
        home: joint positions; None if the file has none.
        base: x, y, z and quaternion wxyz.
        bias: from the joint's frame to the point between the finger tips, along the approach, metres.
        turn: (3, 3) from RoboTwin's gripper frame (x approach, y closing) to the joint's frame.
    """

    joints: list[str]
    ee_joint: str
    fingers: list[tuple[str, bool]]
    closed: float
    open: float
    home: list[float] | None
    base: np.ndarray
    bias: float
    turn: np.ndarray


class Embodiment(BaseModel):
    """The fields of the file that are used, by their own names.

    Args:
        path: of the file.
        warnings: assumptions.
        dual_arm: True if the URDF holds both arms.
    """

    path: Path
    warnings: list[str]
    urdf_path: File
    srdf_path: File | None = None
    dual_arm: bool = False
    arm_joints_name: Annotated[PerArm[JointNames], _entries(lambda v: _is_list_of(str, v))]
    ee_joints: Annotated[PerArm[str], _entries(lambda v: isinstance(v, str))]
    gripper_name: Annotated[PerArm[Fingers], _entries(lambda v: isinstance(v, dict))]
    gripper_scale: tuple[Number, Number]
    gripper_bias: Number
    homestate: Annotated[PerArm[list[Number]], _entries(lambda v: _is_list_of(int | float, v))] | None = None
    robot_pose: Annotated[PerArm[Pose7], _entries(lambda v: isinstance(v, list) and len(v) == 7)]
    delta_matrix: Rotation
    global_trans_matrix: Rotation
    joint_stiffness: Positive
    joint_damping: Positive
    static_camera_list: list[FixedCamera] = []

    @property
    def arms(self) -> dict[str, ArmConfig]:
        """Both arms by side."""
        return {side: self._arm(i) for i, side in enumerate(SIDES)}

    def _arm(self, side: int) -> ArmConfig:
        return ArmConfig(
            joints=_of_arm(self.arm_joints_name, side),
            ee_joint=_of_arm(self.ee_joints, side),
            fingers=_of_arm(self.gripper_name, side).joints,
            closed=self.gripper_scale[0],
            open=self.gripper_scale[1],
            home=_of_arm(self.homestate, side) if self.homestate else None,
            base=np.array(_of_arm(self.robot_pose, side)),
            bias=self.gripper_bias,
            turn=np.array(self.global_trans_matrix) @ np.array(self.delta_matrix),
        )

    @field_validator("gripper_scale")
    @classmethod
    def _moves(cls, scale: tuple[float, float]) -> tuple[float, float]:
        if scale[0] == scale[1]:
            raise ValueError("expected different closed and open positions")
        return scale

    @field_validator("arm_joints_name")
    @classmethod
    def _apart(cls, names: list[list[str]], info: ValidationInfo) -> list[list[str]]:
        if info.data.get("dual_arm") and set(names[0]) & set(names[-1]):
            raise ValueError("dual_arm is true, but both arms have the same joints")
        return names

    @field_validator("homestate")
    @classmethod
    def _complete(cls, homes: list[list[float]] | None, info: ValidationInfo) -> list[list[float]] | None:
        for side, home in enumerate(homes or []):
            count = len(_of_arm(info.data.get("arm_joints_name", [home]), side))
            if len(home) != count:
                raise ValueError(f"entry {side} has {len(home)} numbers; expected {count} numbers")
        return homes


def _is_list_of(kind: Any, value: Any) -> bool:
    return isinstance(value, list) and bool(value) and isinstance(value[0], kind)


def _of_arm(entries: Sequence[T], side: int) -> T:
    return entries[min(side, len(entries) - 1)]


def read_embodiment(folder: Path) -> Embodiment:
    """Read ``config.yml`` of an embodiment's folder.

    Raises:
        InputFileError: the file does not exist.
        DamagedFile: it is not YAML.
        SchemaMismatch: fields are missing or wrong, or name missing files; names all of them.
    """
    path = folder / "config.yml"
    if not path.is_file():
        raise InputFileError(
            f"{path}: missing; expected the config of a RoboTwin embodiment",
            hint="give a folder like assets/embodiments/franka-panda",
            details={"path": str(path)},
        )
    data = read_yaml(path)
    if not isinstance(data, dict):
        raise DamagedFile(f"{path}: expected fields, got {type(data).__name__}", hint="fix the file")
    data = {name: value for name, value in data.items() if value is not None and value != ""}
    assumed = {name: f"missing; {value} is assumed" for name, value in DEFAULTS.items() if name not in data}
    warnings = [str(Problem(path, name, text)) for name, text in assumed.items()]
    if "homestate" not in data:
        homes = [f"missing; zeros are assumed for the {side} arm" for side in SIDES]
        warnings += [str(Problem(path, "homestate", text)) for text in homes]
    fields = {**DEFAULTS, **data, "path": path, "warnings": warnings}
    try:
        return Embodiment.model_validate(fields, context={"folder": folder})
    except ValidationError as error:
        require_none(_problems(path, error))
        raise


def _problems(path: Path, error: ValidationError) -> list[Problem]:
    found = []
    for one in error.errors():
        text = one["msg"].removeprefix("Value error, ")
        text = "missing; expected a value" if one["type"] == "missing" else f"got {one['input']!r}; {text}"
        found.append(Problem(path, ".".join(map(str, one["loc"])), text))
    return found
