"""``config.yml`` of a RoboTwin embodiment: two arms, their joints, grippers, home, bases, and fixed cameras.

Most fields hold a list with one entry for each arm, left first; one entry serves for both. A field that is left out
gets a default, and every default is a warning.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import numpy as np

from vcage.base.errors import DamagedFile, InputFileError, SchemaMismatch
from vcage.base.reading import read_yaml

P = ParamSpec("P")
T = TypeVar("T")

SIDES = ("left", "right")

DEFAULTS: dict[str, Any] = {
    "gripper_bias": 0.12,
    "robot_pose": [[0.0, -0.65, 0.74, 0.70710678, 0.0, 0.0, 0.70710678]],
    "delta_matrix": np.eye(3).tolist(),
    "global_trans_matrix": np.eye(3).tolist(),
    "joint_stiffness": 1000.0,
    "joint_damping": 200.0,
}
"""What is assumed for fields that are left out: metres, and wxyz quaternions."""


@dataclass(frozen=True)
class ArmConfig:
    """One arm as it is written.

    Args:
        joints: of the arm, from the base on.
        ee_joint: the joint whose frame the gripper's frame is given in.
        fingers: (joint, reversed) of each finger: a reversed one stands at minus the position of the first.
        closed, open: positions of the first finger.
        home: joint positions; None where nobody says.
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


@dataclass(frozen=True)
class FixedCamera:
    """A camera that stands beside the robot.

    Args:
        name: of it.
        position: (3,) metres.
        forward, up: (3,) of unit length.
    """

    name: str
    position: np.ndarray
    forward: np.ndarray
    up: np.ndarray


@dataclass(frozen=True)
class Embodiment:
    """A whole config.

    Args:
        path: of the file.
        urdf, srdf: files.
        dual: whether the URDF holds both arms.
        arms: by side.
        stiffness, damping: of the arms' joints.
        cameras: that stand beside the robot.
        warnings: what was assumed.
    """

    path: Path
    urdf: Path
    srdf: Path | None
    dual: bool
    arms: dict[str, ArmConfig]
    stiffness: float
    damping: float
    cameras: list[FixedCamera]
    warnings: list[str]


def read_embodiment(folder: Path) -> Embodiment:
    """Read ``config.yml`` of an embodiment's folder.

    Raises:
        InputFileError: there is no such file, or it names a file that is missing.
        DamagedFile: it is not YAML.
        SchemaMismatch: fields are missing or not what they should be; names all of them.
    """
    path = folder / "config.yml"
    fields = _read_fields(path)
    attempt, dual = fields.problems.attempt, bool(fields.data.get("dual_arm", False))
    arms = {side: _arm(fields, i) for i, side in enumerate(SIDES)}
    urdf = attempt(fields.file, "urdf_path")
    srdf = attempt(fields.file, "srdf_path") if fields.data.get("srdf_path") else None
    stiffness, damping = attempt(fields.positive, "joint_stiffness"), attempt(fields.positive, "joint_damping")
    cameras = _cameras(fields)
    left, right = arms["left"], arms["right"]
    if left and right and dual and set(left.joints) & set(right.joints):
        fields.problems.add(wrong(path, "arm_joints_name", "dual_arm is true, but both arms have the same joints"))
    fields.problems.require_none()
    assert left and right and urdf and stiffness and damping  # for the type checker: what is None is a problem
    whole = {"left": left, "right": right}
    return Embodiment(path, urdf, srdf, dual, whole, stiffness, damping, cameras, fields.warnings)


def _arm(fields: _Fields, index: int) -> ArmConfig | None:
    """One arm; None where some of its fields are wrong, which are noted."""
    attempt = fields.problems.attempt
    joints, ee_joint = attempt(_joints, fields, index), attempt(_ee_joint, fields, index)
    fingers, base = attempt(_fingers, fields, index), attempt(_base, fields, index)
    scale, bias = attempt(_scale, fields), attempt(fields.number, "gripper_bias")
    turns = [attempt(_rotation, fields, name) for name in ("global_trans_matrix", "delta_matrix")]
    before = len(fields.problems.found)
    home = None if joints is None else attempt(_home, fields, index, len(joints))
    wrong_home = len(fields.problems.found) > before
    if joints is None or ee_joint is None or fingers is None or base is None or scale is None or bias is None:
        return None
    if turns[0] is None or turns[1] is None or wrong_home:
        return None
    return ArmConfig(
        joints=joints,
        ee_joint=ee_joint,
        fingers=fingers,
        closed=scale[0],
        open=scale[1],
        home=home,
        base=base,
        bias=bias,
        turn=turns[0] @ turns[1],
    )


def _joints(fields: _Fields, index: int) -> list[str]:
    joints, name = fields.side("arm_joints_name", index, _is_names)
    if not _is_names(joints) or len(set(joints)) != len(joints):
        raise wrong(fields.path, name, f"got {joints!r}; expected different names of joints, from the base on")
    return joints


def _ee_joint(fields: _Fields, index: int) -> str:
    ee_joint, name = fields.side("ee_joints", index, lambda value: isinstance(value, str))
    if not isinstance(ee_joint, str):
        raise wrong(fields.path, name, f"got {ee_joint!r}; expected the name of a joint")
    return ee_joint


def _scale(fields: _Fields) -> tuple[float, float]:
    closed, opened = numbers(fields.path, "gripper_scale", fields.get("gripper_scale"), 2)
    if closed == opened:
        raise wrong(fields.path, "gripper_scale", f"got {closed:g} twice; expected closed and open positions")
    return float(closed), float(opened)


def _base(fields: _Fields, index: int) -> np.ndarray:
    base, name = fields.side("robot_pose", index, lambda value: isinstance(value, list) and len(value) == 7)
    pose = numbers(fields.path, name, base, 7)
    if np.linalg.norm(pose[3:]) < 1e-6:
        raise wrong(fields.path, name, "the quaternion is 0 0 0 0; expected w, x, y, z")
    return pose


def _cameras(fields: _Fields) -> list[FixedCamera]:
    """The fixed cameras; those that are wrong are noted."""
    field = "static_camera_list"
    listed = fields.data.get(field) or []
    if not isinstance(listed, list) or not all(isinstance(camera, dict) for camera in listed):
        text = "expected a list of cameras with name, position, forward and left"
        fields.problems.add(wrong(fields.path, field, text))
        return []
    found = [fields.problems.attempt(_camera, fields, f"{field}.{i}", camera) for i, camera in enumerate(listed)]
    return [camera for camera in found if camera is not None]


def _camera(fields: _Fields, field: str, camera: dict[str, Any]) -> FixedCamera:
    name, path = camera.get("name"), fields.path
    if not isinstance(name, str) or not name:
        raise wrong(path, f"{field}.name", f"got {name!r}; expected a name")
    position = numbers(path, f"{field}.position", camera.get("position"), 3)
    forward = _direction(path, f"{field}.forward", camera.get("forward"))
    up = np.cross(forward, _direction(path, f"{field}.left", camera.get("left")))
    if np.linalg.norm(up) < 0.5:
        raise wrong(path, f"{field}.left", "lies along forward; expected a direction across it")
    return FixedCamera(name, position, forward, up / np.linalg.norm(up))


def _direction(path: Path, field: str, value: Any) -> np.ndarray:
    vector = numbers(path, field, value, 3)
    longest = np.abs(vector).max()
    if longest < 1e-6:
        raise wrong(path, field, "got 0 0 0; expected a direction")
    vector = vector / longest  # the squares of a large number may be too large
    return vector / np.linalg.norm(vector)


def _fingers(fields: _Fields, index: int) -> list[tuple[str, bool]]:
    gripper, name = fields.side("gripper_name", index, lambda value: isinstance(value, dict))
    if not isinstance(gripper, dict) or not isinstance(gripper.get("base"), str):
        raise wrong(fields.path, f"{name}.base", f"got {gripper!r}; expected the name of the first finger's joint")
    fingers = [(gripper["base"], False)]
    mimics = gripper.get("mimic") or []
    if not isinstance(mimics, list):
        raise wrong(fields.path, f"{name}.mimic", f"got {mimics!r}; expected a list of [joint, factor, offset]")
    for i, mimic in enumerate(mimics):
        place = f"{name}.mimic.{i}"
        if not isinstance(mimic, list) or len(mimic) != 3 or not isinstance(mimic[0], str):
            raise wrong(fields.path, place, f"got {mimic!r}; expected a joint, a factor and an offset")
        factor, offset = numbers(fields.path, place, mimic[1:], 2)
        if abs(abs(factor) - 1) > 1e-6 or offset != 0:
            raise wrong(
                fields.path, place, f"got the factor {factor:g}, offset {offset:g}; expected 1 or -1, and no offset"
            )
        fingers.append((mimic[0], bool(factor < 0)))
    return fingers


def _home(fields: _Fields, index: int, count: int) -> list[float] | None:
    if fields.data.get("homestate") is None:
        fields.warn("homestate", f"missing; zeros are assumed for the {SIDES[index]} arm")
        return None
    value, name = fields.side("homestate", index, lambda x: isinstance(x, list) and bool(x) and is_number(x[0]))
    return [float(x) for x in numbers(fields.path, name, value, count)]


def _rotation(fields: _Fields, name: str) -> np.ndarray:
    try:
        matrix = np.array(fields.get(name), dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        matrix = np.zeros(0)
    good = matrix.shape == (3, 3) and np.allclose(matrix @ matrix.T, np.eye(3), atol=0.02) and np.linalg.det(matrix) > 0
    if not good:
        raise wrong(fields.path, name, f"got {fields.data.get(name)!r}; expected a 3×3 rotation")
    return matrix


def _is_names(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(x, str) for x in value)


def wrong(path: Path, name: str, message: str) -> SchemaMismatch:
    """The error for a field that the robot cannot be made with.

    Args:
        path: of the file.
        name: of the field.
        message: what is wrong with it.
    """
    return SchemaMismatch(
        f"{path}: field {name}: {message}", hint="mend the field", details={"path": str(path), "field": name}
    )


class Problems:
    """What is wrong in a file, gathered so that all of it can be mended at once."""

    def __init__(self) -> None:
        self.found: list[SchemaMismatch] = []

    def add(self, problem: SchemaMismatch) -> None:
        """Note a problem, once."""
        if problem.message not in (known.message for known in self.found):
            self.found.append(problem)

    def attempt(self, read: Callable[P, T], *arguments: P.args, **options: P.kwargs) -> T | None:
        """What a function reads; None where something is wrong, which is noted."""
        try:
            return read(*arguments, **options)
        except SchemaMismatch as problem:
            self.add(problem)
            return None

    def require_none(self) -> None:
        """Nothing, if nothing was noted.

        Raises:
            SchemaMismatch: something was; one error tells all.
        """
        if len(self.found) == 1:
            raise self.found[0]
        if self.found:
            fields = [problem.details["field"] for problem in self.found]
            raise SchemaMismatch(
                f"{len(fields)} fields are wrong: {'; '.join(problem.message for problem in self.found)}",
                hint="mend them",
                details={"path": self.found[0].details["path"], "fields": fields},
            )


def numbers(path: Path, name: str, value: Any, count: int) -> np.ndarray:
    """(count,) the finite numbers in a list.

    Args:
        path: of the file.
        name: of the field.
        value: that it has.
        count: how many numbers there should be.

    Raises:
        SchemaMismatch: it is something else.
    """
    if not isinstance(value, list) or len(value) != count or not all(is_number(x) for x in value):
        raise wrong(path, name, f"got {value!r}; expected {count} numbers")
    return np.array(value, dtype=np.float64)


def _read_fields(path: Path) -> _Fields:
    """Read a config.

    Raises:
        InputFileError: there is no such file.
        DamagedFile: it is not YAML, or holds no fields.
    """
    if not path.is_file():
        raise InputFileError(
            f"{path}: missing; expected the config of a RoboTwin embodiment",
            hint="give a folder like assets/embodiments/franka-panda",
            details={"path": str(path)},
        )
    data = read_yaml(path)
    if not isinstance(data, dict):
        raise DamagedFile(f"{path}: expected fields, got {type(data).__name__}", hint="mend the file")
    return _Fields(path, data)


class _Fields:
    """The fields of a config; every method names the field that it complains of."""

    def __init__(self, path: Path, data: dict[str, Any]):
        self.path, self.data = path, data
        self.warnings: list[str] = []
        self.problems = Problems()

    def get(self, name: str) -> Any:
        """The value of a field, or its default with a warning."""
        if self.data.get(name) is not None:
            return self.data[name]
        if name not in DEFAULTS:
            raise wrong(self.path, name, "missing; expected a value")
        self.warn(name, f"missing; {DEFAULTS[name]} is assumed")
        return DEFAULTS[name]

    def warn(self, name: str, text: str) -> None:
        """Keep a warning about a field, once."""
        note = f"{self.path}: field {name}: {text}"
        if note not in self.warnings:
            self.warnings.append(note)

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
