"""RoboTwin's articulated objects: ``<id>/mobility.urdf`` with ``model_data.json`` beside it.

The URDF is z up with its front along -x, as PartNet-Mobility has it; RoboTwin's tasks stand it before the robot with
a quarter turn about z, and so do we. Links that fixed joints hold together become one body. Our zero of a joint is
where RoboTwin starts it (``init_qpos``).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from vcage.base.errors import mismatch
from vcage.objects.importers.component_hulls import component_hulls, hulls_of_surface, joined
from vcage.objects.importers.converted import Converted, estimated_mass, total_volume
from vcage.objects.importers.looks import parts_of
from vcage.objects.importers.robotwin_data import ModelData, RawPoint, read_model_data
from vcage.objects.importers.robotwin_points import Placed, converted_variant, scaled_point
from vcage.objects.importers.robotwin_words import unique
from vcage.objects.importers.urdf import Shape, Urdf, UrdfJoint, read_urdf
from vcage.objects.mesh_files import report_unseen_textures
from vcage.objects.modelling.parts import BuiltObject, MovingPart, Part
from vcage.schema.asset import Joint

FACING_US = Rotation.from_euler("z", 90, degrees=True).as_matrix()
"""From the URDF's frame, front along -x, to ours, front along -y."""

LINK_MASS = 0.1
"""Of a link that a list of masses does not name, kilograms; RoboTwin's own value."""

DAMPING, FRICTION = {"slide": 20.0, "turn": 1.0}, {"slide": 1.0, "turn": 0.3}
"""Where a URDF says none: N s/m and N m s/rad, N and N m; a drawer or lid stays where it is left."""


@dataclass(frozen=True)
class RestPose:
    """An articulated object at rest.

    Args:
        frames: (4, 4) of each link, scaled, in our orientation.
        rest: joint positions by joint, metres and radians.
        bodies: the leading link of each link's body: the root, or the child of a moving joint.
        names: of the moving parts by leading link; the root's body has none.
    """

    frames: dict[str, np.ndarray]
    rest: dict[str, float]
    bodies: dict[str, str]
    names: dict[str, str]


def convert(folder: Path, info: dict[str, Any], report: Callable[[str], None]) -> Converted:
    """One variant of an articulated object.

    Args:
        folder: that holds ``mobility.urdf``.
        info: of ``points_info.json``.
        report: called with a sentence about each omission or assumption.

    Raises:
        InputFileError: the URDF or a mesh cannot be used, or a field that nothing works without is wrong.
    """
    model = read_model_data(folder / "model_data.json", info, report)
    if np.ptp(model.scale) > 1e-9:
        raise mismatch(
            model.file.path, "scale", f"got {model.scale.tolist()}; expected one scale for all axes of a URDF"
        )
    urdf = read_urdf(folder / "mobility.urdf")
    for file in dict.fromkeys(shape.source for shapes in urdf.visuals.values() for shape in shapes):
        if isinstance(file, Path):
            report_unseen_textures(file, report, folder)
    pose = _at_rest(urdf, model)
    built = _built(urdf, model, pose)
    identifier = _identifier(folder.name)
    return converted_variant(identifier, built, model, lambda raws, origin: _placed(raws, model, pose, origin))


def _placed(raws: Sequence[RawPoint], model: ModelData, pose: RestPose, origin: np.ndarray) -> list[Placed]:
    points = []
    for raw in raws:
        if raw.base not in pose.frames:
            known = ", ".join(pose.frames)
            model.file.warn(raw.field, f"its base is {raw.base!r}; expected a link, one of {known}: left out")
            continue
        frame = pose.frames[raw.base].copy()
        frame[:3, 3] -= origin
        points.append(scaled_point(model, raw, frame, pose.names.get(pose.bodies[raw.base])))
    return points


# --- kinematics --------------------------------------------------------------------------------------------


def _at_rest(urdf: Urdf, model: ModelData) -> RestPose:
    scale, rest = float(model.scale[0]), _rest(urdf, model)
    root = np.eye(4)
    root[:3, :3] = model.transform @ FACING_US
    frames, bodies = {urdf.root: root}, {urdf.root: urdf.root}
    names: dict[str, str] = {}
    for joint in urdf.joints:
        frames[joint.child] = frames[joint.parent] @ _scaled(joint.origin, scale) @ _motion(joint, rest)
        moves = joint.name in rest
        bodies[joint.child] = joint.child if moves else bodies[joint.parent]
        if moves:
            names[joint.child] = unique(_identifier(joint.child), names.values())
    return RestPose(frames, rest, bodies, names)


def _rest(urdf: Urdf, model: ModelData) -> dict[str, float]:
    """Return the start position of each joint with a range."""
    moving = urdf.moving
    if model.init_qpos and len(model.init_qpos) != len(moving):
        named = ", ".join(joint.name for joint in moving)
        raise mismatch(
            model.file.path, "init_qpos", f"got {len(model.init_qpos)} numbers; expected one for each joint: {named}"
        )
    rest = {}
    for joint, start in zip(moving, model.init_qpos or [0.0] * len(moving), strict=True):
        lower, upper = _limits(urdf, joint, model)
        if upper - lower < 1e-9:
            model.file.report(f"{urdf.path}: field joint {joint.name}.limit: no range, the part does not move")
            continue
        if not lower - 1e-6 <= start <= upper + 1e-6:
            model.file.warn(
                "init_qpos", f"{start:g} for {joint.name}; expected {lower:g} … {upper:g}: taken to that range"
            )
        rest[joint.name] = float(np.clip(start, lower, upper))
    return rest


def _limits(urdf: Urdf, joint: UrdfJoint, model: ModelData) -> tuple[float, float]:
    """The range of a joint, in metres or radians."""
    if joint.kind == "continuous":
        return -np.pi, np.pi
    if joint.lower is None or joint.upper is None or joint.lower > joint.upper:
        text = f"got lower {joint.lower}, upper {joint.upper}; expected both, lower <= upper"
        raise mismatch(urdf.path, f"joint {joint.name}.limit", text)
    factor = float(model.scale[0]) if joint.kind == "prismatic" else 1.0
    return joint.lower * factor, joint.upper * factor


def _motion(joint: UrdfJoint, rest: dict[str, float]) -> np.ndarray:
    matrix, value = np.eye(4), rest.get(joint.name, 0.0)
    if joint.kind == "prismatic":
        matrix[:3, 3] = joint.axis * value
    else:
        matrix[:3, :3] = Rotation.from_rotvec(joint.axis * value).as_matrix()
    return matrix


def _scaled(matrix: np.ndarray, scale: float) -> np.ndarray:
    out = matrix.copy()
    out[:3, 3] *= scale
    return out


def _identifier(name: str) -> str:
    return re.sub(r"[^a-z0-9_-]", "_", name.lower()).lstrip("_-")[:70] or "part"


# --- bodies ------------------------------------------------------------------------------------------------


def _built(urdf: Urdf, model: ModelData, pose: RestPose) -> BuiltObject:
    parts, hulls = _geometry(urdf, urdf.root, model, pose)
    moving = [_moving(urdf, joint, model, pose) for joint in urdf.moving if joint.name in pose.rest]
    return BuiltObject(parts, hulls, _mass(urdf.root, hulls, model, pose), moving=moving)


def _moving(urdf: Urdf, joint: UrdfJoint, model: ModelData, pose: RestPose) -> MovingPart:
    parts, hulls = _geometry(urdf, joint.child, model, pose)
    name, parent = pose.names[joint.child], pose.names.get(pose.bodies[joint.parent])
    mass = _mass(joint.child, hulls, model, pose)
    return MovingPart(name, parts, hulls, mass, _our_joint(urdf, joint, model, pose), parent)


def _our_joint(urdf: Urdf, joint: UrdfJoint, model: ModelData, pose: RestPose) -> Joint:
    frame, rest = pose.frames[joint.child], pose.rest[joint.name]
    lower, upper = _limits(urdf, joint, model)
    kind = "slide" if joint.kind == "prismatic" else "turn"
    if joint.kind == "continuous":
        model.file.report(f"{urdf.path}: field joint {joint.name}: turns without end; half a turn each way is kept")
    axis = frame[:3, :3] @ joint.axis
    return Joint(
        kind=kind,
        origin=tuple(float(x) for x in frame[:3, 3]),
        axis=tuple(float(x) for x in (axis / np.linalg.norm(axis)).round(9)),
        lower=round(lower - rest, 9),
        upper=round(upper - rest, 9),
        damping=joint.damping if joint.damping and joint.damping > 0 else DAMPING[kind],
        friction=joint.friction if joint.friction and joint.friction > 0 else FRICTION[kind],
    )


def _mass(lead: str, hulls: Sequence[trimesh.Trimesh], model: ModelData, pose: RestPose) -> float:
    if not model.mass:
        return estimated_mass(total_volume(hulls))
    return sum(model.mass.get(link, LINK_MASS) for link, body in pose.bodies.items() if body == lead)


def _geometry(urdf: Urdf, lead: str, model: ModelData, pose: RestPose) -> tuple[list[Part], list[trimesh.Trimesh]]:
    """Return the visible parts and the hulls of the body that a link leads."""
    parts, hulls = [], []
    for link in (link for link, body in pose.bodies.items() if body == lead):
        for shape in urdf.visuals[link]:
            parts += parts_of(shape.surfaces(), *_map(shape, model, pose.frames[link]))
        for shape in urdf.collisions[link]:
            linear, shift = _map(shape, model, pose.frames[link])
            vertices, faces = joined(shape.surfaces())
            hulls += component_hulls(vertices @ linear.T + shift, faces)
    if not hulls and parts:
        model.file.report(f"{urdf.path}: field link {lead}.collision: missing; it is made from the visible mesh")
        hulls = hulls_of_surface(*trimesh.util.append_faces([p.vertices for p in parts], [p.faces for p in parts]))
    if not hulls:
        raise mismatch(urdf.path, f"link {lead}", "no solid part; expected a visual or collision mesh")
    if not parts:
        model.file.report(f"{urdf.path}: field link {lead}.visual: missing; the collision shape is shown")
        parts = parts_of(hulls, np.eye(3), np.zeros(3))
    return parts, hulls


def _map(shape: Shape, model: ModelData, frame: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(3, 3) and (3,) that bring a shape's own coordinates into our orientation, in metres."""
    scale = float(model.scale[0])
    matrix = frame @ _scaled(shape.origin, scale)
    return matrix[:3, :3] * (shape.scale * scale), matrix[:3, 3]
