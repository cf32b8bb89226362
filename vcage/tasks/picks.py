"""Picks: the ways of an arm to take an object where it stands, with the room that the hand needs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.memory import remembered
from vcage.schema.robot import Gripper, Robot
from vcage.schema.subtasks import Check
from vcage.sim.kinematics import ArmKinematics
from vcage.tasks.findings import hand_check, reach_check
from vcage.tasks.grasps import GraspPose, approach_opening, grasp_poses, hand_boxes
from vcage.tasks.primitives.pick import lift_heights, reached_lift
from vcage.tasks.scene_objects import REMEMBERED, SceneObject, SolidBox, first_met
from vcage.tasks.state import resting_point


@dataclass(frozen=True)
class Pick:
    """A grasp, its checks, and the joints on the way to it and up again; None when it cannot be done."""

    grasp: GraspPose
    checks: list[Check]
    path: list[np.ndarray] | None


@remembered(REMEMBERED)
def picks(
    target: SceneObject,
    contact_id: int,
    others: tuple[SceneObject, ...],
    arm: str,
    kinematics: ArmKinematics,
    table_height: float,
) -> list[Pick]:
    """The ways of an arm to take an object by a contact point, the straightest first, wherever it then goes; those come
    last with which the arm does not lift it above all others."""
    gripper = kinematics.arm.gripper
    heights = lift_heights(target, others, table_height)
    where = f"{target.asset.annotation.contact_point(contact_id).name!r} of {target.record.phrase}"
    found: dict[float, list[Pick]] = {height: [] for height in heights}
    for grasp, blocked in _hands(target, contact_id, others, gripper):
        checks, height, path = [hand_check("around", where, blocked)], heights[0], None
        if blocked is None:
            height, path = reached_lift(kinematics, target, grasp, heights)
            checks.append(reach_check("reach_grasp", where, path is not None, arm))
        found[height].append(Pick(grasp, checks, path))
    return [pick for some in found.values() for pick in some]


def hand_has_room(target: SceneObject, others: Sequence[SceneObject], robot: Robot) -> bool:
    """True if some hand gets to an object by some contact point without touching another; arms are not examined."""
    grippers = {arm.gripper.model_dump_json(): arm.gripper for arm in robot.arms.values()}
    return any(
        met is None
        for contact in target.asset.annotation.carrying_points
        for gripper in grippers.values()
        for _, met in _hands(target, contact.id, tuple(others), gripper)
    )


@remembered(REMEMBERED)
def _hands(
    target: SceneObject, contact_id: int, others: tuple[SceneObject, ...], gripper: Gripper
) -> list[tuple[GraspPose, str | None]]:
    """The poses of a hand at a contact point, whichever arm has it, each with the phrase of the object in its way."""
    contact = target.asset.annotation.contact_point(contact_id)
    width = target.asset.grasp_width(contact)
    poses = grasp_poses(target.pose, contact, gripper, target.box.bottom)
    opening = approach_opening(width, gripper)
    holder = next((o for o in others if o.id == target.record.container), None)
    beside = [o for o in others if o is not holder]
    walls = [] if holder is None else _walls_around(target, holder)
    found = []
    for grasp in poses:
        hand = [SolidBox(part, grasp.pose) for part in hand_boxes(gripper, opening, min(width, opening))]
        met = holder if any(part.overlaps(wall) for part in hand for wall in walls) else first_met(hand, beside)
        found.append((grasp, None if met is None else met.record.phrase))
    return found


def _walls_around(thing: SceneObject, holder: SceneObject) -> list[SolidBox]:
    """Boxes of a receptacle that may be in the way of a hand that takes an object out of it or off it."""
    where = resting_point(thing, holder)
    return holder.boxes if where is None else holder.around(where.id)
