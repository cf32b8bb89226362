"""Presses and grasps as a camera on the hand sees them, from the robot's file alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Pose, box_corners
from vcage.models.protocols import HandView
from vcage.schema.goals import Goal
from vcage.schema.robot import Gripper, Robot, RobotCamera
from vcage.sim.cameras import placed
from vcage.sim.drawer import Drawing
from vcage.sim.fingers import finger_drawings
from vcage.sim.joints import joint_positions
from vcage.sim.kinematics import kinematics_of
from vcage.tasks.grasps import TILTS, hand_boxes
from vcage.tasks.hand_poses import hand_poses
from vcage.tasks.holds_with_both import SETTINGS as WITH_BOTH
from vcage.tasks.holds_with_both import ends_for_both
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
    on_hand = _OnHand.of(robot, camera)
    contact = next((c for c in thing.asset.annotation.contact_points if c.link == part and c.use == "press"), None)
    if on_hand is None or contact is None:
        return
    gripper, model = on_hand.gripper, thing.asset.model
    handle = Handle(contact, model, thing.pose, joint_positions(model, thing.joints), thing.asset.grasp_width(contact))
    for way in operating_ways(handle, handle.link.joint.far_end, gripper, thing.box.bottom):
        yield on_hand.view(way.motion[way.pushed - 1], opening=0.0)


def grasp_views(thing: SceneObject, robot: Robot, camera: str, with_both: bool = False) -> Iterator[HandView]:
    """A camera on a hand that holds an object, for each way in which its fingers may close on it, within reach or not.

    None where the camera is fixed to no hand.

    Args:
        thing: what is held, at any pose.
        robot: that holds it.
        camera: name in the robot's file.
        with_both: True where the other hand holds it, too.
    """
    on_hand = _OnHand.of(robot, camera)
    if on_hand is None:
        return
    places, tilts = thing.asset.annotation.carrying_points, TILTS
    if with_both:
        places, tilts = ends_for_both(thing, on_hand.gripper), WITH_BOTH.tilts_rad
    for place in places:
        opening = min(thing.asset.grasp_width(place), on_hand.gripper.max_width)
        for grasp in hand_poses(thing, place, on_hand.gripper, tilts):
            yield on_hand.view(grasp.pose, opening)


def finger_views(robot: Robot, camera: str) -> tuple[Drawing, ...]:
    """The fingers of the hand that carries a camera, from closed to wide open, see
    :func:`~vcage.sim.fingers.finger_drawings`; none where the camera is fixed to no hand."""
    on_hand = _OnHand.of(robot, camera)
    return () if on_hand is None else finger_drawings(robot, str(on_hand.camera.arm), camera)


@dataclass(frozen=True)
class HandCameras:
    """The cameras on the hands of a robot, and what they see of the objects of a scene.

    Args:
        robot: whose hands they are.
        objects: by id.
        goals: that tell which of them two hands hold.
    """

    robot: Robot
    objects: Mapping[str, SceneObject]
    goals: Sequence[Goal]

    def presses(self, thing: str, at: Pose, part: str, camera: str) -> Iterator[HandView]:
        """See :func:`press_views`; of an object at a pose."""
        return press_views(self.objects[thing].moved(at), part, self.robot, camera)

    def grasps(self, thing: str, at: Pose, camera: str) -> Iterator[HandView]:
        """See :func:`grasp_views`; of an object at a pose."""
        with_both = any(goal.subject == thing and goal.kind.arms == 2 for goal in self.goals)
        return grasp_views(self.objects[thing].moved(at), self.robot, camera, with_both)

    def fingers(self, camera: str) -> tuple[Drawing, ...]:
        """See :func:`finger_views`."""
        return finger_views(self.robot, camera)


@dataclass(frozen=True)
class _OnHand:
    """A camera that a hand carries.

    Args:
        camera: of the robot's file.
        gripper: of the hand.
        carrier: of the camera, in the gripper frame.
    """

    camera: RobotCamera
    gripper: Gripper
    carrier: Pose

    @classmethod
    def of(cls, robot: Robot, name: str) -> _OnHand | None:
        """A camera by its name; None where no hand carries it."""
        sees = robot.cameras.get(name)
        if sees is None or sees.arm is None or sees.link is None:
            return None
        arm = kinematics_of(robot.arms[sees.arm])
        carrier = arm.on_hand(sees.link)
        return None if carrier is None else cls(sees, arm.arm.gripper, carrier)

    def view(self, hand: Pose, opening: float) -> HandView:
        """The view with the hand at a pose of its gripper frame, its fingers ``opening`` metres apart."""
        fingers = np.array([box_corners(*box) for box in hand_boxes(self.gripper, opening)[:2]])
        return HandView(placed(self.camera, carrier=hand * self.carrier), hand.apply(fingers.reshape(-1, 3)), hand)
