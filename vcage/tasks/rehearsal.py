"""A task that only plans: what a sub-task's script does is planned, and things are then where it would bring them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from vcage.base.attempts import LIMITS
from vcage.base.geometry import Pose
from vcage.schema.asset import ContactPoint
from vcage.schema.plan import TABLE
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import Load
from vcage.tasks.grasps import command_of
from vcage.tasks.hanging import hung_poses
from vcage.tasks.hitting import SETTINGS as HITTING
from vcage.tasks.pouring import balls_in
from vcage.tasks.primitives.along import plan_along
from vcage.tasks.primitives.come_down import way_down
from vcage.tasks.primitives.hold_with_both import plan_with_both
from vcage.tasks.primitives.place import Surroundings, leaving
from vcage.tasks.primitives.pour import SETTINGS as POURING
from vcage.tasks.primitives.shake import plan_shake
from vcage.tasks.primitives.slide import INTO_A_HOLE, OVER_A_PEG, Sliding, plan_slide
from vcage.tasks.primitives.wipe import rehearse_wipe
from vcage.tasks.stowing import heaped_in
from vcage.tasks.task import Task
from vcage.tasks.workcell import TaskFailed, failing_at, first_reasons

_GoesOn = Callable[[MotionPlanner, np.ndarray, Load], object]
"""Plans a motion of an arm from (n,) joints on, with a load; raises :class:`MotionFailed` where there is none."""


class Rehearsal(Task):
    """A task that plans its motions and carries none out: things are then where they would have been brought."""

    def pick(self, object_id: str, grasps: Sequence[tuple[int, str]], hand_to: str | None = None) -> None:
        """Plan it, with the hand-over if there is one."""
        self._picked = self._choose(self._cell.object(object_id), grasps, hand_to)

    def hand_over(self, to: str) -> None:
        """Nothing: :meth:`pick` has looked."""

    def show(self, object_id: str, other_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Plan it, with the way to a pose there; the object is put back."""
        self._picked, hover, groups = self._choose_showing(object_id, other_id, grasps, tight=False)
        self._carry(hover, groups)

    def hit(self, tool_id: str, thing_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Plan it, with the way down; the tool is put back."""
        self._picked, hover, poses = self._choose_hitting(tool_id, thing_id, grasps, tight=False)
        self._carry(hover, [poses], partial(way_down, thing=self._cell.parts(thing_id), above_m=HITTING.above_m))

    def wipe(self, tool_id: str, thing_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Plan it, with the way down and the strokes; the tool is put back."""
        self._picked, hover, way = self._choose_wiping(tool_id, thing_id, grasps, tight=False)
        self._carry(hover, [way[:1]], partial(rehearse_wipe, thing=self._cell.parts(thing_id), way=way))

    def pour(self, vessel_id: str, target_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Plan it; the balls lie in the container, and the vessel is put back."""
        cell = self._cell
        vessel, target = cell.object(vessel_id), cell.object(target_id)
        self._picked, _, ways = self._choose_pouring(vessel_id, target_id, grasps)
        up, load = self._lifted()
        with failing_at("plan"):
            plan_along(cell.planner(self._picked.arm), up, load, next(ways), POURING.speed)
        balls = balls_in(vessel, cell.objects_but(vessel_id))
        for name, pose in heaped_in(target, balls, np.random.default_rng(0)).items():
            self.world.set_object_pose(name, pose)

    def hang(self, thing_id: str, rack_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Plan it; the thing hangs where it comes to rest."""
        self._picked, _, ways = self._choose_hanging(thing_id, rack_id, grasps)
        way = self._slid(next(ways), OVER_A_PEG)
        thing, rack = self._cell.object(thing_id), self._cell.object(rack_id)
        rests = hung_poses(thing, rack, self._cell.objects_but(thing_id))
        nearest = min(rests, key=lambda pose: float(np.linalg.norm(pose.p - way[-1].p)))
        self.world.set_object_pose(thing_id, nearest)

    def insert(self, thing_id: str, place_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Plan it; the thing is where it is let go."""
        self._picked, _, ways = self._choose_inserting(thing_id, place_id, grasps)
        self.world.set_object_pose(thing_id, self._slid(next(ways), INTO_A_HOLE)[-1])

    def _slid(self, way: Sequence[Pose], sliding: Sliding) -> Sequence[Pose]:
        """Plan that what was picked is lifted and slid along a way, which is returned."""
        up, load = self._lifted()
        with failing_at("plan"):
            plan_slide(self._cell.planner(self._picked.arm), up, load, way, sliding)
        return way

    def wait(self, seconds: float) -> None:
        """Nothing."""

    def hold(self) -> None:
        """Lift the picked object, with its contents; the arm stays there."""
        plan, cell = self._picked, self._cell
        up, _ = self._lifted()
        for name in (plan.target.id, *cell.contents(plan.target.id)):
            pose = self.world.object_pose(name)
            self.world.set_object_pose(name, Pose(pose.p + plan.way.lifted.p - plan.way.grasp.p, pose.q))
        control = self.world.arms[plan.arm]
        control.reset(up - control.arm.home)
        control.command_gripper(0.0)

    def hold_with_both(self, object_id: str) -> None:
        """Plan it; no arm is left to do anything else."""
        plan_with_both(self._cell, self._cell.object(object_id))

    def shake(self) -> None:
        """Plan it; the object is where it was."""
        plan = self._picked
        up, load = self._lifted()
        pose, planner = plan.target.pose, self._cell.planner(plan.arm)
        thing = plan.target.moved(Pose(pose.p + plan.way.lifted.p - plan.way.grasp.p, pose.q))
        with failing_at("plan"):
            plan_shake(planner, up, plan.way.lifted, thing, self.world.table.height, load)

    def _lifted(self) -> tuple[np.ndarray, Load]:
        """(n,) joints of the arm that has lifted what it picked, and the load of its hand."""
        plan, cell = self._picked, self._cell
        opening = command_of(plan.target.asset.grasp_width(self._contact), cell.world.arms[plan.arm].arm.gripper)
        load = Load(opening, cell.held(plan.target.id, plan.way.grasp))
        with failing_at("grasp"):
            lift = cell.planner(plan.arm).line(plan.path.end, plan.way.lifted, replace(load, ignore=[TABLE]))
        return lift.end, load

    @property
    def _contact(self) -> ContactPoint:
        """The contact point of the picked object."""
        return self._picked.target.asset.annotation.contact_point(self._picked.contact)

    def place(self, receptacle_id: str = TABLE, point: int | None = None) -> None:
        """Bring the picked object, with its contents, to its slot, at the heading that is nearest for its arm."""
        if self.slot is not None:
            if self._keeping:  # an arm that holds something up is more in the way than one at home
                around = Surroundings.of(self._cell, self._picked.target.id, self.slot.receptacle, self.slot.point)
                self._carry(around, [self.slot.poses(self._cell.objects())])
            plan, arm = self._picked, self._cell.planner(self._picked.arm).kinematics
            held = plan.target.pose.inverse() * plan.way.grasp
            poses = self.slot.poses(self._cell.objects())
            nearest = min(poses, key=lambda pose: arm.distance(plan.path.end, pose * held))
            way = nearest * plan.target.pose.inverse()
            for name in (plan.target.id, *self._cell.contents(plan.target.id)):
                self.world.set_object_pose(name, way * self.world.object_pose(name))

    def _carry(self, around: Surroundings, groups: Iterable[Sequence[Pose]], then: _GoesOn | None = None) -> None:
        """Plan the way of the lifted object, past the other arms, to one of some poses.

        Args:
            around: its surroundings there.
            groups: poses of the object, in the world; those to try first come first.
            then: plans how it goes on from there.

        Raises:
            TaskFailed: there is none.
        """
        cell, (up, load) = self._cell, self._lifted()
        thing, planner = self._picked.target, cell.planner(self._picked.arm)
        held, width = thing.pose.inverse() * self._picked.way.grasp, thing.asset.grasp_width(self._contact)
        away = leaving(cell, thing.id, around.receptacle, planner.kinematics.arm.gripper, width, ahead=True)
        reasons: list[str] = []
        for poses in filter(None, groups):
            try:
                ways = around.ways(planner.kinematics, held, width, poses, up)[: LIMITS.ways_past_arms]
            except MotionFailed as error:
                reasons.append(error.message)
                continue
            for way in ways:
                try:
                    onward = [way.release, way.after]
                    # What a random tree finds past the other arm may be lost a millimetre away.
                    carry = planner.move(up, way.above, load, then=onward, search=not self._keeping)
                    there = planner.line(carry.end, way.release, load).end
                    if then is not None:
                        then(planner, there, load)
                    elif around.hovers is None:
                        planner.line(there, way.after, away)
                    return
                except MotionFailed as error:
                    reasons.append(error.message)
        raise TaskFailed("plan", f"{thing.id} cannot be brought {around.where}: {first_reasons(reasons)}")

    def push(self, object_id: str, arms: Sequence[str] = ()) -> None:
        """Plan it; the object is where it is pushed to."""
        self.world.set_object_pose(object_id, self._choose_push(self._cell.object(object_id), arms).goal)

    def operate(self, object_id: str, contact_id: int, target: float, arms: Sequence[str] = ()) -> None:
        """Plan it; the part is at its target with the objects on it, unless it springs back."""
        operation, _ = self._choose_operation(object_id, contact_id, target, arms)
        if self._cell.object(object_id).asset.annotation.contact_point(contact_id).use == "press":
            return
        for name, body in operation.at_target().items():
            self.world.set_object_pose(name, body.pose)
            if body.joints:
                self.world.set_object_joints(name, body.joints)

    def home(self) -> None:
        """Nothing: the arms are there."""
