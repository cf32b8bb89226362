"""A gripper measured on the collision shapes of its URDF: opening, finger tips, free finger length, and palm."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np

from vcage.base.errors import DamagedFile, SchemaMismatch
from vcage.base.geometry import Pose, box_corners, rotation_to_quat
from vcage.schema.base import PoseRecord
from vcage.schema.robot import Gripper
from vcage.sim.poses import from_sapien
from vcage.sim.robotwin.arm_urdf import links_below
from vcage.sim.robotwin.embodiment import ArmConfig

if TYPE_CHECKING:
    import sapien

TIP_LENGTH_M, LEAST_SIZE_M = 0.015, 0.001
"""Length of the fingers' ends, on which the opening is measured; and the least opening, reach or palm that counts."""

ASSUMED = {"max_width": 0.08, "tip_depth": 0.01, "finger_length": 0.04, "palm_size": (0.06, 0.15), "force": 100.0}
"""Sizes that cannot be measured: those of a gripper like the Panda's, metres and newtons."""


@dataclass(frozen=True)
class Measured:
    """A measured gripper.

    Args:
        tool_link: the link that its frame hangs on.
        tool_offset: the frame in that link.
        gripper: its sizes.
        warnings: assumptions for sizes that cannot be measured.
    """

    tool_link: str
    tool_offset: PoseRecord
    gripper: Gripper
    warnings: list[str]


def measure_gripper(urdf: Path, arm: ArmConfig, field: str) -> Measured:
    """Measure the gripper of an arm.

    Args:
        urdf: without visuals; its fingers all close the same way.
        arm: joints, and RoboTwin's frame of the gripper.
        field: beginning of the warnings.

    Raises:
        DamagedFile: SAPIEN cannot load the URDF.
        SchemaMismatch: the fingers cannot reach two different positions.
    """
    articulation, _scene = _loaded(urdf, field)
    root = ElementTree.parse(urdf).getroot()
    closed, opened, warnings = _within_limits(articulation, arm, field)
    _place(articulation, arm, opened)
    joint = articulation.find_joint_by_name(arm.ee_joint)
    link, frame = joint.child_link, _gripper_frame(joint, arm)
    fingers, palm = _bodies(articulation, root, arm)
    shapes = [_points(articulation, names, frame) for names in fingers]
    axes = [_axis(articulation, name, frame) for name, _ in arm.fingers]
    sizes = {
        "max_width": _opening(shapes, axes, opened - closed),
        **_lengths(shapes, _points(articulation, palm, frame)),
        "force": _force(root, arm.fingers[0][0]),
    }
    warnings += [
        f"{field}: {name} cannot be measured on the collision shapes; {ASSUMED[name]} is assumed"
        for name, value in sizes.items()
        if value is None
    ]
    known = {name: ASSUMED[name] if value is None else value for name, value in sizes.items()}
    joints = [name for name, _ in arm.fingers]
    gripper = Gripper.model_validate({"joints": joints, "open": opened, "closed": closed, **known})
    offset = from_sapien(link.entity_pose).inverse() * frame
    return Measured(link.name, PoseRecord.of(offset), gripper, warnings)


def _loaded(urdf: Path, field: str) -> tuple[sapien.physx.PhysxArticulation, sapien.Scene]:
    """The URDF in a scene, which must outlive it."""
    import sapien

    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    loader = scene.create_urdf_loader()
    loader.fix_root_link = True
    try:
        return loader.load(str(urdf)), scene
    except Exception as error:  # SAPIEN and its readers raise errors of many types
        raise DamagedFile(
            f"{field}: SAPIEN cannot load the URDF: {type(error).__name__}: {error}", hint="fix the URDF"
        ) from error


def _within_limits(
    articulation: sapien.physx.PhysxArticulation, arm: ArmConfig, field: str
) -> tuple[float, float, list[str]]:
    """Closed and open positions that all fingers can reach, and a warning where they are not the config's."""
    limits = np.array([articulation.find_joint_by_name(name).limits[0] for name, _ in arm.fingers], dtype=float)
    lower, upper = limits[:, 0].max(), limits[:, 1].min()
    reached = [round(float(np.clip(x, lower, upper)), 6) for x in (arm.closed, arm.open)]
    if reached[0] == reached[1]:
        text = f"got {arm.closed:g}, {arm.open:g}; expected different positions within {lower:g} … {upper:g}"
        raise SchemaMismatch(f"{field}.gripper_scale: {text}", hint="fix the field, or the limits in the URDF")
    if np.allclose(reached, (arm.closed, arm.open), atol=1e-6):
        return reached[0], reached[1], []
    warning = (
        f"{field}.gripper_scale: {arm.closed:g} … {arm.open:g} goes beyond the limits {lower:g} … {upper:g};"
        f" {reached[0]:g} … {reached[1]:g} is used"
    )
    return reached[0], reached[1], [warning]


def _place(articulation: sapien.physx.PhysxArticulation, arm: ArmConfig, fingers: float) -> None:
    order = [joint.name for joint in articulation.active_joints]
    qpos = np.zeros(len(order))
    qpos[[order.index(name) for name in arm.joints]] = arm.home or 0.0
    qpos[[order.index(name) for name, _ in arm.fingers]] = fingers
    articulation.set_qpos(qpos)


def _gripper_frame(joint: sapien.physx.PhysxArticulationJoint, arm: ArmConfig) -> Pose:
    """Our gripper frame in the world: z along RoboTwin's x (approach), x along its z (the side of the camera)."""
    origin = from_sapien(joint.global_pose)
    theirs = origin.rotation() @ arm.turn
    axes = np.stack([theirs[:, 2], np.negative(theirs[:, 1]), theirs[:, 0]], axis=1)
    return Pose(origin.p + theirs[:, 0] * arm.bias, rotation_to_quat(axes))


def _bodies(
    articulation: sapien.physx.PhysxArticulation, root: ElementTree.Element, arm: ArmConfig
) -> tuple[list[set[str]], set[str]]:
    """Links of each finger, and of the palm that carries them."""
    joints = [articulation.find_joint_by_name(name) for name, _ in arm.fingers]
    fingers = [links_below(root, [joint.child_link.name], fixed=True) for joint in joints]
    carrier = joints[0].parent_link
    palm = links_below(root, [carrier.name], fixed=True)
    while carrier.parent is not None and not _solid(articulation, palm) and carrier.joint.type == "fixed":
        carrier = carrier.parent
        palm = links_below(root, [carrier.name], fixed=True)
    return fingers, palm - set().union(*fingers)


def _solid(articulation: sapien.physx.PhysxArticulation, names: set[str]) -> bool:
    return any(link.collision_shapes for link in articulation.links if link.name in names)


def _points(articulation: sapien.physx.PhysxArticulation, names: set[str], frame: Pose) -> np.ndarray:
    """(n, 3) corners of the collision shapes of links, in the gripper's frame; n may be 0."""
    to_frame, found = frame.inverse(), [np.zeros((0, 3))]
    for link in articulation.links:
        for shape in link.collision_shapes if link.name in names else []:
            pose = to_frame * from_sapien(link.entity_pose) * from_sapien(shape.local_pose)
            found.append(pose.apply(_corners(shape)))
    return np.concatenate(found)


def _corners(shape: sapien.physx.PhysxCollisionShape) -> np.ndarray:
    from sapien import physx

    if isinstance(shape, physx.PhysxCollisionShapeConvexMesh):
        return np.asarray(shape.vertices, dtype=np.float64) * np.asarray(shape.scale)
    half = np.asarray(cast("physx.PhysxCollisionShapeBox", shape).half_size, dtype=np.float64)
    return box_corners(-half, half)


def _axis(articulation: sapien.physx.PhysxArticulation, name: str, frame: Pose) -> np.ndarray:
    """Direction of a sliding finger's motion, in the gripper's frame; zeros for a turning one."""
    joint = articulation.find_joint_by_name(name)
    axis = from_sapien(joint.global_pose).rotation()[:, 0]
    return frame.rotation().T @ axis * (joint.type == "prismatic")


def _opening(fingers: Sequence[np.ndarray], axes: Sequence[np.ndarray], travel: float) -> float | None:
    """Gap between two fingers near their tips, along y; the distance they slide apart if there are no shapes."""
    if len(fingers) == 2 and all(len(points) for points in fingers):
        tip = min(points[:, 2].max() for points in fingers)
        low, high = sorted((points[points[:, 2] > tip - TIP_LENGTH_M][:, 1] for points in fingers), key=np.mean)
        gap = float(high.min() - low.max())
        if gap > LEAST_SIZE_M:
            return round(gap, 4)
    slid = float(sum(abs(axis[1]) for axis in axes) * abs(travel))
    return round(slid, 4) if slid > LEAST_SIZE_M else None


def _lengths(fingers: Sequence[np.ndarray], palm: np.ndarray) -> dict[str, float | tuple[float, float] | None]:
    points = np.concatenate(fingers)
    reach = round(float(points[:, 2].max()), 4) if len(points) else 0.0
    free = round(float(-palm[:, 2].max()), 4) if len(palm) else 0.0
    wide = 2 * np.abs(palm[:, :2]).max(axis=0) if len(palm) else np.zeros(2)
    return {
        "tip_depth": reach if reach > LEAST_SIZE_M else None,
        "finger_length": free if free > LEAST_SIZE_M else None,
        "palm_size": (round(float(wide[0]), 4), round(float(wide[1]), 4)) if wide.min() > LEAST_SIZE_M else None,
    }


def _force(root: ElementTree.Element, joint: str) -> float | None:
    """The limit of the finger's effort, newtons, if the URDF has one strong enough to hold an object."""
    limit = next(x for x in root.findall("joint") if x.get("name") == joint).find("limit")
    try:
        effort = float("nan" if limit is None else limit.get("effort", "nan"))
    except ValueError:
        effort = float("nan")
    return effort if 1.0 <= effort <= 1000.0 else None
