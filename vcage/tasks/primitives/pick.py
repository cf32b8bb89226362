"""Pick: take hold of an object at a contact point, to lift it with what follows."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product

import numpy as np

from vcage.base.errors import UnknownName
from vcage.base.geometry import Pose
from vcage.schema.asset import ContactPoint
from vcage.schema.robot import Gripper
from vcage.sim.collision import Held
from vcage.sim.kinematics import ArmKinematics, follow
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import JointPath, Load
from vcage.tasks.grasps import GraspPose, approach_opening, command_of
from vcage.tasks.hand_poses import hand_poses
from vcage.tasks.primitives.grip import Grip, feel, lever, minding, off_middle, sag
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import resting_point
from vcage.tasks.touching import at_rest
from vcage.tasks.workcell import CAREFUL_SPEED_SHARE, TaskFailed, Workcell, failing_at, first_reasons


@dataclass(frozen=True)
class PickWay:
    """Gripper poses of a pick, in order."""

    before: Pose
    grasp: Pose
    lifted: Pose


@dataclass(frozen=True)
class PickPlan:
    """A pick that an arm can do.

    Args:
        target: the object to pick, at its place.
        contact: id of the contact point.
        arm: that takes it.
        opening: command of the gripper on the way, 0 closed to 1 open.
        way: poses of the gripper.
        path: to the first pose, and from there to the grasp.
    """

    target: SceneObject
    contact: int
    arm: str
    opening: float
    way: PickWay
    path: JointPath


LeadsOn = Callable[[MotionPlanner, PickWay, np.ndarray, ContactPoint], None]
"""Raises MotionFailed where an arm (the planner's) cannot go on from a way to grasp at a contact point, that ends at
joints (n,), rad."""


def transfer_height(others: Sequence[SceneObject], table_height: float) -> float:
    """z that the bottom of a carried object must keep, metres."""
    return transfer_heights(others, table_height)[0]


def transfer_heights(
    others: Sequence[SceneObject],
    table_height: float,
    over: Iterable[float] = (),
    clearance_m: float = 0.03,
    heights: int = 3,
) -> tuple[float, ...]:
    """z's that the bottom of a carried object may keep, the highest first, metres.

    It is above all others; where an arm does not reach so high, it is lower, and its way goes around them.

    Args:
        others: on the table.
        table_height: z of the table top, metres.
        over: z's that it must be above in any case, metres.
        clearance_m: between what is carried and the highest thing on the table.
        heights: number that is tried, from above everything to just above what the object comes out of or goes into.
    """
    top = max([table_height, *(o.box.top for o in others)])
    least = max([table_height, *over])
    return tuple(dict.fromkeys((np.linspace(top, min(least, top), heights) + clearance_m).tolist()))


def lift_heights(target: SceneObject, others: Sequence[SceneObject], table_height: float) -> tuple[float, ...]:
    """:func:`transfer_heights` of an object lifted out of a container."""
    held_in = ((o, resting_point(target, o)) for o in others)
    rims = [o.rim(point.id) for o, point in held_in if point is not None]
    return transfer_heights(others, table_height, rims)


def pick_way(target: SceneObject, grasp: GraspPose, gripper: Gripper, height: float) -> PickWay:
    """From above the contact point down to it, and straight up until the object's bottom is at ``height``.

    Args:
        target: the object to pick.
        grasp: the hold.
        gripper: how far from the grasp its approach begins.
        height: z, metres.
    """
    rise = max(height - target.box.bottom, gripper.approach)
    return PickWay(
        before=Pose(grasp.pose.p - gripper.approach * grasp.pose.rotation()[:, 2], grasp.pose.q),
        grasp=grasp.pose,
        lifted=Pose(grasp.pose.p + [0, 0, rise], grasp.pose.q),
    )


def reached_lift(
    kinematics: ArmKinematics, target: SceneObject, grasp: GraspPose, heights: Sequence[float]
) -> tuple[float, list[np.ndarray] | None]:
    """The highest of some heights to which an arm lifts an object with a grasp, and its joints on the way there; the
    first and None if it cannot grasp or lift it.

    Args:
        kinematics: of the arm.
        target, grasp: as of :func:`pick_way`.
        heights: z of the object's bottom, the highest first, metres.
    """
    for height in heights:
        way = pick_way(target, grasp, kinematics.arm.gripper, height)
        path = follow(kinematics, [way.before, way.grasp, way.lifted], kinematics.home)
        if path is not None:
            return height, path
    return heights[0], None


class KnownPaths:
    """Paths to the grasps of an object in a cell that does not change, none of which is planned twice."""

    def __init__(self) -> None:
        self._found: dict[Hashable, JointPath | MotionFailed] = {}

    def require_possible(self, grasp: Hashable) -> None:
        """Raise MotionFailed for a grasp to which no path was found."""
        found = self._found.get(grasp)
        if isinstance(found, MotionFailed):
            raise found

    def path(self, grasp: Hashable, plan: Callable[[], JointPath]) -> JointPath:
        """The path to a grasp, planned the first time.

        Raises:
            MotionFailed: there is none.
        """
        self.require_possible(grasp)
        if grasp not in self._found:
            try:
                self._found[grasp] = plan()
            except MotionFailed as error:
                self._found[grasp] = error
        self.require_possible(grasp)
        found = self._found[grasp]
        assert isinstance(found, JointPath)
        return found


def plan_pick(
    cell: Workcell,
    target: SceneObject,
    grasps: Sequence[tuple[int, str]],
    leads_on: LeadsOn = lambda *_: None,
    known: KnownPaths | None = None,
) -> PickPlan:
    """The first of ``grasps`` (contact point, arm) with a free path, and a possible continuation of the task.

    Args:
        cell: in its present state.
        target: the object to pick, at its place.
        grasps: in the order to try.
        leads_on: whether a grasp does; all do when not given.
        known: of the same object in the same cell.

    Raises:
        TaskFailed: none has.
        UnknownName: there is no such contact point or arm.
    """
    reasons: list[str] = []
    for contact, arm in grasps:
        for plan in _plans(cell, target, contact, arm, leads_on, known or KnownPaths()):
            if isinstance(plan, PickPlan):
                return plan
            reasons.append(plan)
    message = f"no grasp of {target.record.phrase} can be planned: {first_reasons(reasons)}"
    raise TaskFailed("plan", message, exhausted=True)


def _plans(
    cell: Workcell, target: SceneObject, contact_id: int, arm: str, leads_on: LeadsOn, known: KnownPaths
) -> Iterator[PickPlan | str]:
    """For each pose of the hand at a contact point, the straightest first: a plan, or why there is none."""
    contact = target.asset.annotation.contact_point(contact_id)
    if arm not in cell.world.arms:
        raise UnknownName("arm", arm, cell.world.arms)
    if contact.link is not None:
        yield f"{contact.name!r} is on a moving part: {target.record.phrase} is not carried by it"
        return
    gripper = cell.world.arms[arm].arm.gripper
    contents, hangs_lower = cell.contents(target.id), sag(target, contact, gripper)
    if contents and hangs_lower:
        yield f"held at {contact.name!r}, {target.record.phrase} tips with what lies in it"
        return
    heights = lift_heights(target, cell.objects_but(target.id, *contents), cell.world.table.height)
    heights = tuple(height + hangs_lower for height in heights)
    planner = cell.planner(arm)
    opening = command_of(approach_opening(target.asset.grasp_width(contact), gripper), gripper)
    begun = cell.begun(arm)
    grasps = hand_poses(target, contact, gripper)
    for height, flips in product(heights, zip(grasps[::2], grasps[1::2], strict=True)):
        lifts = [(g, *reached_lift(planner.kinematics, target, g, heights)) for g in flips]
        ways = [(pick_way(target, g, gripper, height), path) for g, reached, path in lifts if reached == height]
        for way, path in sorted(ways, key=lambda found: planner.kinematics.distance(begun.end, found[0].before)):
            try:
                if path is None:
                    raise MotionFailed("no joint angles grasp and lift it")
                grasp = (arm, contact_id, height, way.grasp.p.tobytes(), way.grasp.q.tobytes())
                known.require_possible(grasp)
                leads_on(planner, way, path[-1], contact)
                reached = known.path(grasp, partial(_path_to_grasp, cell, planner, begun.end, target, contact, way))
            except MotionFailed as error:
                yield f"{arm} arm at {contact.name!r}: {error.message}"
            else:
                yield PickPlan(target, contact_id, arm, opening, way, begun.then(reached))


def _path_to_grasp(
    cell: Workcell, planner: MotionPlanner, begun: np.ndarray, target: SceneObject, contact: ContactPoint, way: PickWay
) -> JointPath:
    """From joints ``begun`` (n,), rad, to a grasp from which the arm can lift the object.

    Raises:
        MotionFailed: there is no such path.
    """
    arm, width = planner.kinematics.arm, target.asset.grasp_width(contact)
    opening = command_of(approach_opening(width, arm.gripper), arm.gripper)
    closing = Load(opening, fingers_may_touch=cell.parts(target.id), speed=CAREFUL_SPEED_SHARE)
    reach = planner.move(begun, way.before, Load(opening), then=[way.grasp, way.lifted])
    down = planner.line(reach.end, way.grasp, closing)
    lifting = _lifting(cell.held(target.id, way.grasp), command_of(width, arm.gripper))
    planner.line(down.end, way.lifted, lifting)
    return reach.then(down)


def _lifting(held: Held, opening: float) -> Load:
    """A hand that has closed on an object, and lifts it from the table."""
    return Load(opening, held, ignore=["table"], speed=CAREFUL_SPEED_SHARE)


def carry_out_pick(cell: Workcell, plan: PickPlan) -> Grip:
    """Reach and close the fingers; the arm's next motion starts with the lift.

    An object held far from its middle shifts or turns between the fingers when lifted. Its lift ends before anything
    else is planned, so that the following motions are planned with the object as it hangs.

    Raises:
        TaskFailed: the fingers closed on nothing, the object cannot be lifted, or something else is touched.
    """
    control, target = cell.world.arms[plan.arm], plan.target
    allowed = at_rest(plan.way.grasp, target.id, cell.beside(target.id))
    cell.take(target.id)  # an object pushed aside by the fingers no longer counts as contents
    control.command_gripper(plan.opening)
    cell.carry_out(plan.arm, plan.path, allowed)
    control.grip(0.0)
    if control.empty:
        raise TaskFailed("grasp", f"the fingers closed on nothing where {target.record.phrase} should be")
    held = cell.held(target.id, control.tool_pose)
    lift = _lifting(held, control.opening)
    grip = Grip(plan.arm, target.id, Load(control.opening, held), contents=cell.contents(target.id))
    with failing_at("grasp"):
        cell.put_off(plan.arm, cell.planner(plan.arm).line(plan.path.end, plan.way.lifted, lift), allowed)
    return _lifted(cell, grip, target, plan) if off_middle(target, plan.way.grasp.p) else grip


def _lifted(cell: Workcell, grip: Grip, target: SceneObject, plan: PickPlan) -> Grip:
    """Lift the held object now, and measure how it has shifted or turned between the fingers."""
    control = cell.world.arms[grip.arm]
    with minding(cell, grip):
        cell.finish(grip.arm)
    feel(cell, grip)
    held = cell.held(grip.object_id, control.tool_pose)
    width = target.asset.grasp_width(target.asset.annotation.contact_point(plan.contact))
    turns = lever(target, plan.way.grasp.p, control.arm.gripper, width)
    return grip.hanging(held) if turns else grip.level(held)
