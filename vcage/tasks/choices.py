"""The choices of a task: grasps, slots and ways that are not known to fail, planned before anything moves."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from vcage.base.errors import UnknownName
from vcage.base.geometry import Pose
from vcage.schema.asset import ContactPoint
from vcage.sim.collision import Held
from vcage.sim.motion import MotionPlanner
from vcage.sim.world import World
from vcage.tasks.meeting import Hold
from vcage.tasks.primitives.hand_over import HandOver
from vcage.tasks.primitives.operate import OperatePlan, Operation
from vcage.tasks.primitives.pick import KnownPaths, LeadsOn, PickPlan, PickWay, plan_pick
from vcage.tasks.primitives.place import Surroundings
from vcage.tasks.primitives.push import PushPlan, plan_push
from vcage.tasks.retries import Retry
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import Slot, other_slots
from vcage.tasks.workcell import TaskFailed, Workcell


class Choices:
    """Chooses for one attempt at a sub-task, around all that stands where it stands now.

    Args:
        world: where it happens.
        objects: by id, with their geometry; poses are read from the world.
        slots: object id → where it goes.
        retry: failures of earlier attempts at the same sub-task; the first attempt when not given.

    Attributes:
        arm, contact: that took hold of something.
        slot: where it goes, once that is chosen.
        changes: deviations from the plan, in words.
    """

    def __init__(
        self, world: World, objects: Mapping[str, SceneObject], slots: Mapping[str, Slot], retry: Retry | None = None
    ):
        self.world = world
        self.arm: str | None = None
        self.contact: int | None = None
        self.slot: Slot | None = None
        self.changes: list[str] = []
        self._cell = Workcell(world, objects)
        self._slots = slots
        self._retry = retry or Retry()
        self._left: Iterator[Slot] = iter(())

    def _choose(self, target: SceneObject, grasps: Sequence[tuple[int, str]], hand_to: str | None) -> PickPlan:
        """The first grasp that leads to the object's slot, else to another; any grasp for an object without a slot."""
        failures: list[TaskFailed] = []
        places = self._slots_of(target.id) if target.id in self._slots else [None]
        choices, known = self._retry.choices(grasps, places), KnownPaths()
        for slot, some in choices:
            try:
                plan = plan_pick(self._cell, target, some, self._leading_on(target, slot, hand_to), known)
            except TaskFailed as error:
                failures.append(error)
            else:
                self.slot = slot
                self._say_grasp(plan, grasps)
                places = itertools.chain([slot], (other for other, _ in choices))
                self._left = (one for one in places if one is not None)
                return plan
        raise failures[0]

    def _choose_push(self, thing: SceneObject, arms: Sequence[str]) -> PushPlan:
        """The first way to push an object to its slot, or to another that is free."""
        if thing.id not in self._slots:
            raise UnknownName("slot", thing.id, self._slots)
        failures: list[TaskFailed] = []
        ways = [(None, arm) for arm in dict.fromkeys(arms) or self._nearest_first(thing)]
        for slot, some in self._retry.choices(ways, self._slots_of(thing.id)):
            try:
                plan = plan_push(self._cell, thing, slot.pose, [arm for _, arm in some])
            except TaskFailed as error:
                failures.append(error)
                continue
            self.arm = plan.arm
            self._say_slot(thing.id, slot)
            return plan
        raise failures[0]

    def _choose_operation(
        self, object_id: str, contact_id: int, target: float, arms: Sequence[str]
    ) -> tuple[Operation, OperatePlan]:
        """The way to operate a part that is not known to fail."""
        for arm in arms:
            if arm not in self.world.arms:
                raise UnknownName("arm", arm, self.world.arms)
        thing = self._cell.object(object_id)
        contact = thing.asset.annotation.contact_point(contact_id)
        operation = Operation(self._cell, thing, contact, target)
        plan, first = operation.choose(list(arms) or self._nearest_first(thing), len(self._retry.failed))
        self.arm, self.contact = plan.arm, contact_id
        if not first:
            self.changes.append(f"{object_id} is operated in another way, with the {plan.arm} arm")
        return operation, plan

    def _leading_on(self, target: SceneObject, slot: Slot | None, hand_to: str | None) -> LeadsOn:
        """Return the check of where a grasp must lead: to a slot or a hand-over, or nowhere."""
        if hand_to is not None:
            return self._handing(target.id, hand_to, slot).leads_on
        if slot is None:
            return lambda *_: None
        around = Surroundings.of(self._cell, target.id, slot.receptacle, slot.point)
        return self._leads_to(target, around, slot.poses(self._cell.objects()))

    def _leads_to(self, target: SceneObject, around: Surroundings, *places: Sequence[Pose]) -> LeadsOn:
        """Return the check that an object can be brought to each place, at one of its poses there."""

        def check(planner: MotionPlanner, way: PickWay, lifted: np.ndarray, contact: ContactPoint) -> None:
            held = self._cell.held(target.id, way.grasp)
            for poses in places:
                around.check(planner, lifted, held, target.asset.grasp_width(contact), poses)

        return check

    def _handing(self, object_id: str, to: str, slot: Slot | None) -> HandOver:
        """The hand-over of an object to an arm that can then bring it to its slot, if it has one."""
        if to not in self.world.arms:
            raise UnknownName("arm", to, self.world.arms)
        if slot is None:
            return HandOver(self._cell, object_id, to)
        target = self._cell.object(object_id)
        around = Surroundings.of(self._cell, object_id, slot.receptacle, slot.point)
        poses, planner = slot.poses(self._cell.objects()), self._cell.planner_among(to, {}, {})

        def suits(hold: Hold) -> None:
            held = Held(object_id, target.asset.model, hold.in_object.inverse(), target.joints)
            around.check(planner, planner.kinematics.home, held, hold.width, poses)

        return HandOver(self._cell, object_id, to, suits)

    def _slots_of(self, object_id: str) -> list[Slot]:
        """The slot that was planned, then others."""
        return [self._slots[object_id], *other_slots(self._slots, object_id, self._cell.objects())]

    def _say_grasp(self, plan: PickPlan, grasps: Sequence[tuple[int, str]]) -> None:
        self.arm, self.contact = plan.arm, plan.contact
        if (plan.contact, plan.arm) != grasps[0]:
            planned = f"contact {grasps[0][0]} with the {grasps[0][1]} arm"
            self.changes.append(f"contact {plan.contact} with the {plan.arm} arm instead of {planned}")

    def _say_slot(self, object_id: str, slot: Slot) -> None:
        self.slot, planned = slot, self._slots[object_id].pose
        if slot.pose != planned:
            x, y = 100 * (slot.pose.p - planned.p)[:2]
            self.changes.append(f"{object_id} is put {x:+.1f}, {y:+.1f} cm from the slot that was planned")

    def _nearest_first(self, thing: SceneObject) -> list[str]:
        """The arms, the one with the base nearest to an object first."""
        bases = {name: control.arm.base.pose().p for name, control in self.world.arms.items()}
        return sorted(bases, key=lambda name: (float(np.linalg.norm(bases[name] - thing.pose.p)), name))
