"""Place: bring what is held over its place, set it down, and draw the hand back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Pose
from vcage.schema.robot import Gripper
from vcage.sim.motion import Load, MotionFailed
from vcage.sim.trajectory import Trajectory
from vcage.tasks.grasps import approach_opening, command_of, hand_boxes
from vcage.tasks.primitives.pick import Grip, feel, transfer_height
from vcage.tasks.scene_objects import SceneObject, SolidBox
from vcage.tasks.workcell import CAREFUL, TaskFailed, Workcell, failing_at, first_reasons

SET_DOWN = 0.004
"""Metres above its support at which an object is let go when nothing is in the way."""

MAX_DROP = 0.075
"""An object may fall this far into a receptacle whose rim keeps the hand out, metres."""

TURNS = (0.0, np.pi)
"""Headings that an object may take in its slot, relative to it: both fill the same rectangle."""


@dataclass(frozen=True)
class PlaceWay:
    """Gripper poses of a place, in order, and how far the object falls when it is let go (metres)."""

    above: Pose
    release: Pose
    after: Pose
    drop: float


@dataclass(frozen=True)
class PlacePlan:
    """A place that the holding arm can do.

    Args:
        grip: what is held.
        receptacle: id of what receives it.
        way: poses of the gripper.
        carry, lower: to the first pose, and from there to where the object is let go.
    """

    grip: Grip
    receptacle: str
    way: PlaceWay
    carry: Trajectory
    lower: Trajectory


def place_way(
    held: Pose, goal: Pose, obstacles: Sequence[SolidBox], gripper: Gripper, width: float, height: float
) -> PlaceWay:
    """From ``height`` down to where the object is let go, as low as the hand can without touching an obstacle.

    Args:
        held: gripper frame in the object frame.
        goal: where the object shall come to rest, in the world.
        obstacles: walls and contents of the receptacle, and the neighbours.
        gripper: that holds it.
        width: material between the fingers, metres.
        height: z that the object's bottom keeps on the way, metres.
    """
    lowest = Pose(goal.p + [0, 0, SET_DOWN], goal.q) * held
    rise = _rise_to_clear(lowest, obstacles, gripper, approach_opening(width, gripper))
    release = Pose(lowest.p + [0, 0, rise], lowest.q)
    above = Pose(release.p + [0, 0, max(height - goal.p[2] - SET_DOWN - rise, 0.02)], release.q)
    after = Pose(release.p + [0, 0, max(above.p[2] - release.p[2], gripper.approach)], release.q)
    return PlaceWay(above=above, release=release, after=after, drop=rise + SET_DOWN)


def _rise_to_clear(pose: Pose, obstacles: Sequence[SolidBox], gripper: Gripper, opening: float) -> float:
    """How far the hand must go up so that none of its boxes touches an obstacle below it."""
    rise = 0.0
    for bounds in hand_boxes(gripper, opening):
        part = SolidBox(bounds, pose)
        for obstacle in obstacles:
            if part.outline.intersects(obstacle.outline):
                rise = max(rise, obstacle.top + SET_DOWN - part.bottom)
    return float(np.round(rise, 6))


def goals_in_slot(receptacle: SceneObject, slot: Pose) -> list[Pose]:
    """Where an object may come to rest, in the world.

    Args:
        slot: its place in the receptacle's frame.
    """
    return [receptacle.pose * slot * Pose.from_yaw([0, 0, 0], turn) for turn in TURNS]


def plan_place(cell: Workcell, grip: Grip, receptacle: SceneObject, point: int, slot: Pose) -> PlacePlan:
    """The first free way to bring what is held to its slot.

    Args:
        cell: as it stands.
        grip: what is held.
        receptacle: what receives it, where it stands.
        point: id of its functional point.
        slot: where the object goes, in the receptacle's frame.

    Raises:
        TaskFailed: there is none.
    """
    control = cell.world.arms[grip.arm]
    others = cell.objects_but(grip.object_id, receptacle.id)
    obstacles = [*receptacle.walls(point), *(o.box for o in others)]
    height = transfer_height([*others, receptacle], cell.world.table.height)
    held = cell.object(grip.object_id).pose.inverse() * control.tool_pose
    careful = Load(grip.load.opening, grip.load.held, grip.load.ignore, CAREFUL)
    planner = cell.planner(grip.arm)
    reasons: list[str] = []
    for goal in goals_in_slot(receptacle, slot):
        way = place_way(held, goal, obstacles, control.arm.gripper, control.finger_width, height)
        if way.drop > MAX_DROP:
            reasons.append(f"it would fall {way.drop * 100:.1f} cm")
            continue
        try:
            carry = planner.move(cell.joints(grip.arm), way.above, grip.load, then=[way.release, way.after])
            return PlacePlan(grip, receptacle.id, way, carry, planner.line(carry.end, way.release, careful))
        except MotionFailed as error:
            reasons.append(error.message)
    raise TaskFailed("plan", f"{grip.object_id} cannot be brought to {receptacle.id}: {first_reasons(reasons)}")


def carry_out_place(cell: Workcell, plan: PlacePlan) -> None:
    """Carry, let go, and draw the hand back.

    Raises:
        TaskFailed: the object was lost on the way, or the hand cannot be drawn back.
    """
    grip = plan.grip
    control = cell.world.arms[grip.arm]
    control.move(plan.carry)
    feel(cell, grip)
    control.move(plan.lower)
    gripper = control.arm.gripper
    opened = command_of(approach_opening(control.finger_width, gripper), gripper)
    control.grip(opened)
    away = Load(opening=opened, ignore=cell.parts(grip.object_id, plan.receptacle), speed=CAREFUL)
    with failing_at("place"):
        control.move(cell.planner(grip.arm).line(cell.joints(grip.arm), plan.way.after, away))
