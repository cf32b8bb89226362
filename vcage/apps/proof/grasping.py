"""Check 3: at each contact point the robot grasps the object, lifts it, holds it, and shakes it without losing it."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from vcage.apps.proof.trials import OBJECT, TrialPlaces, scene_object, tried, world_with
from vcage.apps.proof.trials import SETTINGS as TRIALS
from vcage.base.geometry import Pose
from vcage.objects.asset import Asset
from vcage.schema.asset import ContactPoint
from vcage.schema.proof import ProofCheck
from vcage.schema.robot import Gripper
from vcage.sim.collision import CollisionScene, Held, overlap
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import Load
from vcage.sim.poses import to_sapien
from vcage.sim.shapes import box_shape, model_shapes
from vcage.sim.speed_profile import time_optimal
from vcage.sim.world import PHYSICS_HZ, World
from vcage.tasks.grasps import GRASPING, approach_opening, grasp_poses, hand_boxes
from vcage.tasks.task import Task, TaskFailed


@dataclass(frozen=True)
class ShakeSettings:
    """Settings of check 3.

    Args:
        way_step_m: spacing of the hand's poses on its way to a grasp.
        hold_steps: physics steps for which the object is held still.
        shake_rad: swing of each joint of a seven-joint arm at full speed: 3 to 4 cm at the hand.
        shakes: number of swings to and fro.
        max_slip_m: movement of the grasped place in the hand; the object may swing about it.
    """

    way_step_m: float = 0.01
    hold_steps: int = PHYSICS_HZ
    shake_rad: tuple[float, ...] = (0.06, 0.05, 0.06, 0.05, 0.1, 0.05, 0.2)
    shakes: int = 2
    max_slip_m: float = 0.02


SETTINGS = ShakeSettings()


def check_contact(asset: Asset, contact: ContactPoint, places: TrialPlaces, tries: int, seed: int) -> ProofCheck:
    """Try one contact point of the body at random places of the table.

    Args:
        asset: the tested asset.
        contact: of its body.
        places: table and robot.
        tries: how often.
        seed: of the places.
    """
    rng = np.random.default_rng([seed, contact.id])
    subject = f"{contact.id} {contact.name}"
    width = asset.grasp_width(contact)
    limit = max(arm.gripper.max_width for arm in places.robot.arms.values()) - GRASPING.grip_room_m
    measured = {"width_mm": round(1000 * width, 2)}
    reason = _blocked_part(asset, contact, next(iter(places.robot.arms.values())).gripper)
    if not 0 < width <= limit:
        reason = f"the material is {100 * width:.1f} cm wide, expected more than 0 and at most {100 * limit:.1f} cm"
    if reason is not None:
        return ProofCheck(
            check="contact_point", subject=subject, passed=False, tries=0, measured=measured, reasons=[reason]
        )

    def trial(_number: int) -> str | None:
        return _try(asset, contact, places.for_carrying(asset, contact, rng), places)

    return tried("contact_point", subject, tries, trial, measured)


def _blocked_part(asset: Asset, contact: ContactPoint, gripper: Gripper) -> str | None:
    """Name the part of the hand that would touch the object on its straight way to the grasp, or None.

    Fingers and palm are the boxes that the planner of sub-tasks uses (:func:`vcage.tasks.grasps.hand_boxes`).
    """
    solids = [shape.placed(pose * shape.local) for _, shape, pose in model_shapes(asset.model)]
    grasp = next(grasp_poses(Pose(), contact, gripper, support=0.0)).pose
    boxes = hand_boxes(gripper, approach_opening(asset.grasp_width(contact), gripper))
    for back in np.arange(0.0, gripper.approach + 1e-9, SETTINGS.way_step_m):
        pose = grasp * Pose([0.0, 0.0, -back])
        for name, bounds in zip(("a finger", "a finger", "the palm"), boxes, strict=True):
            part = box_shape(bounds[1] - bounds[0]).placed(to_sapien(pose * Pose(bounds.mean(axis=0))))
            if any(overlap(part, solid) for solid in solids):
                return f"{name} would touch the object {100 * back:.0f} cm before the grasp"
    return None


def _try(asset: Asset, contact: ContactPoint, pose: Pose, places: TrialPlaces) -> str | None:
    """Return the reason for which no arm can hold the object, or None if one held it to the end.

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
    """Lift, hold and shake a grasped object."""

    world: World
    arm: str
    asset: Asset
    contact: ContactPoint

    def run(self, support: float) -> str | None:
        """Return the reason for which the object was lost, or None.

        Raises:
            MotionFailed: the arm cannot lift so high.
        """
        start = self._grasped()
        self._lift(support + TRIALS.lift_m - self.world.object_pose(OBJECT).p[2])
        self.world.step(SETTINGS.hold_steps)
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
        up = Pose(here.p + [0, 0, max(rise, 0.0)], here.q)
        control.move(planner.fastest(planner.move(control.command[:-1], up, load)))

    def _shake(self) -> None:
        """Swing to and fro in joint space, where no arm meets the end of its reach."""
        control = self.world.arms[self.arm]
        middle = control.command[:-1]
        kinematics = CollisionScene.of_world(self.world, self.arm).kinematics
        swing = np.resize(SETTINGS.shake_rad, len(middle))
        ends = [np.clip(middle + sign * swing, kinematics.lower, kinematics.upper) for sign in (1, -1)]
        points = [middle, *(ends * SETTINGS.shakes), middle]
        for here, there in itertools.pairwise(points):
            control.move(time_optimal(np.stack([here, there]), PHYSICS_HZ, control.arm))

    def _in_hand(self) -> Pose:
        return self.world.arms[self.arm].tool_pose.inverse() * self.world.object_pose(OBJECT)

    def _grasped(self) -> np.ndarray:
        """(3,) the place on the object that was grasped, in the hand's frame."""
        return self._in_hand().apply(self.contact.position)

    def _lost(self, start: np.ndarray) -> bool:
        slipped = float(np.linalg.norm(self._grasped() - start))
        return not self.world.holds(self.arm, OBJECT) or slipped > SETTINGS.max_slip_m
