"""Check 3: at each contact point the robot grasps the object, lifts it, holds it, and shakes it without losing it."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from vcage.apps.proof.approach import blocked_parts
from vcage.apps.proof.places import LIFT, Places
from vcage.apps.proof.scene import OBJECT, scene_object, world_with
from vcage.apps.proof.tally import Tally
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.objects.asset import Asset
from vcage.schema.asset import ContactPoint
from vcage.schema.proof import Check
from vcage.sim.collision import CollisionScene, Held
from vcage.sim.motion import Load, MotionFailed, MotionPlanner
from vcage.sim.trajectory import timed
from vcage.sim.world import PHYSICS_HZ, World
from vcage.tasks.feasibility import GRIP_ROOM
from vcage.tasks.task import Task
from vcage.tasks.workcell import TaskFailed

HOLD_STEPS = PHYSICS_HZ
"""How long it is held still, physics steps."""

SHAKE = np.array([0.06, 0.05, 0.06, 0.05, 0.1, 0.05, 0.2])
"""How far each joint of a seven-joint arm is shaken to and fro at full speed, rad: 3 to 4 cm at the hand."""

SHAKES = 2
"""How often."""

SLIP = 0.02
"""The place that is grasped may move in the hand by so much, metres; the object may swing about it."""


def check_contact(asset: Asset, contact: ContactPoint, places: Places, tries: int, seed: int) -> Check:
    """Try one contact point of the body at random places of the table."""
    rng = np.random.default_rng([seed, contact.id])
    subject = f"{contact.id} {contact.name}"
    width = asset.grasp_width(contact)
    limit = max(arm.gripper.max_width for arm in places.robot.arms.values()) - GRIP_ROOM
    measured = {"width_mm": round(1000 * width, 2)}
    reason = blocked_parts(asset, contact, next(iter(places.robot.arms.values())).gripper)
    if not 0 < width <= limit:
        reason = f"the material is {100 * width:.1f} cm wide, expected more than 0 and at most {100 * limit:.1f} cm"
    if reason is not None:
        return Check(check="contact_point", subject=subject, passed=False, tries=0, measured=measured, reasons=[reason])
    tally = Tally(tries)
    for _ in range(tries):
        try:
            tally.add(_try(asset, contact, places.for_carrying(asset, contact, rng), places))
        except InfeasibleScene as error:
            tally.add(error.message)
    return tally.check("contact_point", subject, measured)


def _try(asset: Asset, contact: ContactPoint, pose: Pose, places: Places) -> str | None:
    """Why no arm can hold the object there, or None when one held it to the end.

    The far arm is tried only where the near one finds no way; a grasp that fails is a failure.
    """
    arms = places.robot.arms
    reason = "the robot has no arm"
    for arm in sorted(arms, key=lambda name: abs(arms[name].base.position[0] - pose.p[0])):
        world = world_with(asset, pose, places)
        world.settle()
        try:
            Task(world, {OBJECT: scene_object(asset, pose)}, {}).pick(OBJECT, [(contact.id, arm)])
            return _Shaking(world, arm, asset, contact).run(pose.p[2])
        except MotionFailed as error:
            reason = error.message
        except TaskFailed as error:
            reason = error.message
            if error.stage != "plan":
                break
    return reason


@dataclass
class _Shaking:
    """Lift, hold and shake what an arm has grasped."""

    world: World
    arm: str
    asset: Asset
    contact: ContactPoint

    def run(self, support: float) -> str | None:
        """Why the object was lost, or None.

        Raises:
            MotionFailed: the arm cannot lift so high.
        """
        start = self._grasped()
        self._lift(support + LIFT - self.world.object_pose(OBJECT).p[2])
        self.world.step(HOLD_STEPS)
        if self._lost(start):
            return "lost while it was lifted and held"
        self._shake()
        return "lost while it was shaken" if self._lost(start) else None

    def _lift(self, rise: float) -> None:
        control = self.world.arms[self.arm]
        planner = MotionPlanner(CollisionScene.of_world(self.world, self.arm))
        held = Held(OBJECT, self.asset.model, self._in_hand())
        here = planner.kinematics.fk(control.command[:-1])
        load = Load(opening=control.opening, held=held, ignore=("table",))
        control.move(planner.move(control.command[:-1], Pose(here.p + [0, 0, max(rise, 0.0)], here.q), load))

    def _shake(self) -> None:
        """To and fro in joint space, where no arm meets the end of its reach."""
        control = self.world.arms[self.arm]
        middle = control.command[:-1]
        kinematics = CollisionScene.of_world(self.world, self.arm).kinematics
        swing = np.resize(SHAKE, len(middle))
        ends = [np.clip(middle + sign * swing, kinematics.lower, kinematics.upper) for sign in (1, -1)]
        points = [middle, *(ends * SHAKES), middle]
        for here, there in itertools.pairwise(points):
            control.move(timed(np.stack([here, there]), PHYSICS_HZ, control.arm))

    def _in_hand(self) -> Pose:
        return self.world.arms[self.arm].tool_pose.inverse() * self.world.object_pose(OBJECT)

    def _grasped(self) -> np.ndarray:
        """(3,) the place on the object that was grasped, in the hand's frame."""
        return self._in_hand().apply(self.contact.position)

    def _lost(self, start: np.ndarray) -> bool:
        slipped = float(np.linalg.norm(self._grasped() - start))
        return not self.world.holds(self.arm, OBJECT) or slipped > SLIP
