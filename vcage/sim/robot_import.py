"""Import a robot of RoboTwin: ``embodiments/<name>/config.yml`` with its URDF becomes ``<data>/robots/<name>.yml``.

Beside the record, a folder of its name holds one URDF per arm (see :mod:`vcage.sim.robot_urdf`); the meshes stay in
the embodiment's folder, which must stay where it is.
"""

from __future__ import annotations

import re
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from vcage.base.errors import UsageError
from vcage.base.files import atomic_folder, data_path, resource, write_text
from vcage.schema.base import PoseRecord
from vcage.schema.robot import Arm, Robot, RobotCamera
from vcage.sim.gripper_measure import Measured, measure_gripper
from vcage.sim.robot_config import ArmConfig, Embodiment, read_embodiment
from vcage.sim.robot_fields import numbers, wrong
from vcage.sim.robot_urdf import ArmFiles, arm_files, held_joints, links_of_arm, read_robot

LONGEST = 80
"""Characters of a robot's name."""

DISTANCE = 0.6
"""Between the bases of two single arms, metres, when it is not given."""

FOVY = 0.65
"""Vertical field of view of a camera that RoboTwin gives none, radians: a RealSense D435's."""

HEAD_CAMERA = {
    "fovy": 0.95,
    "position": (0.0, -0.5, 1.62),
    "forward": (0.0, 0.5, -0.866025),
    "up": (0.0, 0.866025, 0.5),
}
"""Between and above the shoulders, looking down at the middle of the table."""

WRIST_LINKS = {"left": ("left_camera", "camera"), "right": ("right_camera", "camera")}
"""Links that RoboTwin mounts its wrist cameras on: x forward, z up."""


@dataclass(frozen=True)
class ImportedRobot:
    """A robot that was imported.

    Args:
        name: what ``load_robot`` calls it.
        path: of its record.
        warnings: what was assumed.
    """

    name: str
    path: Path
    warnings: list[str]


def import_robot(folder: Path, distance: float | None = None, *, force: bool = False) -> ImportedRobot:
    """Import an embodiment.

    Args:
        folder: that holds ``config.yml``.
        distance: between the bases of two single arms, metres; :data:`DISTANCE` when not given.
        force: replace a robot of that name that was imported before.

    Raises:
        UsageError: the name is taken or too long, or a distance is given for a robot whose arms are on one body.
        InputFileError: a file is missing or damaged, or a field is not what it should be; names it.
    """
    folder = Path(folder).resolve()
    name = re.sub(r"[^a-z0-9_-]", "_", folder.name.lower()).lstrip("_-") or "robot"
    path = data_path("robots", f"{name}.yml")
    _claim(name, path, force)
    embodiment = read_embodiment(folder)
    if embodiment.dual and distance is not None:
        raise UsageError(f"{name} has both arms on one body: there is no distance to set", hint="leave out --distance")
    if not embodiment.dual and distance is None:
        embodiment.warnings.append(f"{embodiment.path}: the arms' distance is not given; {DISTANCE} m is assumed")
    root = read_robot(embodiment)
    files, measured = _measured(embodiment, root)
    own = path.with_suffix("")
    robot = _robot(name, embodiment, root, measured, own, DISTANCE if distance is None else distance)
    with atomic_folder(own) as part:
        for side, arm in files.items():
            _write_files(part, side, arm)
    write_text(path, _yaml(robot))
    return ImportedRobot(name, path, list(dict.fromkeys(embodiment.warnings)))


def _claim(name: str, path: Path, force: bool) -> None:
    if len(name) > LONGEST:
        raise UsageError(
            f"{name!r} has {len(name)} characters; expected at most {LONGEST}", hint="rename the embodiment's folder"
        )
    own = resource("assets", "robots", f"{name}.yml")
    if own.is_file():
        raise UsageError(f"{name!r} is the name of {own} already", hint="rename the embodiment's folder")
    if path.is_file() and not force:
        raise UsageError(f"{name!r} is the name of {path} already", hint="replace it: --force")


def _measured(embodiment: Embodiment, root: Element) -> tuple[dict[str, ArmFiles], dict[str, Measured]]:
    """The files of each arm, and its gripper; two arms alike are measured by themselves all the same."""
    held = held_joints(root, embodiment)
    if held:
        embodiment.warnings.append(f"{embodiment.urdf}: neither arm nor finger, held where they are: {', '.join(held)}")
    files, measured = {}, {}
    for side, arm in embodiment.arms.items():
        files[side] = arm_files(root, embodiment, side)
        with tempfile.TemporaryDirectory() as scratch:
            _write_files(Path(scratch), side, arm_files(root, embodiment, side, visuals=False))
            measured[side] = measure_gripper(Path(scratch) / f"{side}.urdf", arm, f"{embodiment.path}: {side} gripper")
        embodiment.warnings += measured[side].warnings
    return files, measured


def _write_files(folder: Path, side: str, files: ArmFiles) -> None:
    (folder / f"{side}.urdf").write_bytes(files.urdf)
    if files.srdf is not None:
        (folder / f"{side}.srdf").write_bytes(files.srdf)
    for name, text in files.meshes.items():
        (folder / name).write_text(text)


# --- the record --------------------------------------------------------------------------------------------


def _robot(
    name: str, embodiment: Embodiment, root: Element, measured: dict[str, Measured], own: Path, distance: float
) -> Robot:
    cameras = _fixed_cameras(embodiment)
    for side, names in WRIST_LINKS.items():
        links = links_of_arm(root, embodiment.arms[side])
        link = next((x for x in names if x in links), None)
        if link is None:
            embodiment.warnings.append(
                f"{embodiment.urdf}: no link {' or '.join(names)}: no camera at the {side} wrist"
            )
        else:
            view = {"position": (0, 0, 0), "forward": (1, 0, 0), "up": (0, 0, 1)}
            cameras[f"cam_{side}_wrist"] = RobotCamera(fovy=FOVY, arm=side, link=link, **view)
    arms = {side: _arm(embodiment, root, side, measured[side], own, distance) for side in embodiment.arms}
    text = f"{name}, imported from RoboTwin."
    # Decimation needs materials, which STL and OBJ files of other projects often lack.
    return Robot(name=name, description=text, arms=arms, cameras=cameras, visual_faces=1.0)


def _arm(embodiment: Embodiment, root: Element, side: str, measured: Measured, own: Path, distance: float) -> Arm:
    arm = embodiment.arms[side]
    position = arm.base[:3].copy()
    if not embodiment.dual:
        position[0] += distance / 2 * (-1 if side == "left" else 1)
    quaternion = arm.base[3:] / np.linalg.norm(arm.base[3:])
    return Arm(
        urdf=f"file:{own / f'{side}.urdf'}",
        srdf=None if embodiment.srdf is None else f"file:{own / f'{side}.srdf'}",
        base=PoseRecord(position=_rounded(position), quaternion=_rounded(quaternion)),
        joints=arm.joints,
        home=_home(embodiment, root, arm, side),
        tool_link=measured.tool_link,
        tool_offset=measured.tool_offset,
        gripper=measured.gripper,
        stiffness=embodiment.stiffness,
        damping=embodiment.damping,
    )


def _home(embodiment: Embodiment, root: Element, arm: ArmConfig, side: str) -> list[float]:
    """Home within the limits of the joints."""
    home = list(arm.home or [0.0] * len(arm.joints))
    joints = {joint.get("name"): joint for joint in root.findall("joint")}
    for i, name in enumerate(arm.joints):
        limit = joints[name].find("limit")
        if joints[name].get("type") == "continuous" or limit is None:
            continue
        lower, upper = float(limit.get("lower", "0")), float(limit.get("upper", "0"))
        if not lower <= home[i] <= upper:
            embodiment.warnings.append(
                f"{embodiment.path}: field homestate: {home[i]:g} for {name} of the {side} arm;"
                f" expected {lower:g} … {upper:g}: taken to that range"
            )
            home[i] = float(np.clip(home[i], lower, upper))
    return home


def _fixed_cameras(embodiment: Embodiment) -> dict[str, RobotCamera]:
    cameras = {}
    for i, camera in enumerate(embodiment.cameras):
        field = f"static_camera_list.{i}"
        name = camera.get("name")
        if not isinstance(name, str) or not name:
            raise wrong(embodiment.path, f"{field}.name", f"got {name!r}; expected a name")
        position = numbers(embodiment.path, f"{field}.position", camera.get("position"), 3)
        forward = _direction(embodiment, f"{field}.forward", camera.get("forward"))
        left = _direction(embodiment, f"{field}.left", camera.get("left"))
        up = np.cross(forward, left)
        if np.linalg.norm(up) < 0.5:
            raise wrong(embodiment.path, f"{field}.left", "lies along forward; expected a direction across it")
        up = up / np.linalg.norm(up)
        embodiment.warnings.append(f"{embodiment.path}: field {field}: no field of view; {FOVY} rad is assumed")
        cameras[name] = RobotCamera(fovy=FOVY, position=_rounded(position), forward=_rounded(forward), up=_rounded(up))
    if not cameras:
        embodiment.warnings.append(
            f"{embodiment.path}: field static_camera_list: missing; a camera over the table is assumed"
        )
        cameras["cam_high"] = RobotCamera(**HEAD_CAMERA)
    return cameras


def _direction(embodiment: Embodiment, field: str, value: Any) -> np.ndarray:
    vector = numbers(embodiment.path, field, value, 3)
    longest = np.abs(vector).max()
    if longest < 1e-6:
        raise wrong(embodiment.path, field, "got 0 0 0; expected a direction")
    vector = vector / longest  # the squares of a large number may be too large
    return vector / np.linalg.norm(vector)


def _rounded(values: np.ndarray) -> tuple[float, ...]:
    return tuple(round(float(x), 7) + 0.0 for x in values)


def _yaml(robot: Robot) -> str:
    import yaml

    return yaml.safe_dump(robot.model_dump(mode="json", by_alias=True), sort_keys=False, allow_unicode=True)
