"""Convex collision shapes for planning: the shapes of physics as FCL geometry."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vcage.schema.asset import PhysicalModel
from vcage.sim.joints import link_poses
from vcage.sim.poses import to_sapien

if TYPE_CHECKING:
    import sapien
    from mplib.pymp.collision_detection import fcl


@dataclass(frozen=True)
class ConvexShape:
    """A convex solid in the frame of its body.

    Args:
        geometry: FCL collision geometry.
        local: the shape's frame in the body's frame.
        centre, radius: a sphere around it, in the shape's frame, metres.
    """

    geometry: fcl.CollisionGeometry
    local: sapien.Pose
    centre: np.ndarray
    radius: float

    def placed(self, frame: sapien.Pose) -> fcl.CollisionObject:
        """The solid for FCL with the shape's frame at ``frame``."""
        return _collision_object()(self.geometry, frame.p.astype(float), frame.q.astype(float))


@functools.cache
def _collision_object() -> type[fcl.CollisionObject]:
    """FCL's class, looked up once: an import in every call would cost half as much as the object."""
    from mplib.pymp.collision_detection import fcl

    return fcl.CollisionObject


def box_shape(size: Iterable[float]) -> ConvexShape:
    """A box of that size (x, y, z) around the origin."""
    import sapien
    from mplib.pymp.collision_detection import fcl

    size = np.asarray(list(size), dtype=np.float64)
    return ConvexShape(fcl.Box(*size), sapien.Pose(), np.zeros(3), float(np.linalg.norm(size) / 2))


def physics_shape(shape: sapien.physx.PhysxCollisionShape) -> ConvexShape:
    """A SAPIEN box, cylinder, capsule, sphere or convex mesh.

    Raises:
        ValueError: the shape is of another kind.
    """
    import sapien
    from mplib.pymp.collision_detection import fcl
    from sapien import physx

    if isinstance(shape, physx.PhysxCollisionShapeBox):
        box = box_shape(2 * np.asarray(shape.half_size))
        return ConvexShape(box.geometry, shape.local_pose, box.centre, box.radius)
    if isinstance(shape, physx.PhysxCollisionShapeSphere):
        return ConvexShape(fcl.Sphere(shape.radius), shape.local_pose, np.zeros(3), shape.radius)
    if isinstance(shape, physx.PhysxCollisionShapeCylinder | physx.PhysxCollisionShapeCapsule):
        round_ends = isinstance(shape, physx.PhysxCollisionShapeCapsule)
        kind = fcl.Capsule if round_ends else fcl.Cylinder
        reach = shape.half_length + shape.radius if round_ends else float(np.hypot(shape.half_length, shape.radius))
        # SAPIEN's lie along x, FCL's along z.
        turned = shape.local_pose * sapien.Pose(q=[np.sqrt(0.5), 0, np.sqrt(0.5), 0])
        return ConvexShape(kind(shape.radius, 2 * shape.half_length), turned, np.zeros(3), reach)
    if not isinstance(shape, physx.PhysxCollisionShapeConvexMesh):
        raise ValueError(f"cannot plan around a {type(shape).__name__}")
    vertices = np.asarray(shape.vertices, dtype=np.float64) * shape.scale
    geometry = fcl.Convex(vertices, np.asarray(shape.triangles, dtype=np.int32))
    centre = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    return ConvexShape(geometry, shape.local_pose, centre, float(np.linalg.norm(vertices - centre, axis=1).max()))


def model_shapes(
    model: PhysicalModel, joints: Sequence[float] = ()
) -> list[tuple[str | None, ConvexShape, sapien.Pose]]:
    """(part, shape, pose) of each hull of an object: the part's name (None for the body) and pose in the object frame.

    Args:
        joints: position of each of ``model.links``; all 0 when empty.
    """
    poses = {name: to_sapien(pose) for name, pose in link_poses(model, joints).items()}
    hulls = {None: model.hulls, **{link.name: link.hulls for link in model.links}}
    return [(part, _hull(path), poses[part]) for part, paths in hulls.items() for path in paths]


@functools.lru_cache(maxsize=1024)
def _hull(path: str) -> ConvexShape:
    from sapien import physx

    return physics_shape(physx.PhysxCollisionShapeConvexMesh(path, [1, 1, 1], physx.get_default_material()))
