"""Presses as a camera on the pressing hand sees them, from the robot's file alone."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vcage.base.geometry import box_corners
from vcage.models.protocols import HandView
from vcage.schema.robot import Robot
from vcage.sim.cameras import placed
from vcage.sim.joints import joint_positions
from vcage.sim.kinematics import kinematics_of
from vcage.tasks.grasps import hand_boxes
from vcage.tasks.primitives.handles import Handle, operating_ways
from vcage.tasks.scene_objects import SceneObject


def press_views(thing: SceneObject, part: str, robot: Robot, camera: str) -> Iterator[HandView]:
    """A camera on a hand at the end of a press, for each way in which the hand may come, within reach or not.

    None where the camera is fixed to no hand, or where nothing presses the part.

    Args:
        thing: whose part is pressed, where it stands.
        part: name of its link.
        robot: that presses it.
        camera: name in the robot's file.
    """
    sees = robot.cameras.get(camera)
    contact = next((c for c in thing.asset.annotation.contact_points if c.link == part and c.use == "press"), None)
    if sees is None or sees.arm is None or sees.link is None or contact is None:
        return
    arm, model = kinematics_of(robot.arms[sees.arm]), thing.asset.model
    carrier, gripper = arm.on_hand(sees.link), arm.arm.gripper
    if carrier is None:
        return
    handle = Handle(contact, model, thing.pose, joint_positions(model, thing.joints), thing.asset.grasp_width(contact))
    fingers = np.concatenate([box_corners(*box) for box in hand_boxes(gripper, 0.0)[:2]])
    for way in operating_ways(handle, handle.link.joint.far_end, gripper, thing.box.bottom):
        hand = way.motion[way.pushed - 1]
        yield HandView(placed(sees, carrier=hand * carrier), hand.apply(fingers))
