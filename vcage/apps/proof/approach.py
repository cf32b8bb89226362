"""Whether the open hand comes to a contact point without touching the object that it will grasp."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vcage.base.geometry import Pose
from vcage.objects.asset import Asset
from vcage.schema.asset import ContactPoint
from vcage.schema.robot import Gripper
from vcage.sim.collision import TOLERANCE
from vcage.sim.poses import to_sapien
from vcage.sim.shapes import Shape, box_shape, model_shapes
from vcage.tasks.grasps import approach_opening, grasp_poses, hand_boxes
from vcage.tasks.waypoints import APPROACH

if TYPE_CHECKING:
    import sapien
    from mplib.pymp.collision_detection import fcl

STEP = 0.01
"""Spacing of the hand's poses on its way, metres."""


def blocked_parts(asset: Asset, contact: ContactPoint, gripper: Gripper) -> str | None:
    """What of the hand would touch the object on its straight way to the grasp, or None.

    Fingers and palm are the boxes that the planner of sub-tasks uses (:func:`vcage.tasks.grasps.hand_boxes`).
    """
    from mplib.pymp.collision_detection import fcl

    request = fcl.CollisionRequest(num_max_contacts=1, enable_contact=True)
    solids = [_placed(shape, pose) for _, shape, pose in model_shapes(asset.model)]
    grasp = next(grasp_poses(Pose(), contact, gripper, support=0.0)).pose
    boxes = hand_boxes(gripper, approach_opening(asset.grasp_width(contact), gripper))
    for back in np.arange(0.0, APPROACH + 1e-9, STEP):
        pose = grasp * Pose([0.0, 0.0, -back])
        for name, bounds in zip(("a finger", "a finger", "the palm"), boxes, strict=True):
            part = _placed(box_shape(bounds[1] - bounds[0]), to_sapien(pose * Pose(bounds.mean(axis=0))))
            if any(_overlap(fcl.collide(part, solid, request)) for solid in solids):
                return f"{name} would touch the object {100 * back:.0f} cm before the grasp"
    return None


def _placed(shape: Shape, pose: sapien.Pose) -> fcl.CollisionObject:
    from mplib.pymp.collision_detection import fcl

    placed = pose * shape.local
    return fcl.CollisionObject(shape.geometry, placed.p.astype(float), placed.q.astype(float))


def _overlap(result: fcl.CollisionResult) -> bool:
    return result.is_collision() and abs(result.get_contact(0).penetration_depth) > TOLERANCE
