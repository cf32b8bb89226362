"""Where each of the objects goes that a task puts somewhere: in a receptacle, or on the table.

The exact free-region placement of the scene (:mod:`vcage.layout.placement.place`) is used again, with the opening as
the workspace: what fits together gets places side by side, and what does not is refused by name. Of several ways to
put things side by side, the one is taken from which the hand that brings them drops them least.
"""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose, world_aabb
from vcage.layout.items import TableItem
from vcage.layout.placement.place import place
from vcage.schema.asset import FunctionalPoint
from vcage.schema.plan import TABLE
from vcage.schema.robot import Robot
from vcage.schema.subtasks import Subtask
from vcage.sim.joints import joint_index, joint_positions
from vcage.sim.kinematics import kinematics_of
from vcage.tasks.access import closed_part
from vcage.tasks.asked_arms import those_of
from vcage.tasks.feasibility import Transfer, examine
from vcage.tasks.grasps import grasp_poses
from vcage.tasks.ground import SPOTS, Ground
from vcage.tasks.primitives.place_way import SET_DOWN, place_way
from vcage.tasks.pushing import examine_pushes
from vcage.tasks.scene_objects import Obstacles, SceneObject
from vcage.tasks.truth import place_complaint

GAP = 0.006
"""Metres kept between contents, and between contents and wall."""

FLUSH = 1e-4
"""Room that what stands flush on its own like is given, metres."""

DRAWS = 8
"""Ways to put the contents of a receptacle side by side that are compared."""

UNREACHED = 1.0
"""Metres: more than anything falls."""

OTHERS = 6
"""Other slots that are drawn for an object that cannot be brought to its own."""


@dataclass(frozen=True)
class Slot:
    """Where an object goes.

    Args:
        receptacle: id of what receives it, or ``table``.
        point: id of the receptacle's functional point; None on the table.
        pose: object frame in the frame of the part that the point belongs to; on the table in the world.
        turns: headings that it may take there, relative to ``pose``, radians.
        spare: other poses that would do as well; on the table alone.
    """

    receptacle: str
    point: int | None
    pose: Pose
    turns: tuple[float, ...] = (0.0, np.pi)
    spare: tuple[Pose, ...] = ()

    def poses(self, objects: Mapping[str, SceneObject]) -> list[Pose]:
        """Of the object in the world, the receptacles standing as they do.

        Args:
            objects: by id.
        """
        frame = Pose() if self.point is None else objects[self.receptacle].frame(self.point)
        return [frame * self.pose * Pose.from_yaw([0, 0, 0], turn) for turn in self.turns]


def allocate(
    receptacle: SceneObject,
    functional_point: int,
    contents: Sequence[SceneObject],
    rng: np.random.Generator,
    present: Sequence[SceneObject] = (),
) -> dict[str, Pose]:
    """A place for each of ``contents`` in the receptacle: object frame in :meth:`SceneObject.frame`, by id.

    Args:
        receptacle: where they go.
        functional_point: id of the receptacle's functional point.
        contents: what goes there.
        rng: of all choices.
        present: what already lies there.

    Raises:
        InfeasibleScene: they do not fit together; names them and the area that is missing.
    """
    opening = receptacle.asset.opening(receptacle.asset.annotation.functional_point(functional_point))
    centre, half = np.array(opening.centre), room_for(receptacle, functional_point, contents) / 2
    inside = np.stack([centre - half, centre + half])
    to_receptacle = receptacle.frame(functional_point).inverse()
    taken = [world_aabb(o.asset.bounds, to_receptacle * o.pose)[:, :2] for o in present]
    items = [TableItem(id=o.id, size=tuple(o.asset.size), yaws=(0.0, np.pi / 2)) for o in contents]
    places = place(items, inside, rng, margin=GAP, obstacles=taken)
    return {key: Pose.from_yaw([at.x, at.y, opening.floor], at.yaw) for key, at in places.items()}


def room_for(receptacle: SceneObject, functional_point: int, contents: Sequence[SceneObject]) -> np.ndarray:
    """(2,) the part of an opening in which things may stand, metres: not too near to its walls."""
    point = receptacle.asset.annotation.functional_point(functional_point)
    size = np.array(receptacle.asset.opening(point).size)
    widest = np.max([np.sort(o.asset.footprint) for o in contents], axis=0)
    spare = float(np.min(np.sort(size) - widest)) / 2
    # On top of a thing of its own size an object stands flush: a block on a block.
    flush = point.holds == "on" and spare < GAP
    return size - 2 * (max(0.0, spare) - FLUSH if flush else GAP)


def slots_for_chain(
    chain: Sequence[Subtask], objects: Sequence[SceneObject], robot: Robot, ground: Ground, rng: np.random.Generator
) -> dict[str, Slot]:
    """A slot for each sub-task that puts an object somewhere, by the sub-task's id.

    All that lies in one place at the same time fits together, and the hand has room to let go of it.

    Args:
        chain: the sub-tasks.
        objects: of the scene.
        robot: whose hands bring them.
        ground: of the table.
        rng: of all choices.

    Raises:
        InfeasibleScene: the contents of one receptacle do not fit together, or something has no place on the table.
    """
    by_id = {o.id: o for o in objects}
    slots: dict[str, Slot] = {}
    for stays in _together(_stays(chain, objects)):
        receptacle, point = stays[0].receptacle, stays[0].point
        by_id[receptacle] = opened_for(by_id[receptacle], point)
        subtasks = [stay.subtask for stay in stays if stay.subtask is not None]
        present = [by_id[stay.object] for stay in stays if stay.subtask is None]
        best, least = {}, np.inf
        for _ in range(DRAWS):
            poses = allocate(by_id[receptacle], point, [by_id[s.object] for s in subtasks], rng, present)
            drop = _drop(subtasks, poses, by_id, present, robot, by_id[receptacle], point)
            best, least = (poses, drop) if drop < least else (best, least)
            if least <= SET_DOWN * len(subtasks) + 1e-9:
                break
        slots |= {s.id: Slot(receptacle, point, best[s.object]) for s in subtasks}
    return slots | _on_table(chain, by_id, slots, robot, ground, rng)


@dataclass(frozen=True)
class _Stay:
    """An object in one place for a while.

    Args:
        object, receptacle, point: what lies where.
        subtask: that brings it; None for what lies there from the start.
        start, end: steps of the chain: it comes with the first and is taken away with the second.
    """

    object: str
    receptacle: str
    point: int
    subtask: Subtask | None
    start: float
    end: float

    def meets(self, other: _Stay) -> bool:
        """Whether both are in one place at the same time."""
        here = (self.receptacle, self.point) == (other.receptacle, other.point)
        return here and self.start < other.end and other.start < self.end


def _stays(chain: Sequence[Subtask], objects: Sequence[SceneObject]) -> list[_Stay]:
    """Things in each receptacle, and for how long; what lies there from the start may lie at each of the points of
    the part that it lies in."""

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
    """The stays in one place that overlap in time, directly or by others, in the order of the chain; each at least one
    that a sub-task brings about."""
    groups: list[list[_Stay]] = []
    for stay in stays:
        touching = [group for group in groups if any(stay.meets(other) for other in group)]
        groups = [group for group in groups if group not in touching]
        groups.append([*(s for group in touching for s in group), stay])
    return [group for group in groups if any(stay.subtask is not None for stay in group)]


def _on_table(
    chain: Sequence[Subtask],
    objects: Mapping[str, SceneObject],
    slots: Mapping[str, Slot],
    robot: Robot,
    ground: Ground,
    rng: np.random.Generator,
) -> dict[str, Slot]:
    """Slots for what is put down on the table; where one leaves no room for a later one, all are drawn anew.

    Args: see :func:`_drawn_on_table`.
    """
    for _ in range(DRAWS - 1):
        with contextlib.suppress(InfeasibleScene):
            return _drawn_on_table(chain, objects, slots, robot, ground, rng)
    return _drawn_on_table(chain, objects, slots, robot, ground, rng)


def _drawn_on_table(
    chain: Sequence[Subtask],
    objects: Mapping[str, SceneObject],
    slots: Mapping[str, Slot],
    robot: Robot,
    ground: Ground,
    rng: np.random.Generator,
) -> dict[str, Slot]:
    """Slots for what is put down or pushed on the table: clear of all that stood, stands or will stand there.

    Args:
        objects: by id, drawers and lids open that will be.
        slots: of the sub-tasks that put something into or onto others.
        robot: whose hands push.
    """
    now, found = dict(objects), dict[str, Slot]()
    for subtask in chain:
        if subtask.receptacle is None:
            continue
        thing = objects[subtask.object]
        if subtask.id in slots:
            now[thing.id] = thing.moved(slots[subtask.id].poses(now)[0])
            continue
        others = [o for o in now.values() if o.id != thing.id]
        if subtask.template == "push":
            able = those_of(robot.arms, subtask.arm, None)
            arms = {name: kinematics_of(arm) for name, arm in able.items()}
            pushes, _ = examine_pushes(now[thing.id], subtask.goals[0], others, arms, ground)
            poses = [push.end for push in pushes]
        else:
            taken = [thing.aabb[:, :2], *(objects[s.object].aabb[:, :2] for s in chain)]
            poses = list(itertools.islice(ground.poses(thing, subtask.goals[0], others, rng, taken), SPOTS))
            works = next((p for p in poses if _feasible(subtask, now[thing.id], p, others, robot, ground)), None)
            poses = poses if works is None else [works, *(p for p in poses if p is not works)]
        if not poses:
            how = "push" if subtask.template == "push" else "put"
            reason = f"there is no room on the table to {how} {thing.record.phrase} so that {subtask.goals[0]}"
            raise InfeasibleScene(reason, hint="another --seed gives another layout")
        found[subtask.id] = Slot(TABLE, None, poses[0], turns=(0.0,), spare=tuple(poses[1 : 1 + OTHERS]))
        now[thing.id] = thing.moved(poses[0])
    return found


def _feasible(
    subtask: Subtask, thing: SceneObject, pose: Pose, others: Sequence[SceneObject], robot: Robot, ground: Ground
) -> bool:
    """Whether an arm that can take an object brings it to a place on the table: it passes the checks of a transfer."""
    arms = {grasp.arm: kinematics_of(robot.arms[grasp.arm]) for grasp in subtask.grasps}
    contacts = {grasp.contact: thing.asset.annotation.contact_point(grasp.contact) for grasp in subtask.grasps}
    return subtask.hand_to is not None or any(
        examine(Transfer.onto_table(thing, contact, [pose], others), arms, ground.height).feasible
        for contact in contacts.values()
    )


def _drop(
    subtasks: Sequence[Subtask],
    poses: Mapping[str, Pose],
    objects: Mapping[str, SceneObject],
    present: Sequence[SceneObject],
    robot: Robot,
    receptacle: SceneObject,
    point: int,
) -> float:
    """How far the objects fall in all when each is let go as low as the hand can, metres: one after the other.

    What no arm that can take it reaches its place with counts as falling :data:`UNREACHED`.

    Args:
        subtasks: that bring them to one functional point, in order.
        poses: in the receptacle's frame, by id.
        objects: of the scene by id.
        present: what lies in the receptacle already.
        robot: whose hands bring them.
        receptacle, point: where.
    """
    obstacles = [*receptacle.around(point), *(o.box for o in present)]
    total = 0.0
    for subtask in subtasks:
        target, drops, around = objects[subtask.object], [], Obstacles(obstacles)
        goals = Slot(receptacle.id, point, poses[target.id]).poses({receptacle.id: receptacle})
        hands = {grasp.contact: robot.arms[grasp.arm].gripper for grasp in subtask.grasps}
        for contact_id, gripper in hands.items():
            contact = target.asset.annotation.contact_point(contact_id)
            width = target.asset.grasp_width(contact)
            held = next(grasp_poses(target.pose, contact, gripper, target.box.bottom)).in_object
            drops += [place_way(held, goal, around, gripper, width, goal.p[2]).drop for goal in goals]
        total += min(drops, default=0.0) + UNREACHED * (not _reached(subtask, target, goals, robot))
        obstacles.append(target.moved(goals[0]).box)
    return total


def _reached(subtask: Subtask, target: SceneObject, goals: Sequence[Pose], robot: Robot) -> bool:
    """Whether an arm that can take an object reaches one of its poses with it, however it holds it."""
    return subtask.hand_to is not None or any(
        kinematics_of(robot.arms[grasp.arm]).reachable(goal * held.in_object)
        for grasp in subtask.grasps
        for held in grasp_poses(
            target.pose,
            target.asset.annotation.contact_point(grasp.contact),
            robot.arms[grasp.arm].gripper,
            target.box.bottom,
        )
        for goal in goals
    )


def other_slots(slots: Mapping[str, Slot], object_id: str, objects: Mapping[str, SceneObject]) -> list[Slot]:
    """Further slots for an object, always the same ones; those of the other objects stay theirs.

    Args:
        slots: of all objects that a chain moves.
        object_id: which of them.
        objects: of the scene as they stand now, by id.
    """
    own = slots[object_id]
    if own.point is None:
        return [replace(own, pose=pose) for pose in own.spare]
    receptacle = objects[own.receptacle]
    at = receptacle.asset.annotation.functional_point(own.point)
    present = lying_in(receptacle, at, [o for o in objects.values() if o.id not in slots])
    for key, slot in slots.items():
        if key != object_id and slot.receptacle == own.receptacle:
            # What was brought already may lie in another slot than was planned for it.
            point = receptacle.asset.annotation.functional_point(int(slot.point or 0))
            there = place_complaint(objects[key], receptacle, point) is None
            present.append(objects[key] if there else objects[key].moved(slot.poses(objects)[0]))
    rng = np.random.default_rng(list(object_id.encode()))
    found: list[Slot] = []
    for _ in range(OTHERS):
        try:
            poses = allocate(receptacle, own.point, [objects[object_id]], rng, present)
        except InfeasibleScene:
            break
        found.append(replace(own, pose=poses[object_id]))
    return found


def opened_for(receptacle: SceneObject, functional_point: int) -> SceneObject:
    """The receptacle with the drawer or lid open that keeps a functional point in, as far as it goes."""
    part = kept_in_by(receptacle, functional_point)
    if part is None:
        return receptacle
    model = receptacle.asset.model
    joints = joint_positions(model, receptacle.joints)
    joints[joint_index(model, part)] = model.link(part).joint.far_end
    return receptacle.moved(receptacle.pose, tuple(joints.tolist()))


def kept_in_by(receptacle: SceneObject, functional_point: int) -> str | None:
    """The moving part that must be open before something is put there: the point's own, or a lid over it."""
    point = receptacle.asset.annotation.functional_point(functional_point)
    if not receptacle.asset.articulated:
        return None
    shut = SceneObject(receptacle.record, receptacle.asset, receptacle.pose)
    return closed_part(shut, point)


def lying_in(receptacle: SceneObject, point: FunctionalPoint, objects: Sequence[SceneObject]) -> list[SceneObject]:
    """Things in or on the receptacle from the start, in the moving part of a functional point where it has one."""
    return [o for o in objects if (o.record.container, o.record.container_part) == (receptacle.id, point.link)]
