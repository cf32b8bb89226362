"""A single object before the robot: what the checks by use simulate."""

from __future__ import annotations

from vcage.apps.proof.places import Places
from vcage.base.geometry import Pose
from vcage.objects.asset import Asset
from vcage.schema.base import PoseRecord, box_record
from vcage.schema.scene import ObjectRecord, Role
from vcage.sim.bodies import Body
from vcage.sim.world import World
from vcage.tasks.scene_objects import SceneObject

OBJECT = "object"
"""Id of the object that is tried."""


def scene_object(asset: Asset, pose: Pose, object_id: str = OBJECT, role: Role = "content") -> SceneObject:
    """An asset as the planner sees it."""
    record = ObjectRecord(
        id=object_id,
        asset=asset.name,
        variant=asset.variant.id,
        phrase=asset.annotation.words.name,
        role=role,
        pose=PoseRecord.of(pose),
        aabb=box_record(asset.bounds, pose),
    )
    return SceneObject(record, asset, pose)


def world_with(asset: Asset, pose: Pose, places: Places) -> World:
    """The table with the robot and the asset, for physics only."""
    return World(places.template.table, {OBJECT: Body(asset.model, pose)}, places.robot)
