"""Objects in a SAPIEN scene, rigid or with moving parts, behind one interface.

A part is a SAPIEN entity: convex hulls with friction and mass, and a textured mesh when rendering.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from vcage.base.errors import DamagedFile
from vcage.base.geometry import Pose
from vcage.schema.asset import MovingLink, PhysicalModel
from vcage.sim.joints import joint_positions
from vcage.sim.poses import from_sapien, to_sapien
from vcage.sim.render import SEEN, unseen_material

if TYPE_CHECKING:
    import sapien

Loaded = TypeVar("Loaded")

REST_SPEED, REST_SPIN = 0.005, 0.05
"""A slower part is at rest: m/s, rad/s."""

SHADOW_SAVING = 3
"""Hulls throw the shadow of a mesh with more than this many times their triangles; hulls share no vertices."""


@dataclass(frozen=True)
class Body:
    """An object and its pose.

    Args:
        model: its geometry and physics.
        pose: object frame in the world.
        joints: position of each of ``model.links``, metres or radians; all at 0 when empty.
    """

    model: PhysicalModel
    pose: Pose = field(default_factory=Pose)
    joints: tuple[float, ...] = ()


class RigidObject:
    """An object without moving parts.

    Attributes:
        entities: SAPIEN entity of each part by name; the body's name is None.
    """

    def __init__(self, scene: sapien.Scene, name: str, body: Body, render: bool):
        import sapien

        self._physics = sapien.physx.PhysxRigidDynamicComponent()
        entity = _entity(name, self._physics, body.model, body.model.friction, render)
        entity.pose = to_sapien(body.pose)
        scene.add_entity(entity)
        self.entities: dict[str | None, sapien.Entity] = {None: entity}

    @property
    def pose(self) -> Pose:
        """Object frame in the world."""
        return from_sapien(self.entities[None].pose)

    @property
    def joints(self) -> np.ndarray:
        """(0,) no joints."""
        return np.zeros(0)

    def set_pose(self, pose: Pose) -> None:
        """Move it to a pose; its velocity stays."""
        self.entities[None].set_pose(to_sapien(pose))

    def set_joints(self, joints: Sequence[float] | np.ndarray) -> None:
        """Accept an empty sequence only."""
        if len(joints):
            raise ValueError(f"expected 0 joint positions, got {len(joints)}")

    def stop(self) -> None:
        """Set its velocity to zero."""
        still = np.zeros(3, dtype=np.float32)
        self._physics.set_linear_velocity(still)
        self._physics.set_angular_velocity(still)

    def at_rest(self) -> bool:
        """True if it moves slower than :data:`REST_SPEED` and :data:`REST_SPIN`."""
        return _slow(self._physics)


class ArticulatedObject:
    """An object with moving parts; its body moves freely.

    Attributes:
        entities: SAPIEN entity of each part by name; the body's name is None.
    """

    def __init__(self, scene: sapien.Scene, name: str, body: Body, render: bool):
        import sapien

        self._model = body.model
        self.entities: dict[str | None, sapien.Entity] = _build_links(name, body.model, render)
        kind = sapien.physx.PhysxArticulationLinkComponent
        self._links = {part: entity.find_component_by_type(kind) for part, entity in self.entities.items()}
        self._articulation = self._links[None].articulation
        for entity in self.entities.values():
            scene.add_entity(entity)
        # PhysX numbers the joints of an articulation in its own order.
        order = [joint.name for joint in self._articulation.active_joints]
        self._index = np.array([order.index(link.name) for link in body.model.links])
        self.set_pose(body.pose)
        self.set_joints(body.joints)

    @property
    def pose(self) -> Pose:
        """Frame of the body in the world."""
        return from_sapien(self.entities[None].pose)

    @property
    def joints(self) -> np.ndarray:
        """(n,) position of each of the model's links, metres or radians."""
        return self._articulation.get_qpos()[self._index].astype(np.float64)

    def set_pose(self, pose: Pose) -> None:
        """Move the body to a pose with all its parts; joints and velocities stay."""
        self._articulation.set_root_pose(to_sapien(pose))

    def set_joints(self, joints: Sequence[float] | np.ndarray) -> None:
        """Set the (n,) joint positions; all to 0 when empty."""
        positions = np.zeros(len(self._index))
        positions[self._index] = joint_positions(self._model, joints)
        self._articulation.set_qpos(positions)

    def stop(self) -> None:
        """Set all velocities to zero."""
        still = np.zeros(3, dtype=np.float32)
        self._articulation.set_root_linear_velocity(still)
        self._articulation.set_root_angular_velocity(still)
        self._articulation.set_qvel(np.zeros(len(self._index)))

    def at_rest(self) -> bool:
        """True if every part moves slower than :data:`REST_SPEED` and :data:`REST_SPIN`."""
        return all(_slow(link) for link in self._links.values())


def add_object(scene: sapien.Scene, name: str, body: Body, render: bool) -> RigidObject | ArticulatedObject:
    """Add an object to a scene.

    Args:
        scene: SAPIEN's.
        name: of the entity of its body.
        body: the object and its pose.
        render: make it visible.

    Raises:
        DamagedFile: a mesh cannot be loaded.
    """
    kind = ArticulatedObject if body.model.links else RigidObject
    return kind(scene, name, body, render)


def seen_meshes(models: Iterable[PhysicalModel]) -> set[str]:
    """The files of the visible meshes of objects, moving parts included."""
    return {part.visual for model in models for part in (model, *model.links)}


def _slow(body: sapien.physx.PhysxRigidBodyComponent) -> bool:
    slow = np.linalg.norm(body.linear_velocity) < REST_SPEED
    return bool(slow and np.linalg.norm(body.angular_velocity) < REST_SPIN)


# --- parts as SAPIEN entities ------------------------------------------------------------------------------


def _build_links(name: str, model: PhysicalModel, render: bool) -> dict[str | None, sapien.Entity]:
    """The parts of an articulation whose body moves freely, by name (None for the body), not yet in a scene.

    The frame of every part coincides with the object frame while all joints are at 0. Parts that a joint connects
    directly do not collide with each other.

    Raises:
        DamagedFile: a mesh of the model cannot be loaded.
    """
    from sapien import physx

    root = physx.PhysxArticulationLinkComponent()
    root.name = name
    components: dict[str | None, physx.PhysxArticulationLinkComponent] = {None: root}
    entities: dict[str | None, sapien.Entity] = {None: _entity(name, root, model, model.friction, render)}
    for link in model.links:
        component = physx.PhysxArticulationLinkComponent(components[link.parent])
        component.name = link.name
        _set_joint(component.joint, link)
        components[link.name] = component
        entities[link.name] = _entity(f"{name}/{link.name}", component, link, model.friction, render)
    return entities


def _set_joint(joint: sapien.physx.PhysxArticulationJoint, link: MovingLink) -> None:
    import sapien

    record = link.joint
    joint.name = link.name
    joint.type = "prismatic" if record.kind == "slide" else "revolute"
    # SAPIEN's joints move along or about the x axis of the joint frame; it is the same in both parts at 0.
    x, axis = np.array([1, 0, 0], dtype=np.float32), np.array(record.axis, dtype=np.float32)
    frame = sapien.Pose(p=record.origin, q=sapien.math.shortest_rotation(x, axis))
    joint.pose_in_parent = frame
    joint.pose_in_child = frame
    joint.limit = [record.lower, record.upper]
    # Under PhysX's joint friction a lid creeps shut at any coefficient; a damper of limited force holds it.
    limit = record.friction if record.friction > 0 else float(np.finfo(np.float32).max)
    joint.set_drive_properties(record.spring, record.damping, force_limit=limit, mode="force")
    joint.set_drive_target(0.0)


def _entity(
    name: str,
    component: sapien.physx.PhysxRigidBodyComponent,
    part: PhysicalModel | MovingLink,
    friction: float,
    render: bool,
) -> sapien.Entity:
    import sapien

    entity = sapien.Entity()
    entity.name = name
    _make_solid(component, part.hulls, part.mass, friction)
    entity.add_component(component)
    if render:
        entity.add_component(_visual(part))
    return entity


def _visual(part: PhysicalModel | MovingLink) -> sapien.render.RenderBodyComponent:
    """The visible mesh; the hulls throw the shadow if they have far fewer triangles."""
    import sapien

    mesh = sapien.render.RenderShapeTriangleMesh
    seen = _load(mesh, part.visual)
    hulls = [_load(mesh, path, scale=[1, 1, 1], material=unseen_material()) for path in part.hulls]
    body = sapien.render.RenderBodyComponent()
    body.attach(seen)
    if hulls and SHADOW_SAVING * sum(_triangles(hull) for hull in hulls) < _triangles(seen):
        seen.name = SEEN
        for hull in hulls:
            body.attach(hull)
    return body


def _triangles(shape: sapien.render.RenderShapeTriangleMesh) -> int:
    return sum(len(part.triangles) for part in shape.parts)


def _make_solid(
    component: sapien.physx.PhysxRigidBodyComponent, hulls: Sequence[str], mass: float, friction: float
) -> None:
    from sapien import physx

    material = physx.PhysxMaterial(friction, friction, 0.0)
    for path in hulls:
        shape = _load(physx.PhysxCollisionShapeConvexMesh, path, scale=[1, 1, 1], material=material)
        component.attach(shape)
    # PhysX computed mass and inertia at its default density: scale both to the mass of the model.
    scale = mass / component.mass
    inertia, centre = component.inertia, component.cmass_local_pose
    component.set_mass(mass)
    component.set_inertia(inertia * scale)
    component.set_cmass_local_pose(centre)


def _load(kind: Callable[..., Loaded], path: str, **options: object) -> Loaded:
    try:
        return kind(filename=path, **options)
    except RuntimeError as error:
        hint = "delete its folder; it is made again on demand, an imported object by importing it again"
        raise DamagedFile(f"{path} is not a mesh that SAPIEN can load: {error}", hint=hint) from error
