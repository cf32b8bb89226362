"""Grip: an object in a hand, its pose there, and a check that the fingers still hold it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from vcage.base.geometry import box_corners
from vcage.schema.asset import ContactPoint
from vcage.schema.robot import Arm, Gripper
from vcage.sim.collision import Held
from vcage.sim.paths import Load
from vcage.sim.world import World
from vcage.tasks.grasps import command_of
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.workcell import TaskFailed, Workcell


@dataclass(frozen=True)
class CarrySettings:
    """Limits for carried objects.

    Args:
        swing_lever_m: an object that is held farther from its middle than this, seen from above, turns between the
            fingers: bowls and plates, held by their rim, do so by 30 degrees, and by 50 with an apple in them.
        firm_n: least force of each finger for a firm hold: what is held far from its middle then stays level, with
            contents too. Fingers of 10,000 N/m press with 25 N on the rim of a bowl (5 mm) and hold it within 1 degree
            with an apple in it; with 20 N (4 mm) a box with a can in it tips by 22.
        loose_n: force of each finger between which a handle turns: with 70 N the tab of a laptop does not, and the hand
            pushes the laptop over the table.
        sag_share: share of that distance by which it then sags: the sine of 35 degrees.
        hanging_speed: share of the speed limit for carrying a sagging object: faster it slips out of the fingers.
        clearance_m: free height below a carried object, which sways between the fingers.
        every_steps: physics steps between two checks that the fingers still hold the object.
    """

    swing_lever_m: float = 0.03
    firm_n: float = 22.0
    loose_n: float = 7.0
    sag_share: float = 0.6
    hanging_speed: float = 0.4
    clearance_m: float = 0.01
    every_steps: int = 10


SETTINGS = CarrySettings()


@dataclass(frozen=True)
class Grip:
    """An object in a hand, and how it moves with it.

    Args:
        arm: its name.
        object_id: the held object.
        load: its present hold.
        grasped: its hold before lifting, if it has sagged since.
        contents: ids of its contents.
    """

    arm: str
    object_id: str
    load: Load
    grasped: Held | None = None
    contents: frozenset[str] = frozenset()

    @property
    def carrying(self) -> Load:
        """The load on the way, with what must stay free below it."""
        return self.load.above(SETTINGS.clearance_m)

    def hanging(self, held: Held) -> Grip:
        """The same after the lift, where the object has turned between the fingers and is now ``held``."""
        load = replace(self.load, held=held, speed=SETTINGS.hanging_speed)
        return replace(self, load=load, grasped=self.load.held)

    def level(self, held: Held) -> Grip:
        """The same after the lift, where the object has shifted a little between firm fingers and is now ``held``."""
        return replace(self, load=replace(self.load, held=held))


def lever(target: SceneObject, at: np.ndarray, gripper: Gripper, width: float) -> float:
    """Distance of the middle of an object from a point (3,) where it is held, metres; 0 where it hardly turns.

    Args:
        target: the held object.
        at: the point, in the world.
        gripper: that holds it.
        width: of the material between its fingers, metres.
    """
    return 0.0 if holds_firmly(gripper, width) else off_middle(target, at)


def holds_firmly(gripper: Gripper, width: float) -> bool:
    """True if fingers with a drive of their own press firmly on material of a width, metres."""
    return gripper.stiffness is not None and min(gripper.force, gripper.stiffness * width / 2) >= SETTINGS.firm_n


def turning_command(gripper: Gripper, width: float) -> float:
    """The finger command at which a handle can turn between the fingers, 0 closed to 1 open.

    Soft fingers, which have no stiffness of their own, are closed.

    Args:
        gripper: of the arm.
        width: of the handle, metres.
    """
    if gripper.stiffness is None:
        return 0.0
    return max(0.0, command_of(width - 2 * SETTINGS.loose_n / gripper.stiffness, gripper))


def off_middle(target: SceneObject, at: np.ndarray) -> float:
    """Distance of the middle of an object from a point (3,) where it is held, metres; 0 where it is held near it."""
    distance = float(np.linalg.norm((target.aabb.mean(axis=0) - at)[:2]))
    return 0.0 if distance <= SETTINGS.swing_lever_m else distance


def hangs_below(target: SceneObject, at: np.ndarray, gripper: Gripper, width: float) -> float:
    """Depth of the lowest point of an object below where it is held, metres; of one that turns between the fingers,
    when it has turned farthest. Arguments as of :func:`lever`."""
    if not lever(target, at, gripper, width):
        return float(at[2] - target.lowest)
    lower, upper = target.asset.bounds
    corners = target.pose.apply(box_corners(lower, upper))
    return float(np.linalg.norm(corners - at, axis=1).max())


def sag(target: SceneObject, contact: ContactPoint, gripper: Gripper) -> float:
    """Sag of an object lifted at a contact point, metres."""
    at = target.pose.apply([contact.position])[0]
    return SETTINGS.sag_share * lever(target, at, gripper, target.asset.grasp_width(contact))


def stays_level(target: SceneObject, arms: Iterable[Arm]) -> bool:
    """Check if one of some arms holds an object without its turning between the fingers, so that its contents stay in
    it."""
    contacts = target.asset.annotation.carrying_points
    return any(sag(target, contact, arm.gripper) == 0 for arm in arms for contact in contacts)


def feel(cell: Workcell, grip: Grip) -> None:
    """Check that the fingers still hold something.

    Raises:
        TaskFailed: they do not.
    """
    control = cell.world.arms[grip.arm]
    if control.empty:
        height = 100 * (control.tool_pose.p[2] - cell.world.table.height)
        raise TaskFailed("grasp", f"{grip.object_id} slipped out of the fingers {height:.0f} cm above the table")


@contextmanager
def minding(cell: Workcell, grip: Grip) -> Iterator[None]:
    """Check all the time, also during the lift, that the fingers hold something.

    Raises:
        TaskFailed: they lost it; the motion ends there.
    """

    def mind(world: World) -> None:
        if world.steps % SETTINGS.every_steps == 0:
            feel(cell, grip)

    cell.world.before_step.append(mind)
    try:
        yield
    finally:
        cell.world.before_step.remove(mind)
