"""From a contact point on a moving part to the gripper's ways of operating it: along a drawer's slide, around a hinge.

A part is operated by a *grasp*, the fingers closing around a handle, or by a *press*, the closed fingers
pushing it. Geometry only: reach and obstacles are for the planner.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from vcage.base.geometry import Pose
from vcage.schema.asset import ContactPoint, MovingLink, PhysicalModel
from vcage.schema.robot import Gripper
from vcage.sim.joints import joint_index, joint_motion, link_poses
from vcage.sim.kinematics import TILTS
from vcage.tasks.grasps import approach_opening, grasp_poses

STEP, STEP_TURN = 0.01, np.radians(4.0)
"""Largest distance between neighbouring poses along a joint's motion: metres, radians."""

FINE_TILTS = tuple(np.radians(degrees) for degrees in (0.0, 10.0, -10.0, 20.0, -20.0, 30.0, -30.0, 40.0, -40.0))
"""Turns about the closing axis for a slide, straight first: the room between an arm and a drawer is narrow."""

ASIDE = tuple(np.radians(degrees) for degrees in (0.0, 20.0, -20.0))
"""Turns of a hand around the bar of a slide, straight first: with six joints, the wrist of an arm that stands beside a
drawer does not turn far enough for the whole of a straight pull."""

TURNS_ALONG = (1.0, 0.7, 0.4, 0.0)
"""Share of a joint's turn that the gripper makes with it; for the rest the handle turns between the fingers."""


@dataclass(frozen=True)
class Handle:
    """A contact point on a moving part of an object that stands somewhere.

    Args:
        contact: its ``link`` is the moving part.
        model: of the object.
        pose: object frame in the world.
        joints: (n,) present position of each of ``model.links``.
        width: material between the fingers there, metres.
    """

    contact: ContactPoint
    model: PhysicalModel
    pose: Pose
    joints: np.ndarray
    width: float

    @property
    def link(self) -> MovingLink:
        """The part that it moves.

        Raises:
            ValueError: the contact point belongs to the body.
        """
        if self.contact.link is None:
            raise ValueError(f"contact point {self.contact.name!r} belongs to no moving part")
        return self.model.link(self.contact.link)

    @property
    def position(self) -> float:
        """Present position of the joint, metres or radians."""
        return float(self.joints[joint_index(self.model, self.link.name)])

    @property
    def on_axis(self) -> bool:
        """True if the axis of the joint runs through the held material, as a knob's: it turns no more than the hand."""
        return _arm(self) < self.width / 2

    def joints_at(self, position: float) -> np.ndarray:
        """(n,) the present joint positions, but this part's is ``position``."""
        joints = np.array(self.joints, dtype=np.float64)
        joints[joint_index(self.model, self.link.name)] = position
        return joints


@dataclass(frozen=True)
class OperatingWay:
    """Gripper poses of an operation, in order.

    Args:
        before: on the way to the handle.
        grasp: at the handle.
        motion: from there along the joint's motion; for a press, there and back again.
        pushed: number of poses of ``motion`` until the joint is at its target.
        after: where the hand is drawn back to.
        opening: of the fingers on the way to the handle and away, metres; 0 for a press.
        turning: True if the handle turns between the fingers.
    """

    before: Pose
    grasp: Pose
    motion: list[Pose]
    pushed: int
    after: Pose
    opening: float
    turning: bool = False


def operating_ways(handle: Handle, target: float, gripper: Gripper, support: float) -> Iterator[OperatingWay]:
    """The ways to bring a joint from where it is to ``target``, the straightest first.

    Every way to hold the handle of a hinge is tried with the gripper turning along, then with the handle turning
    between the fingers more and more, which turns no knob; of a slide, straight and then from aside (:data:`ASIDE`).

    Args:
        target: position of the joint, metres or radians.
        support: z of the object's support, metres.
    """
    turns = handle.link.joint.kind == "turn"
    for share in TURNS_ALONG if turns and not handle.on_axis else (1.0,):
        frames = [held_frame(handle, position, share) for position in _positions(handle, target)]
        for contact in _holds(handle):
            for held in grasp_poses(frames[0], contact, gripper, support, TILTS if turns else FINE_TILTS):
                yield replace(_way(frames, held.in_object, handle, gripper), turning=share < 1)


def _holds(handle: Handle) -> list[ContactPoint]:
    """The contact point, and for a handle on a slide the same with the hand turned around the bar."""
    contact, joint = handle.contact, handle.link.joint
    if contact.use == "press" or joint.kind == "turn":
        return [contact]
    bar = np.cross(contact.closing, joint.axis)
    turns = [Rotation.from_rotvec(angle * bar / np.linalg.norm(bar)) for angle in ASIDE]
    return [
        contact.model_copy(update={name: tuple(turn.apply(getattr(contact, name))) for name in ("approach", "closing")})
        for turn in turns
    ]


def held_frame(handle: Handle, position: float, share: float = 1.0) -> Pose:
    """The frame that the gripper keeps to while the joint is at ``position``, in the world.

    Its contact point is the part's; it is turned only by ``share`` of the joint's turn, so that at 1 it is the
    frame of the part and at 0 keeps the heading that the part has at rest.

    Args:
        handle: that is held.
        position: of the joint, metres or radians.
        share: of the joint's turn, in [0, 1].
    """
    joint = handle.link.joint
    carrier = handle.pose * link_poses(handle.model, handle.joints)[handle.link.parent]
    if joint.kind == "slide":
        return carrier * joint_motion(joint, position)
    point = np.asarray(handle.contact.position)
    turned = Pose(q=joint_motion(joint, share * position).q)
    moved = joint_motion(joint, position).apply(point)
    return carrier * Pose(moved - turned.apply(point), turned.q)


def _way(frames: Sequence[Pose], in_frame: Pose, handle: Handle, gripper: Gripper) -> OperatingWay:
    """The way of a hand that keeps a pose in some frames, there and, of a press, back again."""
    presses = handle.contact.use == "press"
    # The tips, not the frame between them, meet what is pressed.
    held = _drawn_back(in_frame, gripper.tip_depth) if presses else in_frame
    grasp, *there = (frame * held for frame in frames)
    motion = [*there, *there[-2::-1], grasp] if presses else there
    return OperatingWay(
        before=_drawn_back(grasp, gripper.approach),
        grasp=grasp,
        motion=motion,
        pushed=len(there),
        after=_drawn_back(motion[-1], gripper.approach),
        opening=0.0 if presses else approach_opening(handle.width, gripper),
    )


def _positions(handle: Handle, target: float) -> Sequence[float]:
    """Joint positions from the present one to ``target``, at least two."""
    joint, way = handle.link.joint, target - handle.position
    count = abs(way) / STEP if joint.kind == "slide" else max(abs(way) / STEP_TURN, abs(way) * _arm(handle) / STEP)
    return np.linspace(handle.position, target, max(1, int(np.ceil(count))) + 1).tolist()


def _arm(handle: Handle) -> float:
    """Distance of the contact point from the line through the joint's origin along its axis, metres."""
    joint = handle.link.joint
    return float(np.linalg.norm(np.cross(np.asarray(handle.contact.position) - np.asarray(joint.origin), joint.axis)))


def _drawn_back(pose: Pose, distance: float) -> Pose:
    return Pose(pose.p - distance * pose.rotation()[:, 2], pose.q)
