"""Import a robot of RoboTwin: ``embodiments/<name>/config.yml`` with its URDF becomes ``<data>/robots/<name>.yml``.

Beside the record, a folder of its name holds one URDF per arm (:mod:`vcage.sim.robotwin.arm_urdf`); the meshes stay
in the embodiment's folder, which must stay where it is.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
import yaml

from vcage.base.errors import UsageError
from vcage.base.files import atomic_folder, data_path, resource, write_text
from vcage.base.leftovers import scratch_folder
from vcage.schema.base import PoseRecord, Vec3
from vcage.schema.robot import Arm, Robot, RobotCamera
from vcage.sim.robotwin.arm_urdf import ArmFiles, arm_files, held_joints, links_of_arm, read_robot
from vcage.sim.robotwin.embodiment import Embodiment, read_embodiment
from vcage.sim.robotwin.gripper import Measured, measure_gripper

LONGEST_NAME = 80
"""Characters of a robot's name."""

ARM_DISTANCE_M, FOVY_RAD = 0.6, 0.65
"""Assumed distance between the bases of two single arms, and vertical field of view of a camera (RealSense D435)."""

HEAD_CAMERA = RobotCamera(fovy=0.95, position=(0.0, -0.5, 1.62), forward=(0.0, 0.5, -0.866025), up=(0.0, 0.866025, 0.5))
"""Between and above the shoulders, looking down at the middle of the table."""

WRIST_LINKS = {"left": ("left_camera", "camera"), "right": ("right_camera", "camera")}
"""Links that RoboTwin mounts its wrist cameras on: x forward, z up."""


@dataclass(frozen=True)
class ImportedRobot:
    """A robot that was imported.

    Args:
        name: for ``load_robot``.
        path: of its record.
        warnings: assumptions.
    """

    name: str
    path: Path
    warnings: list[str]


def import_robot(folder: Path, distance: float | None = None, *, force: bool = False) -> ImportedRobot:
    """Import an embodiment.

    Args:
        folder: that holds ``config.yml``.
        distance: between the bases of two single arms, metres; :data:`ARM_DISTANCE_M` when not given.
        force: replace an earlier import of that name.

    Raises:
        UsageError: the name is taken or too long, or a distance is given for a robot whose arms are on one body.
        InputFileError: a file is missing or damaged, or fields are invalid: one error names all of the
            config, or, where that is whole, all of the URDF.
    """
    folder = Path(folder).resolve()
    name = re.sub(r"[^a-z0-9_-]", "_", folder.name.lower()).lstrip("_-") or "robot"
    path = data_path("robots", f"{name}.yml")
    _claim(name, path, force)
    embodiment = read_embodiment(folder)
    warnings = list(embodiment.warnings)
    if embodiment.dual_arm and distance is not None:
        raise UsageError(f"{name} has both arms on one body: there is no distance to set", hint="leave out --distance")
    if not embodiment.dual_arm and distance is None:
        warnings.append(f"{embodiment.path}: the arms' distance is not given; {ARM_DISTANCE_M} m is assumed")
    distance = ARM_DISTANCE_M if distance is None else distance
    root = read_robot(embodiment)
    if held := held_joints(root, embodiment):
        warnings.append(f"{embodiment.urdf_path}: neither arm nor finger, held where they are: {', '.join(held)}")
    files, measured = {}, {}
    for side in embodiment.arms:
        files[side], measured[side] = arm_files(root, embodiment, side), _measured(embodiment, root, side)
        warnings += measured[side].warnings
    cameras, assumed = _cameras(embodiment, root)
    warnings += assumed
    own, arms = path.with_suffix(""), {}
    for side, gripper in measured.items():
        arms[side], assumed = _arm(embodiment, root, side, gripper, own, distance)
        warnings += assumed
    text = f"{name}, imported from RoboTwin."
    # Decimation needs materials, which STL and OBJ files of other projects often lack.
    robot = Robot(name=name, description=text, arms=arms, cameras=cameras, visual_faces=1.0)
    with atomic_folder(own) as part:
        for side, arm in files.items():
            _write_files(part, side, arm)
    record = yaml.safe_dump(robot.model_dump(mode="json", by_alias=True), sort_keys=False, allow_unicode=True)
    write_text(path, record)
    return ImportedRobot(name, path, list(dict.fromkeys(warnings)))


def _claim(name: str, path: Path, force: bool) -> None:
    if len(name) > LONGEST_NAME:
        raise UsageError(
            f"{name!r} has {len(name)} characters; expected at most {LONGEST_NAME}",
            hint="rename the embodiment's folder",
        )
    own = resource("assets", "robots", f"{name}.yml")
    if own.is_file():
        raise UsageError(f"{name!r} is the name of {own} already", hint="rename the embodiment's folder")
    if path.is_file() and not force:
        raise UsageError(f"{name!r} is the name of {path} already", hint="replace it: --force")


def _measured(embodiment: Embodiment, root: Element, side: str) -> Measured:
    """The gripper of an arm; each of two equal arms is measured by itself."""
    with scratch_folder() as scratch:
        _write_files(scratch, side, arm_files(root, embodiment, side, visuals=False))
        field = f"{embodiment.path}: {side} gripper"
        return measure_gripper(scratch / f"{side}.urdf", embodiment.arms[side], field)


def _write_files(folder: Path, side: str, files: ArmFiles) -> None:
    (folder / f"{side}.urdf").write_bytes(files.urdf)
    if files.srdf is not None:
        (folder / f"{side}.srdf").write_bytes(files.srdf)
    for name, text in files.meshes.items():
        (folder / name).write_text(text)


# --- the record --------------------------------------------------------------------------------------------


def _arm(
    embodiment: Embodiment, root: Element, side: str, measured: Measured, own: Path, distance: float
) -> tuple[Arm, list[str]]:
    """The record of an arm, and the assumptions.

    Args:
        own: folder of the robot's files.
        distance: between the bases of two single arms, metres.
    """
    arm = embodiment.arms[side]
    position = arm.base[:3].copy()
    if not embodiment.dual_arm:
        position[0] += distance / 2 * (-1 if side == "left" else 1)
    w, x, y, z = (_rounded(q) for q in arm.base[3:] / np.linalg.norm(arm.base[3:]))
    home, warnings = _home(embodiment, root, side)
    record = Arm(
        urdf=f"file:{own / f'{side}.urdf'}",
        srdf=None if embodiment.srdf_path is None else f"file:{own / f'{side}.srdf'}",
        base=PoseRecord(position=_vector(position), quaternion=(w, x, y, z)),
        joints=arm.joints,
        home=home,
        tool_link=measured.tool_link,
        tool_offset=measured.tool_offset,
        gripper=measured.gripper,
        stiffness=embodiment.joint_stiffness,
        damping=embodiment.joint_damping,
    )
    return record, warnings


def _home(embodiment: Embodiment, root: Element, side: str) -> tuple[list[float], list[str]]:
    """Home within the limits of the joints, and a warning for each angle that was changed."""
    arm, warnings = embodiment.arms[side], []
    home = list(arm.home or [0.0] * len(arm.joints))
    joints = {joint.get("name"): joint for joint in root.findall("joint")}
    for i, name in enumerate(arm.joints):
        limit = joints[name].find("limit")
        if joints[name].get("type") == "continuous" or limit is None:
            continue
        lower, upper = float(limit.get("lower", "0")), float(limit.get("upper", "0"))
        if not lower <= home[i] <= upper:
            warnings.append(
                f"{embodiment.path}: field homestate: {home[i]:g} for {name} of the {side} arm;"
                f" expected {lower:g} … {upper:g}: taken to that range"
            )
            home[i] = float(np.clip(home[i], lower, upper))
    return home, warnings


def _cameras(embodiment: Embodiment, root: Element) -> tuple[dict[str, RobotCamera], list[str]]:
    """The fixed cameras and those at the wrists by name, and the assumptions."""
    cameras, warnings = _fixed_cameras(embodiment)
    for side, names in WRIST_LINKS.items():
        links = links_of_arm(root, embodiment.arms[side])
        link = next((x for x in names if x in links), None)
        if link is None:
            warnings.append(f"{embodiment.urdf_path}: no link {' or '.join(names)}: no camera at the {side} wrist")
        else:
            cameras[f"cam_{side}_wrist"] = RobotCamera(
                fovy=FOVY_RAD, arm=side, link=link, position=(0, 0, 0), forward=(1, 0, 0), up=(0, 0, 1)
            )
    return cameras, warnings


def _fixed_cameras(embodiment: Embodiment) -> tuple[dict[str, RobotCamera], list[str]]:
    cameras, warnings = {}, []
    for i, camera in enumerate(embodiment.static_camera_list):
        warnings.append(f"{embodiment.path}: field static_camera_list.{i}: no field of view; {FOVY_RAD} rad is assumed")
        cameras[camera.name] = RobotCamera(
            fovy=FOVY_RAD,
            position=_vector(camera.position),
            forward=_vector(camera.forward),
            up=_vector(camera.up),
        )
    if not cameras:
        warnings.append(f"{embodiment.path}: field static_camera_list: missing; a camera over the table is assumed")
        cameras["cam_high"] = HEAD_CAMERA
    return cameras, warnings


def _vector(values: Sequence[float] | np.ndarray) -> Vec3:
    x, y, z = (_rounded(value) for value in values)
    return x, y, z


def _rounded(value: float) -> float:
    """To 0.1 µm, and never -0."""
    return round(float(value), 7) + 0.0
