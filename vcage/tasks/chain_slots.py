"""Slots for a chain: side by side in receptacles where the hand drops things least, and clear of all on the table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice, repeat

import numpy as np

from vcage.base.attempts import LIMITS, GaveUp, first_accepted, least_costly
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.schema.plan import TABLE
from vcage.schema.subtasks import Grasp, Subtask
from vcage.tasks.feasibility import Transfer, feasible, transfers
from vcage.tasks.grasps import GraspPose
from vcage.tasks.hand_poses import hand_poses
from vcage.tasks.primitives.place_way import SET_DOWN, place_way
from vcage.tasks.scene_objects import Obstacles, SceneObject
from vcage.tasks.slots import Slot, allocate, arrangements, heading_for, lying_in, opened_for, slot_in
from vcage.tasks.templates.push import examine_pushes
from vcage.tasks.workplace import Workplace

UNREACHED_M = 1.0
"""Drop counted for a place that no arm reaches, metres: more than any real one."""


def slots_for_chain(chain: Sequence[Subtask], workplace: Workplace, drawn: bool = False) -> dict[str, Slot]:
    """A slot for each sub-task that puts an object somewhere, by the sub-task's id.

    Simultaneous contents of one place fit together, and the hand has room to let go of each.

    Args:
        chain: the sub-tasks.
        workplace: with all arms of the robot.
        drawn: at random on receptacles, too: else places there follow from sizes.

    Raises:
        InfeasibleScene: the contents of one receptacle do not fit together, or something has no place on the table.
    """
    objects = dict(workplace.by_id)
    slots: dict[str, Slot] = {}
    for stays in _together(_stays(chain, workplace.objects)):
        receptacle, point = stays[0].receptacle, stays[0].point
        objects[receptacle] = opened_for(objects[receptacle], point)
        filling = _Filling(
            [stay.subtask for stay in stays if stay.subtask is not None],
            objects[receptacle],
            point,
            [objects[stay.object] for stay in stays if stay.subtask is None],
            objects,
            workplace,
            drawn,
        )
        poses = filling.poses()
        slots |= {
            s.id: slot_in(objects[receptacle], point, poses[s.object], s.goals, objects[s.object])
            for s in filling.subtasks
        }
    try:
        propose = _OnTable(chain, objects, slots, workplace).slots
        return slots | first_accepted(repeat(propose, LIMITS.table_slot_sets), InfeasibleScene).value
    except GaveUp as error:
        raise error.refusals[-1] from None


@dataclass(frozen=True)
class _Stay:
    """An object in one place for a while.

    Args:
        object, receptacle, point: the object and its place.
        subtask: the one that brings it; None for a content from the start.
        start, end: steps of the chain: it comes with the first and is taken away with the second.
    """

    object: str
    receptacle: str
    point: int
    subtask: Subtask | None
    start: float
    end: float

    def meets(self, other: _Stay) -> bool:
        """True if both are in one place at the same time."""
        here = (self.receptacle, self.point) == (other.receptacle, other.point)
        return here and self.start < other.end and other.start < self.end


def _stays(chain: Sequence[Subtask], objects: Sequence[SceneObject]) -> list[_Stay]:
    """The stays of all objects in each receptacle that the chain fills.

    An object there from the start may be at each functional point of its part.
    """
    by_id = {o.id: o for o in objects}

    def taken_away(name: str, after: int) -> float:
        return next((k for k, s in enumerate(chain) if k > after and s.object == name and s.receptacle), np.inf)

    brought = [
        _Stay(s.object, s.receptacle, s.functional_point, s, k, taken_away(s.object, k))
        for k, s in enumerate(chain)
        if s.receptacle is not None and s.functional_point is not None
    ]
    places = dict.fromkeys((stay.receptacle, stay.point) for stay in brought)
    there = [
        _Stay(o.id, receptacle, point, None, -1, taken_away(o.id, -1))
        for receptacle, point in places
        for o in lying_in(by_id[receptacle], by_id[receptacle].asset.annotation.functional_point(point), objects)
    ]
    return [*there, *brought]


def _together(stays: Sequence[_Stay]) -> list[list[_Stay]]:
    """Groups of stays in one place that overlap in time, directly or by others, in the order of the chain. At least one
    stay of each group is brought about by a sub-task."""
    groups: list[list[_Stay]] = []
    for stay in stays:
        touching = [group for group in groups if any(stay.meets(other) for other in group)]
        groups = [group for group in groups if group not in touching]
        groups.append([*(s for group in touching for s in group), stay])
    return [group for group in groups if any(stay.subtask is not None for stay in group)]


@dataclass(frozen=True)
class _Filling:
    """Sub-tasks that bring objects to one functional point, one after the other.

    Args:
        subtasks: in order.
        receptacle, point: the place; its drawer or lid is open.
        present: objects already there.
        objects: of the scene by id, at their starting places.
        workplace: of the scene.
        drawn: places are drawn at random on a receptacle, too. In one they always are: reach into it differs.
    """

    subtasks: Sequence[Subtask]
    receptacle: SceneObject
    point: int
    present: Sequence[SceneObject]
    objects: Mapping[str, SceneObject]
    workplace: Workplace
    drawn: bool

    def poses(self) -> dict[str, Pose]:
        """Poses in the receptacle's frame, by id, from which the objects fall least.

        Raises:
            InfeasibleScene: they do not fit together.
        """
        brought = [self.objects[s.object] for s in self.subtasks]
        asked = {s.object: heading_for(s.goals, self.receptacle, self.point) for s in self.subtasks}
        headings = {name: heading for name, heading in asked.items() if heading is not None}
        asked_for = (self.receptacle, self.point, brought)
        if self.drawn or self.receptacle.asset.annotation.functional_point(self.point).holds != "on":
            draw = partial(allocate, *asked_for, self.workplace.rng, self.present, headings)
            found = (draw() for _ in range(LIMITS.compared_slots))
        else:
            found = iter(arrangements(*asked_for, self.present, headings)[: LIMITS.compared_slots])
        return least_costly(found, self._drop, enough=SET_DOWN * len(self.subtasks) + 1e-9)

    def _drop(self, poses: Mapping[str, Pose]) -> float:
        """Total fall of the objects, metres, when each is let go as low as the hand can.

        A place that no arm reaches with the object counts as a fall of :data:`UNREACHED_M`.
        """
        obstacles = [*self.receptacle.around(self.point), *(o.box for o in self.present)]
        total = 0.0
        for subtask in self.subtasks:
            target, drops, around = self.objects[subtask.object], [], Obstacles(obstacles)
            slot = slot_in(self.receptacle, self.point, poses[target.id], subtask.goals, target)
            goals = slot.poses({self.receptacle.id: self.receptacle})
            for grasp in {grasp.contact: grasp for grasp in subtask.grasps}.values():
                width = target.asset.grasp_width(target.asset.annotation.contact_point(grasp.contact))
                held = _holds(grasp, target, self.workplace)[0].in_object
                gripper = self.workplace.kinematics[grasp.arm].arm.gripper
                drops += [place_way(held, goal, around, gripper, width, goal.p[2]).drop for goal in goals]
            total += min(drops, default=0.0) + UNREACHED_M * (not self._reached(subtask, target, goals))
            obstacles.append(target.moved(goals[0]).box)
        return total

    def _reached(self, subtask: Subtask, target: SceneObject, goals: Sequence[Pose]) -> bool:
        """True if an arm that can take an object brings it to one of its poses with some grasp of it."""
        others = [self.objects[o.id] for o in self.workplace.objects if o.id != target.id]
        return _some_arm_brings(subtask, transfers(target, self.receptacle, self.point, goals, others), self.workplace)


def _some_arm_brings(subtask: Subtask, ways: Mapping[int, Transfer], workplace: Workplace) -> bool:
    """True where an arm that can take an object can do one of some transfers of it; what changes hands is not
    examined."""
    return subtask.hand_to is not None or any(True for _ in feasible(ways, workplace.with_arms(subtask.arm)))


def _holds(grasp: Grasp, target: SceneObject, workplace: Workplace) -> Sequence[GraspPose]:
    """Poses of the hand at the contact point of a grasp, the straightest first."""
    contact = target.asset.annotation.contact_point(grasp.contact)
    gripper = workplace.kinematics[grasp.arm].arm.gripper
    return hand_poses(target, contact, gripper)


@dataclass(frozen=True)
class _OnTable:
    """The part of a chain that puts down or pushes objects on the table.

    Args:
        chain: the sub-tasks.
        objects: by id where they stand at the start, drawers and lids open that will be.
        taken: slots of the sub-tasks that put something into or onto others.
        workplace: of the scene.
    """

    chain: Sequence[Subtask]
    objects: Mapping[str, SceneObject]
    taken: Mapping[str, Slot]
    workplace: Workplace

    def slots(self) -> dict[str, Slot]:
        """Slots clear of all past, present and future objects there.

        Raises:
            InfeasibleScene: one has no room, perhaps because of where those before it were drawn.
        """
        now, found = dict(self.objects), dict[str, Slot]()
        for subtask in self.chain:
            if subtask.receptacle is None:
                continue
            thing = self.objects[subtask.object]
            if subtask.id in self.taken:
                now[thing.id] = thing.moved(self.taken[subtask.id].poses(now)[0])
                continue
            others = [o for o in now.values() if o.id != thing.id]
            pushed = subtask.template == "push"
            poses = (self._pushed if pushed else self._put_down)(subtask, now[thing.id], others)
            if not poses:
                how = "push" if pushed else "put"
                reason = (
                    f"there is no room in reach on the table to {how} {thing.record.phrase} so that {subtask.goals[0]}"
                )
                raise InfeasibleScene(reason, hint="another --seed gives another layout")
            spare = tuple(poses[1 : 1 + LIMITS.spare_slots])
            found[subtask.id] = Slot(TABLE, None, poses[0], turns=(0.0,), spare=spare)
            now[thing.id] = thing.moved(poses[0])
        return found

    def _pushed(self, subtask: Subtask, thing: SceneObject, others: Sequence[SceneObject]) -> list[Pose]:
        """Ends of pushes for the goal, the best first."""
        pushes, _ = examine_pushes(thing, subtask.goals[0], self.workplace.with_arms(subtask.arm).with_objects(others))
        return [push.end for push in pushes]

    def _put_down(self, subtask: Subtask, thing: SceneObject, others: Sequence[SceneObject]) -> list[Pose]:
        """Free places, first one to which an arm can bring the object."""
        start, ground = self.objects[thing.id], self.workplace.ground
        taken = [start.aabb[:, :2], *(self.objects[s.object].aabb[:, :2] for s in self.chain)]
        free = ground.poses(start, subtask.goals[0], others, self.workplace.rng, taken)
        poses = list(islice(free, LIMITS.table_places))
        ways = ((pose, transfers(thing, None, None, [pose], others)) for pose in poses)
        works = next((pose for pose, way in ways if _some_arm_brings(subtask, way, self.workplace)), None)
        return poses if works is None else [works, *(pose for pose in poses if pose is not works)]
