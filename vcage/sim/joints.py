"""Poses of the moving parts of an object at given joint positions, without a simulator."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vcage.base.geometry import Pose
from vcage.schema.asset import Joint, PhysicalModel


def joint_motion(joint: Joint, position: float) -> Pose:
    """Motion of a joint's part from rest to ``position`` (metres or radians), in the frame of the joint."""
    axis, origin = np.asarray(joint.axis), np.asarray(joint.origin)
    if joint.kind == "slide":
        return Pose(position * axis)
    turn = Pose(q=[np.cos(position / 2), *(np.sin(position / 2) * axis)])
    return Pose(origin - turn.apply(origin), turn.q)


def link_poses(model: PhysicalModel, joints: Sequence[float] | np.ndarray = ()) -> dict[str | None, Pose]:
    """Pose of each part in the object frame by name; the body's name is None.

    Geometry of every part is in the object frame with all joints at 0, so all poses are the identity there.

    Args:
        joints: (n,) position of each of ``model.links``, metres or radians; all 0 when empty.

    Raises:
        ValueError: there is another number of joints.
    """
    positions = joint_positions(model, joints)
    poses: dict[str | None, Pose] = {None: Pose()}
    for link, position in zip(model.links, positions, strict=True):
        poses[link.name] = poses[link.parent] * joint_motion(link.joint, float(position))
    return poses


def joint_positions(model: PhysicalModel, joints: Sequence[float] | np.ndarray = ()) -> np.ndarray:
    """(n,) the given positions, or all 0 if there are none.

    Raises:
        ValueError: there is another number of joints.
    """
    if len(joints) not in (0, len(model.links)):
        raise ValueError(f"expected {len(model.links)} joint positions, got {len(joints)}")
    return np.array(joints if len(joints) else np.zeros(len(model.links)), dtype=np.float64)


def joint_index(model: PhysicalModel, link: str) -> int:
    """Index of the joint position that moves the part with this name.

    Raises:
        UnknownName: there is no such part.
    """
    return model.links.index(model.link(link))


def carried_by(model: PhysicalModel, link: str) -> list[str]:
    """The part with this name and all parts that move with it."""
    names = [link]
    for other in model.links:
        if other.parent in names:
            names.append(other.name)
    return names


def part_name(object_id: str, link: str | None) -> str:
    """Name of a part in contacts and obstacles: ``<id>`` for the body, ``<id>/<link>`` for a moving part."""
    return object_id if link is None else f"{object_id}/{link}"


def part_names(object_id: str, model: PhysicalModel) -> list[str]:
    """The names of all parts of an object, its body first."""
    return [part_name(object_id, link) for link in (None, *(x.name for x in model.links))]
