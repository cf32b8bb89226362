"""The choices of a task that uses a thing in a hand: shows it, hits or wipes with it, tips it, slides it."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from vcage.base.geometry import Pose
from vcage.schema.asset import ContactPoint
from vcage.schema.plan import TABLE
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import Load
from vcage.tasks.choices import Choices
from vcage.tasks.feasibility import picks
from vcage.tasks.grasps import approach_opening, command_of
from vcage.tasks.hanging import hanging_ways
from vcage.tasks.hitting import free_hitting_poses, hitting_poses
from vcage.tasks.inserting import inserting_ways
from vcage.tasks.pouring import SETTINGS as POURING
from vcage.tasks.pouring import pouring_ways, suits, tipped_to
from vcage.tasks.primitives.along import require_along
from vcage.tasks.primitives.pick import KnownPaths, LeadsOn, PickPlan, PickWay, plan_pick
from vcage.tasks.primitives.place import Surroundings
from vcage.tasks.primitives.slide import INTO_A_HOLE, OVER_A_PEG, Sliding
from vcage.tasks.primitives.wipe import require_way
from vcage.tasks.reading import SETTINGS as READING
from vcage.tasks.reading import free_reading_poses, reading_poses
from vcage.tasks.scene_objects import Obstacles, SceneObject
from vcage.tasks.state import lying_on
from vcage.tasks.ways import continuous_path
from vcage.tasks.wiping import free_wiping_ways, wiping_ways
from vcage.tasks.workcell import TaskFailed


class UseChoices(Choices):
    """Chooses grasps that lead to where a thing is used, and to the ways that it takes there."""

    def _choose_showing(
        self, object_id: str, other_id: str, grasps: Sequence[tuple[int, str]], tight: bool
    ) -> tuple[PickPlan, Surroundings, Iterator[list[Pose]]]:
        """The first grasp that can hold an object before another, its surroundings, and the groups of poses there, from
        the one on to which the grasp leads.

        Args:
            object_id, other_id, grasps: see :meth:`vcage.tasks.task.Task.show`.
            tight: True to try last the turns that no plan counts on, and the poses without room to sway: things may
                have been put down some millimetres and degrees beside their places.
        """
        target, cell = self._cell.object(object_id), self._cell
        other, height = cell.object(other_id), self.world.table.height
        beside = cell.objects_but(object_id, other_id, *cell.contents(object_id))
        groups = free_reading_poses(target, other, beside, height)
        if tight:
            reserve = free_reading_poses(target, other, beside, height, READING.reserve_turns_deg)
            swaying = (list(reading_poses(target, other, height, rise)) for rise in READING.raises_m)
            groups = itertools.chain(groups, reserve, swaying)
        return self._choose_using(target, groups, grasps, f"before {other_id}")

    def _choose_hitting(
        self, tool_id: str, thing_id: str, grasps: Sequence[tuple[int, str]], tight: bool
    ) -> tuple[PickPlan, Surroundings, list[Pose]]:
        """The first grasp that can hold a tool over an object, its surroundings, and its poses there.

        Args:
            tool_id, thing_id, grasps: see :meth:`vcage.tasks.task.Task.hit`.
            tight: True to take poses without room around them where there are no others: things may have been put
                down some millimetres beside their places, and the planner finds what is free then.
        """
        tool, cell = self._cell.object(tool_id), self._cell
        thing, others = cell.object(thing_id), cell.objects_but(tool_id, thing_id, *cell.contents(tool_id))
        free, _ = free_hitting_poses(tool, thing, others)
        poses = free or (list(hitting_poses(tool, thing)) if tight else [])
        plan, hover, groups = self._choose_using(tool, iter([poses]), grasps, f"over {thing_id}")
        return plan, hover, next(groups)

    def _choose_wiping(
        self, tool_id: str, thing_id: str, grasps: Sequence[tuple[int, str]], tight: bool
    ) -> tuple[PickPlan, Surroundings, list[Pose]]:
        """The first grasp that can draw a tool over an object, its surroundings, and its way over that.

        Args:
            tool_id, thing_id, grasps: see :meth:`vcage.tasks.task.Task.wipe`.
            tight: as of :meth:`_choose_hitting`.

        Raises:
            TaskFailed: also where something lies on the object.
        """
        tool, cell = self._cell.object(tool_id), self._cell
        thing, others = cell.object(thing_id), cell.objects_but(tool_id, thing_id, *cell.contents(tool_id))
        if lying := lying_on(thing, [*others, tool]):
            what = f"the {lying[0].record.phrase} lies on the {thing.record.phrase}"
            raise TaskFailed("plan", f"{what}, which is wiped when it is empty", exhausted=True)
        free, _ = free_wiping_ways(tool, thing, others)
        ways = free or (list(wiping_ways(tool, thing)) if tight else [])
        plan, hover, groups = self._choose_using(tool, iter(ways), grasps, f"over {thing_id}", self._strokes)
        return plan, hover, next(groups)

    def _choose_pouring(
        self, vessel_id: str, target_id: str, grasps: Sequence[tuple[int, str]]
    ) -> tuple[PickPlan, Surroundings, Iterator[list[Pose]]]:
        """The first grasp that can tip a vessel over a container, its surroundings, and its ways there.

        Args:
            vessel_id, target_id, grasps: see :meth:`vcage.tasks.task.Task.pour`.
        """
        vessel, target = self._cell.object(vessel_id), self._cell.object(target_id)
        in_turn = [grasp for _, some in self._retry.choices(grasps, [None]) for grasp in some]
        ways = self._followed(vessel, target, in_turn)
        return self._choose_using(vessel, ways, grasps, f"over {target_id}", self._tipping)

    def _choose_hanging(
        self, thing_id: str, rack_id: str, grasps: Sequence[tuple[int, str]]
    ) -> tuple[PickPlan, Surroundings, Iterator[list[Pose]]]:
        """The first grasp that can slide a thing over a peg, its surroundings, and its ways there.

        Args:
            thing_id, rack_id, grasps: see :meth:`vcage.tasks.task.Task.hang`.
        """
        thing, rack = self._cell.object(thing_id), self._cell.object(rack_id)
        ways = hanging_ways(thing, rack, self._cell.objects_but(thing_id))
        return self._choose_using(thing, ways, grasps, f"on {rack_id}", partial(self._sliding, OVER_A_PEG))

    def _choose_inserting(
        self, thing_id: str, place_id: str, grasps: Sequence[tuple[int, str]]
    ) -> tuple[PickPlan, Surroundings, Iterator[list[Pose]]]:
        """The first grasp that can slide a thing into a hole, its surroundings, and its ways there.

        Args:
            thing_id, place_id, grasps: see :meth:`vcage.tasks.task.Task.insert`.
        """
        thing, place = self._cell.object(thing_id), self._cell.object(place_id)
        others = self._cell.objects_but(thing_id)
        in_turn = [contact for _, some in self._retry.choices(grasps, [None]) for contact, _ in some]
        contacts = map(thing.asset.annotation.contact_point, dict.fromkeys(in_turn))
        ways = (way for contact in contacts for way in inserting_ways(thing, place, contact, others))
        return self._choose_using(thing, ways, grasps, f"in {place_id}", partial(self._sliding, INTO_A_HOLE))

    def _sliding(self, sliding: Sliding, target: SceneObject, hover: Surroundings, way: list[Pose]) -> LeadsOn:
        """Return the check that a thing can be slid along a way, and the hand drawn back where it ends."""

        def check(planner: MotionPlanner, pick: PickWay, lifted: np.ndarray, contact: ContactPoint) -> None:
            gripper, width = planner.kinematics.arm.gripper, target.asset.grasp_width(contact)
            load = Load(command_of(width, gripper), self._cell.held(target.id, pick.grasp))
            end = require_along(planner, lifted, load, way, f"{sliding.where} is out of reach")
            planner.check(end, Load(command_of(approach_opening(width, gripper), gripper), ignore=[target.id]))
            here = planner.kinematics.fk(end)
            if not planner.continues(end, [Pose(here.p + [0.0, 0.0, gripper.approach], here.q)]):
                raise MotionFailed("the hand could not be drawn back")

        return check

    def _followed(
        self, vessel: SceneObject, target: SceneObject, grasps: Sequence[tuple[int, str]]
    ) -> Iterator[list[Pose]]:
        """The ways of a vessel over a container that an arm with a grasp can go, obstacles aside."""
        others = tuple(self._cell.objects_but(vessel.id, *self._cell.contents(vessel.id)))
        for contact_id, arm in grasps:
            kinematics = self._cell.planner(arm).kinematics
            ways = [*pouring_ways(vessel, target, vessel.asset.annotation.contact_point(contact_id))]
            for pick in picks(vessel, contact_id, others, arm, kinematics, self.world.table.height):
                if pick.path is not None:
                    held, start = pick.grasp.in_object, pick.path[-1]
                    free = (way for way in ways if continuous_path(kinematics, way, held, start) is not None)
                    yield from itertools.islice(free, POURING.ways_of_a_hold)

    def _tipping(self, target: SceneObject, hover: Surroundings, way: list[Pose]) -> LeadsOn:
        """Return the check that a vessel can be tipped along a way, with no finger where its contents roll."""
        back = self._leads_to(target, hover, [target.pose])

        def check(planner: MotionPlanner, pick: PickWay, lifted: np.ndarray, contact: ContactPoint) -> None:
            if not suits(target, contact, tipped_to(way)):
                raise MotionFailed("a finger is where its contents roll out")
            held = self._cell.held(target.id, pick.grasp)
            load = Load(command_of(target.asset.grasp_width(contact), planner.kinematics.arm.gripper), held)
            require_along(planner, lifted, load, way, "the place over the container is out of reach")
            back(planner, pick, lifted, contact)

        return check

    def _strokes(self, target: SceneObject, hover: Surroundings, way: list[Pose]) -> LeadsOn:
        """Return the check that a tool can be drawn along a way, and the hand touches nothing beside the tool."""
        leads = self._leads_to(target, hover, *([pose] for pose in way), [target.pose])

        def check(planner: MotionPlanner, pick: PickWay, lifted: np.ndarray, contact: ContactPoint) -> None:
            leads(planner, pick, lifted, contact)
            held = self._cell.held(target.id, pick.grasp)
            load = Load(command_of(target.asset.grasp_width(contact), planner.kinematics.arm.gripper), held)
            require_way(planner, lifted, load, way)

        return check

    def _choose_using(
        self,
        target: SceneObject,
        groups: Iterator[list[Pose]],
        grasps: Sequence[tuple[int, str]],
        where: str,
        leading: Callable[[SceneObject, Surroundings, list[Pose]], LeadsOn] | None = None,
    ) -> tuple[PickPlan, Surroundings, Iterator[list[Pose]]]:
        """The first grasp that brings an object to a pose in the air, and back; its surroundings there, and the groups
        of poses from the one on to which the grasp leads.

        Args:
            target: the object.
            groups: of poses in the air, in the order in which they are tried.
            grasps: see :meth:`vcage.tasks.task.Task.show`.
            where: the poses are, in words.
            leading: returns the check of where a grasp must lead; to one pose of a group, and back, when not given.
        """
        # Where it came from the hand has room, and in the air it lets go of nothing: no obstacle raises it, and held
        # higher it would read or reach nothing.
        hover = replace(
            Surroundings.of(self._cell, target.id, TABLE, None), obstacles=Obstacles([]), raises=(), hovers=where
        )
        in_turn = [grasp for _, some in self._retry.choices(grasps, [None]) for grasp in some]
        failures, known = list[TaskFailed](), KnownPaths()
        for poses in filter(None, groups):
            leads = (leading or self._to_one)(target, hover, poses)
            try:
                plan = plan_pick(self._cell, target, in_turn, leads, known)
            except TaskFailed as error:
                failures.append(error)
            else:
                self._say_grasp(plan, grasps)
                return plan, hover, itertools.chain([poses], groups)
        raise failures[0] if failures else TaskFailed("plan", f"{target.id} cannot be held {where}", exhausted=True)

    def _to_one(self, target: SceneObject, hover: Surroundings, poses: list[Pose]) -> LeadsOn:
        """Return the check that an object can be brought to one of some poses, and back."""
        return self._leads_to(target, hover, poses, [target.pose])
