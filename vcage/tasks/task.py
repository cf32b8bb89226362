"""The task API: the robot's actions in a sub-task script, and its questions to the critic.

A task knows the state of its world, as an expert does; whether the sub-task was done is not its to say.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from vcage.base.errors import UnknownName
from vcage.base.geometry import Pose
from vcage.schema.goals import Goal, goal_of
from vcage.schema.plan import TABLE
from vcage.sim.motion import MotionFailed
from vcage.sim.paths import JointPath
from vcage.sim.world import PHYSICS_HZ, World
from vcage.tasks.holding import SETTINGS as HOLDING
from vcage.tasks.primitives.grip import Grip, feel, hangs_below, minding
from vcage.tasks.primitives.hold_with_both import carry_out_with_both, plan_with_both
from vcage.tasks.primitives.pick import carry_out_pick
from vcage.tasks.primitives.place import Surroundings, carry_out_place, plan_place
from vcage.tasks.primitives.push import carry_out_push
from vcage.tasks.primitives.shake import carry_out_shake
from vcage.tasks.retries import Retry
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import Slot
from vcage.tasks.use import Use
from vcage.tasks.workcell import TaskFailed, failing_at


@dataclass(frozen=True)
class Asked:
    """The question to the critic after a sub-task."""

    text: str
    goals: list[Goal]


class Task(Use):
    """One attempt at one sub-task in a world.

    Args:
        world: where it happens; each arm is at home or holds something up.
        objects: by id, with their geometry; poses are read from the world.
        slots: object id → where it goes.
        retry: what earlier attempts at the same sub-task failed for; the first attempt when not given.

    Attributes:
        moment: state of the world at the end of a press, during a scan, with a tool on what it hits or where it begins
            to wipe, with both hands on a handed-over object, at the start of a wait, at the first lean of a shake, at a
            release, with a vessel tipped, or while something is held up.
        later: state of the world where a stroke of wiping ends, far from where it began, or at the last lean of a
            shake.
    """

    def __init__(
        self, world: World, objects: Mapping[str, SceneObject], slots: Mapping[str, Slot], retry: Retry | None = None
    ):
        super().__init__(world, objects, slots, retry)
        self._grip: Grip | None = None
        self._keeping = world.keeping

    def pick(self, object_id: str, grasps: Sequence[tuple[int, str]], hand_to: str | None = None) -> None:
        """Grasp an object with the first of ``grasps`` (contact point, arm) from which it can be brought to its slot.

        Where none leads to the slot, other slots are tried. The object is lifted with the motion that follows.

        Args:
            object_id: the object to pick.
            grasps: (contact point, arm) to try, in this order.
            hand_to: the receiving arm, which brings it to its slot; None without a hand-over.

        Raises:
            TaskFailed: none can be planned, or the fingers closed on nothing.
            UnknownName: there is no such object, contact point or arm.
        """
        plan = self._choose(self._cell.object(object_id), grasps, hand_to)
        self._grip = carry_out_pick(self._cell, plan)

    def hand_over(self, to: str) -> None:
        """Let another arm take the picked object, between the two in the air; the giving arm goes home.

        Args:
            to: the arm that takes it.

        Raises:
            TaskFailed: nothing is held any more, no way can be planned, or the other arm does not get hold of it.
            UnknownName: there is no such arm.
        """
        if self._grip is None:
            raise TaskFailed("grasp", "nothing was picked up before handing it over")
        grip, slots = self._grip, list(self._left)
        self._grip, self.moment = self._handing(grip.object_id, to, slots[0] if slots else None).run(grip)
        self._left = iter(slots)

    def wait(self, seconds: float) -> None:
        """Let time pass; a picked object is lifted first, and held.

        Raises:
            TaskFailed: it cannot be lifted, or slips out of the fingers.
        """
        if self._grip is not None:
            self._lift(self._grip)
            self._lift_on(self._grip)
        self.moment = self.world.state()
        self.world.step(round(seconds * PHYSICS_HZ))

    def hold(self) -> None:
        """Lift the picked object and hold it, whatever the other arms do next.

        Raises:
            TaskFailed: nothing is held any more, or it cannot be lifted, or slips out of the fingers.
        """
        if self._grip is None:
            raise TaskFailed("grasp", "nothing was picked up before it is held")
        self.wait(HOLDING.held_s)
        feel(self._cell, self._grip)
        self.moment = self.world.state()

    def hold_with_both(self, object_id: str) -> None:
        """Take an object with two hands, lift it with both arms at once, and hold it.

        Args:
            object_id: the object to hold.

        Raises:
            TaskFailed: no way can be planned, or a hand does not get hold of it or loses it.
            UnknownName: there is no such object.
        """
        plan = plan_with_both(self._cell, self._cell.object(object_id), skip=len(self._retry.failed))
        self.moment = carry_out_with_both(self._cell, plan)

    def shake(self) -> None:
        """Lift the picked object, and tilt it to and fro in the air.

        Raises:
            TaskFailed: nothing is held any more, no way can be planned, or it slips out of the fingers or tilts between
                them.
        """
        if self._grip is None:
            raise TaskFailed("grasp", "nothing was picked up before it is shaken")
        self._lift(self._grip)
        self.moment, self.later = carry_out_shake(self._cell, self._grip)

    def _lift_on(self, grip: Grip) -> None:
        """Lift an object that turns between the fingers so high that all of it stays in the air while it does.

        Where the arm does not reach so high it stays where it is: the object may be high enough.
        """
        cell, arm = self._cell, self.world.arms[grip.arm]
        below = hangs_below(cell.object(grip.object_id), arm.tool_pose.p, arm.arm.gripper, arm.finger_width)
        short = HOLDING.clear_m + below - (arm.tool_pose.p[2] - self.world.table.height)
        if short <= 0:
            return
        higher = Pose(arm.tool_pose.p + [0.0, 0.0, short], arm.tool_pose.q)
        with suppress(MotionFailed):
            path = cell.planner(grip.arm).line(cell.begun(grip.arm).end, higher, grip.carrying)
            with minding(cell, grip):
                cell.carry_out(grip.arm, path)
            now = cell.held(grip.object_id, arm.tool_pose)
            self._grip = replace(grip, load=replace(grip.load, held=now))

    def place(self, receptacle_id: str = TABLE, point: int | None = None) -> None:
        """Carry the held object to its slot in the receptacle or on the table, or to another free one, and let it go.

        The hand retreats with the following motion. Slots are planned for the whole chain in advance, so
        the place named here only repeats the plan.

        Args:
            receptacle_id: what receives it, or ``table``.
            point: id of the receptacle's functional point; that of the slot when not given.

        Raises:
            TaskFailed: nothing is held any more, its slot is elsewhere, or no path can be planned.
            UnknownName: the held object has no slot.
        """
        if self._grip is None:
            raise TaskFailed("grasp", "nothing was picked up before placing")
        feel(self._cell, self._grip)
        held, objects = self._grip.object_id, self._cell.objects()
        if held not in self._slots:
            raise UnknownName("slot", held, self._slots)
        planned = self._slots[held]
        if receptacle_id != planned.receptacle or point not in (None, planned.point):
            there, here = _place_words(planned.receptacle, planned.point), _place_words(receptacle_id, point)
            message = f"{held} cannot be put at {here}: its slot was planned at {there}"
            raise TaskFailed("plan", message, exhausted=True)
        around = Surroundings.of(self._cell, held, planned.receptacle, planned.point)
        choices = ((slot, slot.poses(objects)) for slot in self._left)
        plan, slot = plan_place(self._cell, self._grip, around, choices)
        self._say_slot(held, slot)
        carry_out_place(self._cell, plan)
        self.moment = self.moment or self.world.state()
        self._grip = None

    def push(self, object_id: str, arms: Sequence[str] = ()) -> None:
        """Push an object straight along the table to its slot, or another that is free.

        The hand is drawn back with the motion that follows.

        Args:
            object_id: the object to push; without contents.
            arms: the allowed ones, best first; all, the nearest first, when none is given.

        Raises:
            TaskFailed: no way can be planned, or the object is not where it was pushed to.
            UnknownName: there is no such object or arm, or the object has no slot.
        """
        thing = self._cell.object(object_id)
        carry_out_push(self._cell, thing, self._choose_push(thing, arms))

    def operate(self, object_id: str, contact_id: int, target: float, arms: Sequence[str] = ()) -> None:
        """Bring a moving part to a joint position by its handle or button, and the arm home again.

        Args:
            object_id: the object that the part belongs to.
            contact_id: contact point on the part.
            target: position of the part's joint, metres or radians; a pressed part may spring back.
            arms: the allowed ones, best first; all, the nearest first, when none is given.

        Raises:
            TaskFailed: no way can be planned, the fingers miss the handle, or the part did not get there.
            UnknownName: there is no such object, contact point or arm.
        """
        operation, plan = self._choose_operation(object_id, contact_id, target, arms)
        operation.run(plan)
        self.moment = operation.moment
        self.home()
        operation.confirm()

    def home(self) -> None:
        """Bring every arm home, open the grippers, and wait until everything is at rest.

        An arm that held something when the task began goes on holding it.
        """
        for name, control in self.world.arms.items():
            if name in self._keeping:
                continue
            begun, home = self._cell.begun(name), np.array(control.arm.home)
            if np.abs(begun.points() - home).max() > 1e-3:
                with failing_at("place"):
                    way = self._cell.planner(name).move(begun.end, home)
                first, *others = way.legs
                self._cell.carry_out(name, begun.then(JointPath((replace(first, opens=1.0), *others))))
            control.release(1.0)
        self.world.settle(max_steps=PHYSICS_HZ)

    def ask(self, text: str, goals: Sequence[Sequence[str | None]]) -> Asked:
        """The question for the critic: the sub-task in words, and its goals (subject, relation, reference, part)."""
        return Asked(text, [goal_of(values) for values in goals])


def _place_words(receptacle_id: str, point: int | None) -> str:
    return receptacle_id if point is None else f"functional point {point} of {receptacle_id}"
