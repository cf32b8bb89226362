"""Objects as SAPIEN entities: convex hulls with friction and mass, and a textured mesh when rendering."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from vcage.errors import DamagedFile
from vcage.geometry import Pose
from vcage.schema.asset import PhysicalModel
from vcage.sim.poses import to_sapien

if TYPE_CHECKING:
    import sapien


@dataclass(frozen=True)
class Body:
    """An object and where it stands.

    Args:
        model: its geometry and physics.
        pose: object frame in the world.
    """

    model: PhysicalModel
    pose: Pose = field(default_factory=Pose)


def build_body(name: str, body: Body, render: bool) -> sapien.Entity:
    """A movable entity named ``name``, not yet in a scene.

    Raises:
        DamagedFile: a mesh of the model cannot be loaded.
    """
    import sapien

    entity = sapien.Entity()
    entity.name = name
    entity.add_component(_physics(body.model))
    if render:
        visual = sapien.render.RenderBodyComponent()
        visual.attach(_load(sapien.render.RenderShapeTriangleMesh, body.model.visual))
        entity.add_component(visual)
    entity.pose = to_sapien(body.pose)
    return entity


def _physics(model: PhysicalModel) -> sapien.physx.PhysxRigidDynamicComponent:
    from sapien import physx

    material = physx.PhysxMaterial(model.friction, model.friction, 0.0)
    component = physx.PhysxRigidDynamicComponent()
    for path in model.hulls:
        shape = _load(physx.PhysxCollisionShapeConvexMesh, path, scale=[1, 1, 1], material=material)
        component.attach(shape)
    # PhysX computed mass and inertia at its default density: scale both to the mass that the model gives.
    scale = model.mass / component.mass
    inertia, centre = component.inertia, component.cmass_local_pose
    component.set_mass(model.mass)
    component.set_inertia(inertia * scale)
    component.set_cmass_local_pose(centre)
    return component


def _load(kind: type, path: str, **options: object) -> object:
    try:
        return kind(filename=path, **options)
    except RuntimeError as error:
        hint = "delete the asset cache and build the assets again: vcage assets build --force"
        raise DamagedFile(f"{path} is not a mesh that SAPIEN can load: {error}", hint=hint) from error
