"""Slots: the places of objects in a receptacle or on the table.

It reuses the exact free-region placement of the scene (:mod:`vcage.layout.placement.place`), with the opening as
the workspace: objects that fit together get places side by side, and the others are refused by name.
"""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from types import MappingProxyType

import numpy as np

from vcage.base.attempts import LIMITS
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose, world_aabb
from vcage.layout.items import TableItem
from vcage.layout.placement.place import place
from vcage.objects.openings import Opening
from vcage.schema.asset import FunctionalPoint
from vcage.schema.goals import Goal
from vcage.tasks.access import closed_part
from vcage.tasks.ground import FACING
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import place_complaint

CONTENT_GAP_M = 0.006
"""Gap between contents, and between contents and wall."""

HEADING = "facing_robot"
"""Word of the goal of a heading that a thing may be asked to have in or on another."""

STOOD_UP_TURNS = tuple(float(turn) for turn in np.radians(range(0, 360, 45)))
"""Headings of a round thing that is stood up in or on another, relative to its pose, radians."""

FLUSH_GAP_M = 1e-4
"""Gap of an object that stands flush on another of its own size."""


@dataclass(frozen=True)
class Slot:
    """A place for an object.

    Args:
        receptacle: id of the receptacle, or ``table``.
        point: id of the receptacle's functional point; None on the table.
        pose: object frame in the frame of the point's part; on the table in the world.
        turns: allowed headings there, relative to ``pose``, radians.
        lying: frame of an object that starts on its side in the frame in which it stands; ``pose`` is of the latter.
        spare: equally good poses; on the table alone.
    """

    receptacle: str
    point: int | None
    pose: Pose
    turns: tuple[float, ...] = (0.0, np.pi)
    spare: tuple[Pose, ...] = ()
    lying: Pose = field(default_factory=Pose)

    def poses(self, objects: Mapping[str, SceneObject]) -> list[Pose]:
        """Poses of the object in the world, with the receptacles where they stand.

        Args:
            objects: by id.
        """
        frame = Pose() if self.point is None else objects[self.receptacle].frame(self.point)
        return [frame * self.pose * Pose.from_yaw([0, 0, 0], turn) * self.lying for turn in self.turns]


def allocate(
    receptacle: SceneObject,
    functional_point: int,
    contents: Sequence[SceneObject],
    rng: np.random.Generator,
    present: Sequence[SceneObject] = (),
    headings: Mapping[str, float] = MappingProxyType({}),
) -> dict[str, Pose]:
    """A place for each of ``contents`` in the receptacle: object frame in :meth:`SceneObject.frame`, by id; of what
    starts on its side the frame in which it stands.

    Args:
        receptacle: where they go.
        functional_point: id of the receptacle's functional point.
        contents: objects going there.
        rng: of all choices.
        present: objects already there.
        headings: required ones of some contents in the receptacle's frame, by id, radians.

    Raises:
        InfeasibleScene: they do not fit together; names them and the area that is missing.
    """
    point = receptacle.asset.annotation.functional_point(functional_point)
    opening, contents = receptacle.asset.opening(point), [content.as_standing for content in contents]
    for content in contents:
        if (bottom := nested_bottom(content, receptacle, point)) is not None:
            return {content.id: _nested(content, bottom, receptacle, opening, [*contents, *present])}
    inside, taken = _free(receptacle, functional_point, contents, present)
    items = [_item(o, headings.get(o.id)) for o in contents]
    places = place(items, inside, rng, margin=CONTENT_GAP_M, obstacles=taken, container=receptacle.id)
    return {
        key: Pose.from_yaw([at.x, at.y, opening.floor], at.yaw + headings.get(key, 0.0)) for key, at in places.items()
    }


def arrangements(
    receptacle: SceneObject,
    functional_point: int,
    contents: Sequence[SceneObject],
    present: Sequence[SceneObject] = (),
    headings: Mapping[str, float] = MappingProxyType({}),
) -> list[dict[str, Pose]]:
    """Places as of :func:`allocate` that follow from sizes alone, the roomiest arrangement first.

    So demonstrations of a task differ in where they begin, and agree on where things go.

    Raises:
        InfeasibleScene: they do not fit together.
    """
    rng = np.random.default_rng(0)
    draw = partial(allocate, receptacle, functional_point, contents, rng, present, headings)
    walls, taken = _free(receptacle, functional_point, contents, present)

    def gap(poses: Mapping[str, Pose]) -> float:
        boxes = [world_aabb(o.as_standing.asset.bounds, poses[o.id])[:, :2] for o in contents]
        to_walls = [CONTENT_GAP_M + float(min((box[0] - walls[0]).min(), (walls[1] - box[1]).min())) for box in boxes]
        pairs = itertools.chain(itertools.combinations(boxes, 2), itertools.product(boxes, taken))
        return min([*to_walls, *(float(np.maximum(a[0] - b[1], b[0] - a[1]).max()) for a, b in pairs)])

    found = [draw()]
    for _ in range(LIMITS.arrangements - 1):
        with contextlib.suppress(InfeasibleScene):  # a full place is not packed at each attempt
            found.append(draw())
    return sorted(found, key=gap, reverse=True)


def _free(
    receptacle: SceneObject, functional_point: int, contents: Sequence[SceneObject], present: Sequence[SceneObject]
) -> tuple[np.ndarray, list[np.ndarray]]:
    """Corners (2, 2) of the part of an opening in which contents may stand, and the boxes (2, 2) of those present."""
    opening = receptacle.asset.opening(receptacle.asset.annotation.functional_point(functional_point))
    centre, half = np.array(opening.centre), room_for(receptacle, functional_point, contents) / 2
    to_receptacle = receptacle.frame(functional_point).inverse()
    taken = [world_aabb(o.asset.bounds, to_receptacle * o.pose)[:, :2] for o in present]
    return np.stack([centre - half, centre + half]), taken


def _item(thing: SceneObject, heading: float | None) -> TableItem:
    """An object to be placed by quarters, or, with a required heading, its box seen from the receptacle."""
    if heading is None:
        return TableItem(id=thing.id, size=tuple(thing.asset.size), yaws=(0.0, np.pi / 2))
    box = world_aabb(thing.asset.bounds, Pose.from_yaw([0.0, 0.0, 0.0], heading))
    return TableItem(id=thing.id, size=tuple((box[1] - box[0]).tolist()), yaws=(0.0,))


def asks_for_heading(goals: Iterable[Goal]) -> bool:
    """True if one of the goals of a thing is a heading."""
    return any(goal.relation == HEADING for goal in goals)


def heading_for(goals: Iterable[Goal], receptacle: SceneObject, functional_point: int) -> float | None:
    """The heading in a receptacle's frame at which a front faces the robot; None where no goal asks for it."""
    return FACING[HEADING] - receptacle.frame(functional_point).yaw if asks_for_heading(goals) else None


def slot_in(
    receptacle: SceneObject, functional_point: int, pose: Pose, goals: Iterable[Goal], thing: SceneObject
) -> Slot:
    """The slot of a thing at a pose in a receptacle, where it stands; it may be turned round there unless a goal asks
    for its heading. A round one that is stood up may have any: a hand comes to it from one side."""
    round_again = thing.asset.standing is not None and thing.asset.standing.round
    turns = (0.0,) if asks_for_heading(goals) else STOOD_UP_TURNS if round_again else Slot.turns
    return Slot(receptacle.id, functional_point, pose, turns, lying=thing.asset.stands.inverse())


def _nested(
    content: SceneObject, bottom: float, receptacle: SceneObject, opening: Opening, there: Sequence[SceneObject]
) -> Pose:
    """The place of an object that nests.

    Raises:
        InfeasibleScene: something else is there too.
    """
    if len(there) > 1:
        others = ", ".join(o.record.phrase for o in there if o is not content)
        raise InfeasibleScene(
            f"{content.record.phrase} nests in {receptacle.record.phrase} only where nothing else lies, not {others}",
            hint="put one of them elsewhere",
            details={"objects": [o.id for o in there], "container": receptacle.id},
        )
    return Pose.from_yaw([*opening.centre, bottom], 0.0)


def nested_bottom(content: SceneObject, receptacle: SceneObject, point: FunctionalPoint) -> float | None:
    """Height of the bottom of a container that nests in another, in the frame of the point's part, metres.

    None where it does not, and where it fits like any box.
    """
    content = content.as_standing
    room = room_for(receptacle, point.id, [content])
    if np.all(np.sort(room) >= np.sort(content.asset.footprint)):
        return None
    return receptacle.asset.nested_height(content.asset, point)


def room_for(receptacle: SceneObject, functional_point: int, contents: Sequence[SceneObject]) -> np.ndarray:
    """(2,) the part of an opening in which things may stand, metres: not too near to its walls."""
    point = receptacle.asset.annotation.functional_point(functional_point)
    size = np.array(receptacle.asset.opening(point).size)
    widest = np.max([np.sort(o.as_standing.asset.footprint) for o in contents], axis=0)
    spare = float(np.min(np.sort(size) - widest)) / 2
    # On an object of its own size an object stands flush: a block on a block.
    flush = point.holds == "on" and spare < CONTENT_GAP_M
    return size - 2 * (max(0.0, spare) - FLUSH_GAP_M if flush else CONTENT_GAP_M)


def stands_flush(target: SceneObject, receptacle: SceneObject, point: FunctionalPoint) -> bool:
    """True where an object fills the top that it is put on, as a block on a block does."""
    spare = np.array(receptacle.asset.opening(point).size) - target.as_standing.asset.footprint
    return point.holds == "on" and float(np.max(spare)) < 2 * CONTENT_GAP_M


def other_slots(slots: Mapping[str, Slot], object_id: str, objects: Mapping[str, SceneObject]) -> list[Slot]:
    """Further slots for an object, always the same ones; the other objects keep theirs.

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
            # An object already delivered may be in another slot than planned.
            point = receptacle.asset.annotation.functional_point(int(slot.point or 0))
            there = place_complaint(objects[key], receptacle, point) is None
            present.append(objects[key] if there else objects[key].moved(slot.poses(objects)[0]))
    rng = np.random.default_rng(list(object_id.encode()))
    found: list[Slot] = []
    with contextlib.suppress(InfeasibleScene):  # another draw finds no room either
        headings = {} if len(own.turns) > 1 else {object_id: own.pose.yaw}
        for _ in range(LIMITS.spare_slots):
            poses = allocate(receptacle, own.point, [objects[object_id]], rng, present, headings)
            found.append(replace(own, pose=poses[object_id]))
    return found


def opened_for(receptacle: SceneObject, functional_point: int) -> SceneObject:
    """The receptacle with the drawer or lid over a functional point fully open."""
    part = kept_in_by(receptacle, functional_point)
    return receptacle if part is None else receptacle.with_part(part)


def kept_in_by(receptacle: SceneObject, functional_point: int) -> str | None:
    """The moving part to open before something is put there: the point's own, or a lid over it."""
    point = receptacle.asset.annotation.functional_point(functional_point)
    if not receptacle.asset.articulated:
        return None
    shut = SceneObject(receptacle.record, receptacle.asset, receptacle.pose)
    return closed_part(shut, point)


def lying_in(receptacle: SceneObject, point: FunctionalPoint, objects: Sequence[SceneObject]) -> list[SceneObject]:
    """Objects that lie in or on the receptacle from the start, in the part of a functional point where it has one."""
    return [o for o in objects if (o.record.container, o.record.container_part) == (receptacle.id, point.link)]
