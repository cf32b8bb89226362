"""Operate: open, close or press a moving part: plan its paths, take the first free one, measure its motion."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vcage.base.attempts import LIMITS
from vcage.goals.thresholds import THRESHOLDS
from vcage.schema.asset import ContactPoint
from vcage.sim.arms import ArmControl
from vcage.sim.bodies import Body
from vcage.sim.collision import CollisionScene
from vcage.sim.joints import carried_by, link_poses, part_name
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import JointPath, Load
from vcage.sim.state import WorldState
from vcage.tasks.grasps import command_of
from vcage.tasks.primitives.grip import turning_command
from vcage.tasks.primitives.handles import Handle, OperatingWay, operating_ways
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.touching import Allowance
from vcage.tasks.workcell import CAREFUL_SPEED_SHARE, TaskFailed, Workcell, first_reasons

SLOW = 0.4
"""Share of the speed limit while a part is moved."""


@dataclass(frozen=True)
class OperatePlan:
    """A way with the arm that takes it.

    Args:
        reach: to the way's first pose, and from there to the handle.
        push: along the joint's motion to the target.
        back: the rest of the way's motion; only a press has one.
        clear: whether the open hand touches nothing at the handle, not even the part itself.
    """

    arm: str
    way: OperatingWay
    reach: JointPath
    push: JointPath
    back: JointPath | None
    clear: bool


class Operation:
    """One moving part that is to be brought to a position.

    Args:
        cell: as it stands.
        thing: the object at its present pose.
        contact: the grasp point of the part; its ``link`` is the part.
        target: final position of its joint, metres or radians.

    Attributes:
        moment: state of the world at the end of a press.

    Raises:
        TaskFailed: the contact point sits on no moving part, or the target is outside the joint's range.
    """

    def __init__(self, cell: Workcell, thing: SceneObject, contact: ContactPoint, target: float):
        world = cell.world
        model = world.bodies[thing.id].model
        if contact.link is None:
            raise TaskFailed("plan", f"{contact.name!r} of {thing.record.phrase} is on no moving part")
        joint = model.link(contact.link).joint
        if not joint.lower <= target <= joint.upper:
            allowed = f"{joint.lower:.3f} to {joint.upper:.3f}"
            raise TaskFailed("plan", f"{contact.link} of {thing.record.phrase} moves from {allowed}, not to {target}")
        self.moment: WorldState | None = None
        self._cell = cell
        self._world = world
        self._thing = thing
        self._contact = contact
        self._target = target
        self._part = part_name(thing.id, contact.link)
        self._own = [part_name(thing.id, name) for name in carried_by(model, contact.link)]
        self._riding = _riding(cell, thing, contact.link)
        along = [name for key in self._riding for name in cell.parts(key)]
        self._own += along
        self._allowed = [Allowance("hand", frozenset([thing.id, *self._riding]))]
        # Tolerance for closed; for opening or pressing the simulator's truth tolerates more.
        self._tolerance = THRESHOLDS.closed_share * (joint.upper - joint.lower)
        width = thing.asset.grasp_width(contact)
        self._handle = Handle(contact, model, thing.pose, world.object_joints(thing.id), width)

    def choose(self, arms: Sequence[str], failed: int) -> tuple[OperatePlan, bool]:
        """A plannable path, and True if it is the first.

        Args:
            arms: that may do it, best first.
            failed: how many attempts failed; each later one takes the next way, whatever the reason was.

        Raises:
            TaskFailed: no way can be planned.
        """
        reasons: list[str] = []
        clear, others = [], []
        for plan in self._plans(arms):
            if not isinstance(plan, OperatePlan):
                reasons.append(plan)
                continue
            (clear if plan.clear else others).append(plan)
            if len(clear) > failed or len(others) >= LIMITS.unclear_ways + failed:
                break
        plans = clear + others
        if not plans:
            named = f"{self._contact.name!r} of {self._thing.record.phrase}"
            message = f"no way to operate {named} can be planned: {first_reasons(reasons)}"
            raise TaskFailed("plan", message, exhausted=True)
        return plans[failed % len(plans)], failed % len(plans) == 0

    def run(self, plan: OperatePlan) -> None:
        """Carry it out. The arm ends beside the handle.

        Raises:
            TaskFailed: the fingers miss the handle, or the joint did not reach its target.
        """
        control = self._world.arms[plan.arm]
        control.command_gripper(command_of(plan.way.opening, control.arm.gripper))
        self._cell.carry_out(plan.arm, plan.reach, self._allowed)
        if self._contact.use == "grasp":
            control.grip(turning_command(control.arm.gripper, self._handle.width) if plan.way.turning else 0.0)
            if control.empty:
                where = f"{self._contact.name!r} of {self._thing.record.phrase}"
                raise TaskFailed("grasp", f"the fingers closed on nothing where {where} should be")
        self._cell.carry_out(plan.arm, plan.push, self._allowed)
        reached = self._position()
        if self._contact.use == "press":
            self.moment = self._world.state()
        if plan.back is not None:
            self._cell.carry_out(plan.arm, plan.back, self._allowed)
        self._let_go(plan, control)
        # A spring returns a pressed part: there, only the end of the push counts.
        if self._contact.use == "press":
            self._check(reached)
        self.confirm()

    def confirm(self) -> None:
        """Check that a part moved by its handle still is where it was brought; a pressed button may spring back.

        Raises:
            TaskFailed: it is not.
        """
        if self._contact.use == "grasp":
            self._check(self._position())

    # --- planning --------------------------------------------------------------------------------------

    def _plans(self, arms: Sequence[str]) -> Iterator[OperatePlan | str]:
        """For each way of each arm: a plan, or why there is none."""
        for arm in arms:
            joints, where = self._cell.begun(arm).end, f"{arm} arm at {self._contact.name!r}"
            now = then = self._cell.planner(arm)
            if self._contact.use != "press":
                then = MotionPlanner(CollisionScene.of_world(self._world, arm, self.at_target()))
            gripper = self._world.arms[arm].arm.gripper
            for way in operating_ways(self._handle, self._target, gripper, self._thing.box.bottom):
                starts = now.kinematics.ik_all(way.before, joints)
                if not starts:
                    yield f"{where}: out of reach"
                for start in sorted(starts, key=lambda q, joints=joints: float(np.abs(q - joints).max())):
                    try:
                        yield self._plan(arm, way, start, now, then)
                    except MotionFailed as error:
                        yield f"{where}: {error.message}"

    def _plan(
        self, arm: str, way: OperatingWay, start: np.ndarray, now: MotionPlanner, then: MotionPlanner
    ) -> OperatePlan:
        """Every motion of a way with the arm at ``start`` before it, the narrow ones first.

        Args:
            arm: that takes it.
            way: poses of the gripper.
            start: (n,) joints before it, rad.
            now, then: planners around the present and the final state.

        Raises:
            MotionFailed: one of them is not free.
        """
        record = self._world.arms[arm].arm
        opening = command_of(way.opening, record.gripper)
        near = Load(opening, fingers_may_touch=self._own, speed=CAREFUL_SPEED_SHARE)
        down = now.line(start, way.grasp, near)
        held = command_of(self._handle.width if way.opening else 0.0, record.gripper)
        moving = Load(held, ignore=self._own, speed=SLOW)
        push = now.follow(down.end, way.motion[: way.pushed], moving)
        rest = way.motion[way.pushed :]
        back = now.follow(push.end, rest, moving) if rest else None
        away = then.line((back or push).end, way.after, near)
        # The hand must get there, and home again: reaching it is useless if it then stands in a corner.
        begun = self._cell.begun(arm)
        reach = begun.then(now.move(begun.end, start, Load(opening))).then(down)
        then.move(away.end, np.array(record.home), Load(opening))
        touched = self._own if self._contact.use == "press" else ()
        clear = now.scene.first_contact(down.end, opening, ignore=touched) is None
        return OperatePlan(arm, way, reach, push, back, clear)

    def at_target(self) -> dict[str, Body]:
        """The object, and the contents of its part, in the final state of the part, by id."""
        joints = tuple(self._handle.joints_at(self._target).tolist())
        there = replace(self._world.body(self._thing.id), joints=joints)
        link, model = str(self._contact.link), there.model
        now, then = (link_poses(model, j)[link] for j in (self._handle.joints, joints))
        moved = self._thing.pose * then * (self._thing.pose * now).inverse()
        riding = {key: self._world.body(key) for key in self._riding}
        return {self._thing.id: there} | {key: replace(body, pose=moved * body.pose) for key, body in riding.items()}

    # --- execution -------------------------------------------------------------------------------------

    def _let_go(self, plan: OperatePlan, control: ArmControl) -> None:
        """Open the fingers; the arm's next motion starts with the retreat of the hand."""
        opened = command_of(plan.way.opening, control.arm.gripper)
        control.release(opened)
        planner, here = self._cell.planner(plan.arm), self._cell.begun(plan.arm).end
        away = Load(opened, fingers_may_touch=[self._thing.id, *self._own], speed=CAREFUL_SPEED_SHARE)
        try:
            self._cell.put_off(plan.arm, planner.line(here, plan.way.after, away), self._allowed)
        except MotionFailed as error:
            raise TaskFailed("place", f"the hand cannot be drawn back: {error.message}") from error

    def _position(self) -> float:
        joints = self._world.object_joints(self._thing.id)
        return replace(self._handle, joints=joints).position

    def _check(self, position: float) -> None:
        if abs(position - self._target) > self._tolerance:
            named = f"{self._part.partition('/')[2]} of {self._thing.record.phrase}"
            raise TaskFailed("place", f"{named} came to {position:.3f} instead of {self._target:.3f}")


def _riding(cell: Workcell, thing: SceneObject, link: str) -> list[str]:
    """Ids of the objects that lie in or on a moving part, and go where it goes."""
    box = thing.part_box(link)
    lower, upper = box.bounds
    found = []
    for other in cell.objects_but(thing.id):
        middle = box.pose.inverse().apply(other.aabb.mean(axis=0))
        rests = lower[2] - 0.01 <= other.aabb[0, 2] - box.pose.p[2] <= upper[2] + 0.01
        if rests and np.all((lower[:2] < middle[:2]) & (middle[:2] < upper[:2])):
            found.append(other.id)
    return found
