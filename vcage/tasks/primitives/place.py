"""Place: bring the held object over its place, set it down, and retreat the hand."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from vcage.base.geometry import Pose
from vcage.schema.plan import TABLE
from vcage.schema.robot import Gripper
from vcage.sim.collision import Held
from vcage.sim.kinematics import ArmKinematics
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import JointPath, Load
from vcage.tasks.grasps import approach_opening, command_of
from vcage.tasks.primitives.grip import Grip, feel, minding
from vcage.tasks.primitives.pick import transfer_heights
from vcage.tasks.primitives.place_way import DROP, PlaceWay, largest_drop, place_way, reached_place
from vcage.tasks.scene_objects import Obstacles
from vcage.tasks.touching import at_rest
from vcage.tasks.workcell import CAREFUL_SPEED_SHARE, TaskFailed, Workcell, failing_at, first_reasons


@dataclass(frozen=True)
class PlaceSettings:
    """Margins for letting go of an object.

    Args:
        slack_m: the held object may shift between the fingers by up to this: a place must not be
            at the very end of an arm's reach.
        raises_m: how much higher an object is let go where the hand meets something at the lowest height.
        beside_m: a hand nearer than this to the vertical below where it came from goes straight back there.
        back_turns_rad: turns from its old heading at which an object may be put back, in this order.
    """

    slack_m: float = 0.006
    raises_m: tuple[float, ...] = (0.01, 0.02, 0.035)
    beside_m: float = 0.01
    back_turns_rad: tuple[float, ...] = tuple(float(np.radians(turn)) for turn in (2, -2, 5, -5))


SETTINGS = PlaceSettings()


@dataclass(frozen=True)
class PlacePlan:
    """A place that the holding arm can do.

    Args:
        grip: the held object.
        receptacle: id of the receptacle, or ``table``.
        way: poses of the gripper.
        path: the lift, the path to the first pose, and from there to the release.
    """

    grip: Grip
    receptacle: str
    way: PlaceWay
    path: JointPath


def old_places(stood: Pose) -> list[Pose]:
    """Poses at which an object is put back where it stood, the old one first.

    It may have turned between the fingers: a wrist that took it at its limit does not reach the old heading again.
    """
    turns = [Pose.from_yaw([0, 0, 0], turn) * Pose(q=stood.q) for turn in SETTINGS.back_turns_rad]
    return [stood, *(Pose(stood.p, turned.q) for turned in turns)]


def _farther(kinematics: ArmKinematics, pose: Pose) -> Pose:
    """The pose that is farther from where the arm stands, by the slack of a held object."""
    away = (pose.p - kinematics.arm.base.pose().p) * [1.0, 1.0, 0.0]
    return Pose(pose.p + SETTINGS.slack_m * away / np.linalg.norm(away), pose.q)


Choice = TypeVar("Choice")


def plan_place(
    cell: Workcell, grip: Grip, around: Surroundings, choices: Iterable[tuple[Choice, Sequence[Pose]]]
) -> tuple[PlacePlan, Choice]:
    """The first free path for the held object to one of the places to choose from, and the place.

    The nearer of the poses of a place is tried first; the release height rises where the hand has no room.

    Args:
        cell: in its present state.
        grip: the held object.
        around: the receptacle at its place, and the other objects there.
        choices: places in the order to try, each with the possible poses of the object, in
            the world.

    Raises:
        TaskFailed: there is none.
    """
    control = cell.world.arms[grip.arm]
    planner, begun = cell.planner(grip.arm), cell.begun(grip.arm)
    gripper, width = control.arm.gripper, control.finger_width
    away = leaving(cell, grip.object_id, around.receptacle, gripper, width, ahead=True)
    reasons: list[str] = []
    for choice, poses in choices:
        for held, raised in _holds(cell, grip, around):
            lowering = Load(grip.load.opening, held, grip.load.ignore, CAREFUL_SPEED_SHARE)
            try:
                ways = raised.ways(
                    planner.kinematics, held.in_gripper.inverse(), control.finger_width, poses, begun.end
                )
            except MotionFailed as error:
                reasons.append(error.message)
                continue
            for way in ways:
                try:
                    carry = planner.move(begun.end, way.above, grip.carrying, then=[way.release, way.after])
                    lower = planner.line(carry.end, way.release, lowering)
                    if around.hovers is None and cell.world.keeping:  # an arm at home is not in the way
                        planner.line(lower.end, way.after, away)
                    return PlacePlan(grip, around.receptacle, way, begun.then(carry).then(lower)), choice
                except MotionFailed as error:
                    reasons.append(error.message)
    raise TaskFailed("plan", f"{grip.object_id} cannot be brought {around.where}: {first_reasons(reasons)}")


def _holds(cell: Workcell, grip: Grip, around: Surroundings) -> Iterator[tuple[Held, Surroundings]]:
    """Ways to put down the held object, each with the obstacles below it: with the hand as it took the object, which
    turns back when it meets its support; and as it hangs, the hand turned so that the object stands."""
    thing, gripper = cell.object(grip.object_id), cell.world.arms[grip.arm].tool_pose
    if grip.grasped is not None:
        sag = max(0.0, thing.moved(gripper * grip.grasped.in_gripper).lowest - thing.lowest)
        yield grip.grasped, replace(around, heights=tuple(height + sag for height in around.heights))
    yield cell.held(thing.id, gripper), around


@dataclass(frozen=True)
class Surroundings:
    """Surroundings of a place where an object is put down, as they stand.

    Args:
        receptacle: id of the object's receptacle, or ``table``.
        obstacles: its walls and contents, and the neighbours.
        heights: z's of the object's frame at which its bottom clears what is below, the highest first, metres.
        raises: how much higher it may come to where the hand meets something, metres.
        hovers: where it is held in the air, in words; None where it is put down.
        drop_m: how far it may fall.
    """

    receptacle: str
    obstacles: Obstacles
    heights: tuple[float, ...]
    raises: tuple[float, ...] = SETTINGS.raises_m
    hovers: str | None = None
    drop_m: float = DROP.most_m

    @property
    def where(self) -> str:
        """The place in words."""
        return self.hovers or f"to {self.receptacle}"

    @classmethod
    def of(cls, cell: Workcell, object_id: str, receptacle: str, point: int | None) -> Surroundings:
        """Everything but the object itself and its contents is in its way.

        Args:
            cell: in its present state.
            object_id: the object to put down.
            receptacle: id of its receptacle, or ``table``.
            point: id of the receptacle's functional point; None on the table.
        """
        others = cell.objects_but(object_id, receptacle, *cell.contents(object_id))
        boxes, over, drop = [box for o in others for box in o.boxes], list[float](), DROP.most_m
        if point is not None:
            holder = cell.object(receptacle)
            boxes, over, drop = [*holder.around(point), *boxes], [holder.rim(point)], largest_drop(holder, point)
            others.append(holder)
        rise = cell.object(object_id).asset.stands.inverse().p[2]
        heights = tuple(height + rise for height in transfer_heights(others, cell.world.table.height, over))
        return cls(receptacle, Obstacles(boxes), heights, drop_m=drop)

    def ways(
        self, kinematics: ArmKinematics, held: Pose, width: float, poses: Sequence[Pose], start: np.ndarray
    ) -> list[PlaceWay]:
        """Ways within reach to release an object at one of some poses: each as low as possible, then higher.

        Each begins as high as the arm reaches.

        Args:
            kinematics: of the arm that holds it.
            held: gripper frame in the object frame.
            width: material between the fingers, metres.
            poses: of the object, in the world.
            start: (n,) joints before, rad.

        Raises:
            MotionFailed: there is none.
        """
        gripper = kinematics.arm.gripper
        near: list[PlaceWay] = []
        least = np.inf
        for height in self.heights:
            ways = [place_way(held, pose, self.obstacles, gripper, width, height) for pose in poses]
            least = min(least, *(way.drop for way in ways))
            new = [w for w in ways if w.drop <= self.drop_m and all(w.release != there.release for there in near)]
            found = [reached[0] for way in new if (reached := reached_place(kinematics, way, start))]
            near += sorted(found, key=lambda way: kinematics.distance(start, way.above))
        if least > self.drop_m:
            raise MotionFailed(f"it would fall {least * 100:.1f} cm")
        if not near:
            raise MotionFailed("its place is out of reach")
        return [*near, *(way.raised(x) for way in near for x in self.raises if way.drop + x <= self.drop_m)]

    def check(self, planner: MotionPlanner, start: np.ndarray, held: Held, width: float, poses: Sequence[Pose]) -> None:
        """Check that a hold leads to a place: the arm comes down to it, the fingers can open, and the hand gets away.

        Args:
            planner: of the arm.
            start: (n,) its joints before, rad.
            held: the object between the fingers then.
            width: of the object, metres.
            poses: possible ones of the object there, in the world.

        Raises:
            MotionFailed: it does not.
        """
        gripper = planner.kinematics.arm.gripper
        carrying = Load(command_of(width, gripper), held)
        opened = Load(command_of(approach_opening(width, gripper), gripper), ignore=[held.object_id])
        reasons: list[str] = []
        for way in self.ways(planner.kinematics, held.in_gripper.inverse(), width, poses, start):
            try:
                above = planner.kinematics.ik(way.above, start)
                if above is None:  # paths with a higher release start higher too
                    raise MotionFailed("its place is out of reach")
                released = planner.line(above, way.release, carrying).end
                if planner.kinematics.ik(_farther(planner.kinematics, way.release), released, attempts=0) is None:
                    raise MotionFailed("its place is at the end of the arm's reach")
                planner.check(released, opened)
                if not planner.continues(released, [way.after]):
                    raise MotionFailed("the hand could not be drawn back")
                return
            except MotionFailed as error:
                reasons.append(error.message)
        raise MotionFailed(f"at its place, {first_reasons(reasons)}")


def leaving(
    cell: Workcell, object_id: str, receptacle: str, gripper: Gripper, width: float, *, ahead: bool = False
) -> Load:
    """The load of a hand on its way back from an object that it has let go of.

    Args:
        cell: before it lets go.
        object_id: the object.
        receptacle: id of what receives it, or ``table``.
        gripper: that held it.
        width: of the material between its fingers, metres.
        ahead: True before the object is there: what lies in it is then still where the hand has it.
    """
    place, contents = () if receptacle == TABLE else cell.parts(receptacle), cell.parts(*cell.contents(object_id))
    opened = command_of(approach_opening(width, gripper), gripper)
    gone = [*cell.parts(object_id), *(contents if ahead else ())]
    return Load(opened, ignore=gone, speed=CAREFUL_SPEED_SHARE, fingers_may_touch=[*place, *contents])


def carry_out_place(cell: Workcell, plan: PlacePlan) -> None:
    """Carry and release; the arm's next motion starts with the retreat of the hand.

    Raises:
        TaskFailed: the object was lost on the way, or the hand cannot be drawn back.
    """
    grip, control = plan.grip, cell.world.arms[plan.grip.arm]
    allowed = at_rest(plan.way.release, grip.object_id, _around_place(cell, plan))
    with minding(cell, grip):
        cell.carry_out(grip.arm, plan.path, allowed)
    feel(cell, grip)
    away = leaving(cell, grip.object_id, plan.receptacle, control.arm.gripper, control.finger_width)
    control.release(away.opening)
    cell.let_go(grip.object_id)
    with failing_at("place"):
        cell.put_off(grip.arm, cell.planner(grip.arm).line(plan.path.end, plan.way.after, away), allowed)


def _around_place(cell: Workcell, plan: PlacePlan) -> set[str]:
    """Name the allowed contacts of an object and the fingers at its place: ids of its contents, its receptacle, and
    the other objects there."""
    if plan.receptacle == TABLE:
        return {TABLE, *plan.grip.contents}
    return {plan.receptacle, TABLE, *plan.grip.contents} | (cell.beside(plan.receptacle) - {plan.grip.object_id})
