"""Things that go along: what lies in a closed drawer or in a heap, and a scene with parts open or closed as needed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import repeat

import numpy as np

from vcage.base.attempts import LIMITS, GaveUp, Refused, first_accepted
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.objects.asset import Asset
from vcage.objects.heaps import heap
from vcage.schema.asset import FunctionalPoint
from vcage.schema.base import PoseRecord, box_record
from vcage.schema.goals import Goal, part_words
from vcage.schema.robot import Robot
from vcage.schema.scene import ObjectRecord, Scene
from vcage.schema.subtasks import Subtask
from vcage.tasks.access import open_to_a_hand
from vcage.tasks.feasibility import hand_has_room
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import allocate, opened_for


def point_in(asset: Asset, part: str) -> FunctionalPoint | None:
    """The functional point at which things lie in a moving part; None where nothing does."""
    points = asset.annotation.functional_points
    return next((point for point in points if point.link == part and point.holds == "in"), None)


def open_point(asset: Asset) -> FunctionalPoint | None:
    """The functional point at which things lie in the body of an object, open at the top; None where nothing does."""
    return next((point for point in asset.annotation.functional_points if point.open_above), None)


def stow(
    holder: SceneObject, part: str, contents: Sequence[SceneObject], robot: Robot, rng: np.random.Generator
) -> dict[str, Pose]:
    """Poses in the world of objects in a drawer, by id; once it is open, a hand has room around each of them.

    Args:
        holder: with the drawer, mostly closed.
        part: the drawer.
        contents: of the drawer; their poses do not matter.
        robot: whose hands take them out.
        rng: of all choices.

    Raises:
        InfeasibleScene: they do not fit together, or no hand gets to one of them.
    """
    point = point_in(holder.asset, part)
    assert point is not None, f"nothing lies in {part} of {holder.id}"
    opened = opened_for(holder, point.id)

    def lay() -> dict[str, Pose]:
        local = allocate(holder, point.id, contents, rng)
        lying = [o.moved(opened.frame(point.id) * local[o.id]) for o in contents]
        stuck = [o for o in lying if not hand_has_room(o, [opened, *(x for x in lying if x is not o)], robot)]
        if stuck:
            raise Refused(", ".join(o.record.phrase for o in stuck))
        return {name: holder.frame(point.id) * pose for name, pose in local.items()}

    try:
        return first_accepted(repeat(lay, LIMITS.stowings)).value
    except GaveUp as error:
        raise InfeasibleScene(
            f"no hand has room to take {error.refusals[0]} out of the {part_words(part)} of {holder.record.phrase}",
            hint="take something smaller, or less, out of it",
            details={"objects": [o.id for o in contents], "container": holder.id},
        ) from None


def heaped_in(holder: SceneObject, balls: Sequence[SceneObject], rng: np.random.Generator) -> dict[str, Pose]:
    """Poses in the world of balls that lie loose in an object, by id.

    Args:
        holder: where it stands.
        balls: their poses do not matter.
        rng: of all choices.

    Raises:
        InfeasibleScene: they do not all lie below its rim, or nothing lies in it.
    """
    point = open_point(holder.asset)
    radii = [float(ball.asset.ball_radius or 0.0) for ball in balls]
    middles = None if point is None else heap(holder.asset.pieces, holder.asset.opening(point), radii, rng)
    if middles is None:
        raise InfeasibleScene(
            f"{holder.record.phrase} has no room for {len(balls)} balls below its rim",
            hint="ask for fewer, or for a larger vessel that is open at the top",
            details={"objects": [ball.id for ball in balls], "container": holder.id},
        )
    centres = {ball.id: ball.asset.bounds.mean(axis=0) for ball in balls}
    return {ball.id: holder.pose * Pose(middle - centres[ball.id]) for ball, middle in zip(balls, middles, strict=True)}


@dataclass(frozen=True)
class Reached:
    """A thing where a hand reaches it.

    Args:
        thing: where it is then.
        others: all other objects, as they are then.
        requires: goals that parts are open or closed.
    """

    thing: SceneObject
    others: list[SceneObject]
    requires: list[Goal]


def reached(thing: SceneObject, others: Sequence[SceneObject]) -> Reached:
    """An object with its drawer open; other objects are unchanged.

    Args:
        thing: that is to be taken.
        others: all other objects.
    """
    part = thing.record.container_part
    holder = next((o for o in others if o.id == thing.record.container), None)
    point = None if part is None or holder is None else point_in(holder.asset, part)
    if part is None or holder is None or point is None:
        return Reached(thing, list(others), [])
    moved = {o.id: o for o in with_part([holder, thing, *(o for o in others if o is not holder)], holder.id, part)}
    return Reached(moved[thing.id], [moved[o.id] for o in others], open_to_a_hand(holder, part))


def with_part(objects: Sequence[SceneObject], name: str, part: str, position: float | None = None) -> list[SceneObject]:
    """The objects after a moving part of one was moved with its contents.

    Args:
        objects: of a scene.
        name: id of the object with the part.
        part: which.
        position: of its joint; as far out as it goes when left out.
    """
    holder = next(o for o in objects if o.id == name)
    after = holder.with_part(part, position)
    way = after.part_pose(part) * holder.part_pose(part).inverse()
    found = []
    for o in objects:
        rides = o.record.container == name and o.record.container_part == part
        found.append(after if o is holder else o.moved(way * o.pose) if rides else o)
    return found


def ready_for(subtask: Subtask, scene: Scene, objects: Sequence[SceneObject]) -> Scene:
    """The scene as required before a sub-task: needed parts open or closed, with their contents
    moved along.

    Args:
        subtask: the next one.
        scene: with parts in their present state.
        objects: of the scene.
    """
    now = [o.moved(o.pose, scene.object(o.id).joints) for o in objects]
    for goal in subtask.requires:
        holder = next((o for o in now if o.id == goal.subject), None)
        if holder is None or goal.part not in {link.name for link in holder.asset.model.links}:
            continue
        end = holder.asset.model.link(goal.part).joint.far_end
        now = with_part(now, holder.id, goal.part, 0.0 if goal.kind.rests else end)
    there = {o.id: o for o in now}
    return scene.model_copy(update={"objects": [_record(record, there[record.id]) for record in scene.objects]})


def _record(record: ObjectRecord, now: SceneObject) -> ObjectRecord:
    """An object as it is now; all joints at rest are none."""
    update: dict[str, object] = {"joints": now.joints if any(now.joints) else ()}
    if record.rides:
        update |= {"pose": PoseRecord.of(now.pose), "aabb": box_record(now.asset.bounds, now.pose)}
    return record.model_copy(update=update)
