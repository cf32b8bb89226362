"""Hand over: an object held by one arm is brought between the arms, taken by another beside its hand, and let go."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice

import numpy as np

from vcage.base.geometry import Pose
from vcage.schema.asset import ContactPoint
from vcage.schema.robot import Gripper
from vcage.sim.kinematics import ArmKinematics, kinematics_of
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import JointPath, Load
from vcage.sim.state import WorldState
from vcage.tasks.grasps import approach_opening, command_of
from vcage.tasks.meeting import SETTINGS as MEETING
from vcage.tasks.meeting import Hold, Meeting, Suits, holds_beside, meeting_height, meetings
from vcage.tasks.primitives.grip import SETTINGS as CARRYING
from vcage.tasks.primitives.grip import Grip, feel, lever
from vcage.tasks.primitives.pick import PickWay
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.touching import Allowance
from vcage.tasks.workcell import CAREFUL_SPEED_SHARE, TaskFailed, Workcell, failing_at, first_reasons


@dataclass(frozen=True)
class HandOverSettings:
    """Limits of the search for a meeting.

    Args:
        planned: meetings for which every motion is planned, at most.
        carried: meetings to which the object is carried, at most: it turns between the fingers on its way, and may not
            be reached as it hangs then.
    """

    planned: int = 16
    carried: int = 3


SETTINGS = HandOverSettings()


@dataclass(frozen=True)
class HandOver:
    """The hand-over of an object to an arm.

    Args:
        cell: in its present state.
        object_id: the handed-over object.
        to: the taking arm.
        suits: raises MotionFailed where a hold does not suit the next step.
    """

    cell: Workcell
    object_id: str
    to: str
    suits: Suits = lambda _hold: None

    def leads_on(self, planner: MotionPlanner, way: PickWay, _: np.ndarray, contact: ContactPoint) -> None:
        """Check that the object can be handed over by the planner's arm if it grasps it so where it stands.

        Raises:
            MotionFailed: it cannot.
        """
        target = self.cell.object(self.object_id)
        given = Hold(target.pose.inverse() * way.grasp, target.asset.grasp_width(contact))
        next(self._meetings(target, given, planner.kinematics))

    def run(self, grip: Grip) -> tuple[Grip, WorldState]:
        """Execute it, the giving arm ends at home: the taking arm's hold, and the world when both held it.

        Raises:
            TaskFailed: no way can be planned, the fingers close on nothing, or the object is lost.
        """
        cell, taker = self.cell, self.cell.world.arms[self.to]
        meeting = [Allowance("hand", frozenset([self.object_id, *cell.world.arms]))]
        taken, reach = self._bring(grip)
        taker.command_gripper(_opened(taken.width, taker.arm.gripper))
        cell.carry_out(self.to, reach, meeting)
        taker.grip(0.0)
        if taker.empty:
            raise TaskFailed("grasp", f"the {self.to} arm closed its fingers on nothing beside the other hand")
        moment = cell.world.state()
        self._let_go(grip.arm, meeting)
        now = cell.object(self.object_id)
        held = cell.held(now.id, taker.tool_pose)
        turns = lever(now, taker.tool_pose.p, taker.arm.gripper, taker.finger_width)
        speed = CARRYING.hanging_speed if turns else 1.0
        grip = Grip(self.to, now.id, Load(opening=taker.opening, held=held, speed=speed), contents=grip.contents)
        feel(cell, grip)
        return grip, moment

    def _bring(self, grip: Grip) -> tuple[Hold, JointPath]:
        """Carry it to where the second arm takes it as it hangs then: the hold, and the way there.

        Raises:
            TaskFailed: nowhere, or it is lost.
        """
        carried = 0
        while True:
            planned, carry = self._plan(grip)
            self.cell.carry_out(grip.arm, carry)
            feel(self.cell, grip)
            held = self.cell.held(self.object_id, self.cell.world.arms[grip.arm].tool_pose)  # it may have turned
            grip = replace(grip, load=replace(grip.load, held=held))
            carried += 1
            try:
                return self._as_it_hangs(grip.arm, planned)
            except TaskFailed:
                if carried == SETTINGS.carried:
                    raise

    # --- planning ---

    def _meetings(self, target: SceneObject, given: Hold, giver: ArmKinematics) -> Iterator[Meeting]:
        """Poses at which it can change hands, obstacles aside.

        Raises:
            NoMeeting: nowhere.
        """
        arms, table_height = self.cell.world.arms, self.cell.world.table.height
        height = meeting_height(target, given, giver.arm.gripper, self.cell.objects_but(target.id), table_height)
        name = next(name for name, control in arms.items() if kinematics_of(control.arm) is giver)
        return meetings(
            target, given, (giver, kinematics_of(arms[self.to].arm)), height, self.suits, partial(self._free, name)
        )

    def _free(self, giver: str, meeting: Meeting) -> bool:
        """True if nothing is in the way at the second arm's hold, nor of the first arm when it draws back from there.

        A quick test before ways through the room are planned.
        """
        try:
            there = self._taker_at(giver, meeting)
            opening = _opened(meeting.taken.width, there.kinematics.arm.gripper)
            there.check(meeting.before, Load(opening))
            there.check(meeting.taking, Load(opening, fingers_may_touch=self.cell.parts(self.object_id)))
            self._gets_away(giver, meeting)
        except MotionFailed:
            return False
        return True

    def _taker_at(self, giver: str, meeting: Meeting) -> MotionPlanner:
        """A planner of the second arm where the first holds the object for it."""
        there = replace(self.cell.world.body(self.object_id), pose=meeting.pose)
        return self.cell.planner_among(self.to, {giver: meeting.giving}, {self.object_id: there})

    def _gets_away(self, giver: str, meeting: Meeting) -> None:
        """Check that the first arm can draw back where the second has taken the object.

        Raises:
            MotionFailed: it cannot.
        """
        there = replace(self.cell.world.body(self.object_id), pose=meeting.pose)
        leaving = self.cell.planner_among(giver, {self.to: meeting.taking}, {self.object_id: there})
        self._draw_back(leaving, meeting.giving, _opened(meeting.given.width, leaving.kinematics.arm.gripper))

    def _plan(self, grip: Grip) -> tuple[Meeting, JointPath]:
        """The first meeting at which every motion is free, and the giving arm's way to it."""
        cell, control = self.cell, self.cell.world.arms[grip.arm]
        target, begun, planner = cell.object(self.object_id), cell.begun(grip.arm), cell.planner(grip.arm)
        given = Hold(target.pose.inverse() * control.tool_pose, control.finger_width)
        reasons: list[str] = []
        try:
            for meeting in islice(self._meetings(target, given, planner.kinematics), SETTINGS.planned):
                try:
                    carry = planner.move(begun.end, meeting.giving, replace(grip.load, speed=CAREFUL_SPEED_SHARE))
                    self._reach(self._taker_at(grip.arm, meeting), meeting, meeting.taken, meeting.pose)
                    return meeting, begun.then(carry)
                except MotionFailed as error:
                    reasons.append(error.message)
        except MotionFailed as error:
            reasons.append(error.message)
        message = f"the {target.record.phrase} cannot be handed to the {self.to} arm: {first_reasons(reasons)}"
        raise TaskFailed("plan", message)

    def _as_it_hangs(self, giver: str, planned: Meeting) -> tuple[Hold, JointPath]:
        """The second arm's hold and its way there: an object may have turned in the first hand while it was carried."""
        cell, control = self.cell, self.cell.world.arms[giver]
        target, planner = cell.object(self.object_id), cell.planner(self.to)
        given = Hold(target.pose.inverse() * control.tool_pose, control.finger_width)
        reasons: list[str] = []
        contacts, gripper = target.asset.annotation.carrying_points, planner.kinematics.arm.gripper
        for taken in [planned.taken, *holds_beside(target.asset, given, contacts, gripper)][: 1 + MEETING.holds]:
            try:
                self.suits(taken)
                reach = self._reach(planner, planned, taken, target.pose)
                leaving = cell.planner_among(giver, {self.to: reach.end}, {})
                self._leave(leaving, cell.begun(giver).end, _opened(control.finger_width, control.arm.gripper))
                return taken, reach
            except MotionFailed as error:
                reasons.append(error.message)
        message = f"the {self.to} arm cannot take the {target.record.phrase} as it hangs: {first_reasons(reasons)}"
        raise TaskFailed("plan", message)

    def _reach(self, planner: MotionPlanner, planned: Meeting, taken: Hold, pose: Pose) -> JointPath:
        """The second arm's way to its hold on the object at ``pose``, at the end straight on, about as planned."""
        gripper, begun = planner.kinematics.arm.gripper, self.cell.begun(self.to)
        opening, hand = _opened(taken.width, gripper), pose * taken.in_object
        before = hand * Pose([0.0, 0.0, -gripper.approach])
        joints = planner.kinematics.ik(before, planned.before, attempts=0)
        near = Load(opening, fingers_may_touch=self.cell.parts(self.object_id), speed=CAREFUL_SPEED_SHARE)
        reach = planner.move(begun.end, before if joints is None else joints, Load(opening), then=[hand])
        return begun.then(reach).then(planner.line(reach.end, hand, near))

    def _draw_back(self, planner: MotionPlanner, joints: np.ndarray, opening: float) -> JointPath:
        """The first arm's way out of its hold: straight back, or less far, or up."""
        hand, far = planner.kinematics.fk(joints), planner.kinematics.arm.gripper.approach
        load = Load(opening, ignore=self.cell.parts(self.object_id), speed=CAREFUL_SPEED_SHARE)
        reasons: list[str] = []
        for away in (
            hand * Pose([0.0, 0.0, -far]),
            hand * Pose([0.0, 0.0, -far / 2]),
            Pose(hand.p + [0, 0, far], hand.q),
        ):
            try:
                return planner.line(joints, away, load)
            except MotionFailed as error:
                reasons.append(error.message)
        raise MotionFailed(first_reasons(reasons))

    def _leave(self, planner: MotionPlanner, joints: np.ndarray, opening: float) -> JointPath:
        """The first arm's way out of its hold and home."""
        away = self._draw_back(planner, joints, opening)
        first, *others = planner.move(away.end, planner.kinematics.home).legs
        return away.then(JointPath((replace(first, opens=1.0), *others)))

    # --- execution ---

    def _let_go(self, giver: str, allowed: Sequence[Allowance]) -> None:
        """Open the first hand, draw it back and bring it home."""
        cell, control = self.cell, self.cell.world.arms[giver]
        opening = _opened(control.finger_width, control.arm.gripper)
        control.release(opening)
        planner, here = cell.planner(giver), cell.begun(giver)
        with failing_at("place"):
            away = self._leave(planner, here.end, opening)
        cell.carry_out(giver, here.then(away), allowed)


def _opened(width: float, gripper: Gripper) -> float:
    """The gripper's command on the way to and from ``width`` of material, metres."""
    return command_of(approach_opening(width, gripper), gripper)
