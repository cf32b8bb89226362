"""Objects as SAPIEN entities: convex hulls with friction and mass, and a textured mesh when rendering."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from vcage.base.errors import DamagedFile
from vcage.base.geometry import Pose
from vcage.schema.asset import MovingLink, PhysicalModel

if TYPE_CHECKING:
    import sapien


@dataclass(frozen=True)
class Body:
    """An object and where it stands.

    Args:
        model: its geometry and physics.
        pose: object frame in the world.
        joints: position of each of ``model.links``, metres or radians; all at 0 when empty.
    """

    model: PhysicalModel
    pose: Pose = field(default_factory=Pose)
    joints: tuple[float, ...] = ()


def build_rigid(name: str, model: PhysicalModel, render: bool) -> sapien.Entity:
    """A movable entity named ``name``, not yet in a scene.

    Raises:
        DamagedFile: a mesh of the model cannot be loaded.
    """
    from sapien import physx

    component = physx.PhysxRigidDynamicComponent()
    return _entity(name, component, model, model.friction, render)


def build_links(name: str, model: PhysicalModel, render: bool) -> dict[str | None, sapien.Entity]:
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
    entities = {None: _entity(name, root, model, model.friction, render)}
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
    frame = sapien.Pose(p=record.origin, q=sapien.math.shortest_rotation([1, 0, 0], record.axis))
    joint.pose_in_parent = frame
    joint.pose_in_child = frame
    joint.limit = [record.lower, record.upper]
    # PhysX's joint friction lets a lid creep shut whatever its coefficient; a damper of limited force holds it.
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
        visual = sapien.render.RenderBodyComponent()
        visual.attach(_load(sapien.render.RenderShapeTriangleMesh, part.visual))
        entity.add_component(visual)
    return entity


def _make_solid(
    component: sapien.physx.PhysxRigidBodyComponent, hulls: Sequence[str], mass: float, friction: float
) -> None:
    from sapien import physx

    material = physx.PhysxMaterial(friction, friction, 0.0)
    for path in hulls:
        shape = _load(physx.PhysxCollisionShapeConvexMesh, path, scale=[1, 1, 1], material=material)
        component.attach(shape)
    # PhysX computed mass and inertia at its default density: scale both to the mass that the model gives.
    scale = mass / component.mass
    inertia, centre = component.inertia, component.cmass_local_pose
    component.set_mass(mass)
    component.set_inertia(inertia * scale)
    component.set_cmass_local_pose(centre)


def _load(kind: type, path: str, **options: object) -> object:
    try:
        return kind(filename=path, **options)
    except RuntimeError as error:
        hint = "delete the folder it lies in; it is made again on demand, an imported object by importing it again"
        raise DamagedFile(f"{path} is not a mesh that SAPIEN can load: {error}", hint=hint) from error
