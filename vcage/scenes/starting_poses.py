"""Starts of the objects of a scene before they settle: on the table, in and on each other, and in closed drawers.

All descriptions of the start are true, and a hand has room around each object that is to be taken out of another.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import repeat

import numpy as np

from vcage.base.attempts import LIMITS, GaveUp, Refused, first_accepted
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose, world_aabb
from vcage.base.text import listed
from vcage.goals.centred import off_centre
from vcage.goals.thresholds import THRESHOLDS
from vcage.layout.capacities import capacity_of, opening_for
from vcage.layout.items import TableItem, table_item
from vcage.layout.placement.place import place
from vcage.layout.placement.view import view_rectangles
from vcage.models.selection_check import NamedObject, room_complaints, starting_as_described
from vcage.objects.asset import Asset
from vcage.objects.library import Library
from vcage.objects.lying import LIES, UNABLE, standing_in_lying
from vcage.objects.painting import LYING
from vcage.plans.actions import SLID, open_at_start
from vcage.plans.descriptions import HOLDING, described_relations
from vcage.plans.plain_words import in_words
from vcage.runs.context import StageContext
from vcage.schema.base import PoseRecord, box_record
from vcage.schema.goals import AskedGoal, Description, Goal, Reading, in_steps, part_words
from vcage.schema.plan import TABLE
from vcage.schema.scene import ObjectRecord, SceneTemplate
from vcage.sim.robots import load_robot
from vcage.tasks.feasibility import fits, hand_has_room
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.stowing import heaped_in, point_in, stow

MARGIN_M = 0.015
"""Smallest gap between two objects: wide enough for the picture to show the table between them."""

BORDER_PX = 2.0
"""Width that stays free between an object and the edge of the top view."""


class _Central(Refused):
    """A thing that is to be brought to the centre of the table stands there already."""


class StartingPoses:
    """Draws where the objects of a scene start.

    Args:
        objects: of the scene.
        template: of the scene.
        descriptions: that must be true.
        goals: the requested ones.
        context: the library.
    """

    def __init__(
        self,
        objects: Sequence[NamedObject],
        template: SceneTemplate,
        descriptions: Sequence[Description],
        goals: Sequence[AskedGoal],
        context: StageContext,
    ):
        self._objects, self._template, self._context = objects, template, context
        self._joints = _joints(objects, in_steps(goals), context)
        self._robot = load_robot(template.robot)
        self._items = _place_items([o for o in objects if not (o.starts_in_part or o.heaped)], template, context)
        self._described = [d for d in descriptions if d.part is None]
        moved = {asked.goal.subject for asked in goals}
        self._to_centre = [asked.goal.subject for asked in goals if asked.goal.relation == "centred"]
        self._taken = [
            d.subject for d in self._described if d.relation in HOLDING and d.reference != TABLE and d.subject in moved
        ]

    def draw(self, rng: np.random.Generator) -> dict[str, Pose]:
        """Poses in the world, by id.

        Raises:
            InfeasibleScene: there is no room; or none in which all descriptions are true, or a hand gets to what it is
                to take out of something: names what.
        """

        def place_for_hands() -> dict[str, Pose]:
            poses = self._placed(rng)
            if central := [name for name in self._to_centre if name in poses and self._is_central(name, poses[name])]:
                raise _Central("at the centre of the table", central)
            if stuck := self._stuck(poses):
                raise Refused("no hand has room", stuck)
            return poses | self._stowed(poses, rng)

        try:
            return first_accepted(repeat(place_for_hands, LIMITS.placements_for_hands)).value
        except GaveUp as error:
            last = error.refusals[-1]
            assert isinstance(last, Refused)
            if isinstance(last, _Central):
                raise InfeasibleScene(f"{listed(last.about)} cannot start elsewhere than {last}") from None
            raise self._out_of_reach(last.about) from None

    def _out_of_reach(self, stuck: Collection[str]) -> InfeasibleScene:
        phrases = {o.id: o.phrase for o in self._objects}
        where = [f"{phrases[o.id]} out of {phrases[str(o.starts_in)]}" for o in self._objects if o.id in stuck]
        return InfeasibleScene(
            f"no hand has room to take {' and '.join(where)}",
            hint="ask for something smaller, or for another starting place",
            details={"objects": stuck},
        )

    def _is_central(self, name: str, pose: Pose) -> bool:
        """True if an object would stand where it is to be brought to: at the centre of the table."""
        (thing,) = (o for o in self._objects if o.id == name)
        return off_centre(world_aabb(asset_of(thing, self._context).bounds, pose)) <= THRESHOLDS.centred_m

    def _placed(self, rng: np.random.Generator) -> dict[str, Pose]:
        """Poses of all items, such that their descriptions are true."""
        template, items = self._template, self._items
        workspace = np.array([template.workspace.lower, template.workspace.upper])
        known = {TABLE, *(item.id for item in items)}
        relations = [r for r in described_relations(self._described) if {r.subject, r.reference} <= known]
        try:
            spots = place(items, workspace, rng, margin=MARGIN_M, relations=relations)
        except InfeasibleScene as error:
            if not relations:
                raise
            place(items, workspace, rng, margin=MARGIN_M)  # where there is no room at all it says so
            phrases = {o.id: o.phrase for o in self._objects}
            raise InfeasibleScene(
                f"no placement was found in which "
                f"{' and '.join(f'{in_words(d, phrases)} ({d.words!r})' for d in self._described)}",
                hint="say it otherwise, or with fewer or smaller objects",
                details=error.details | {"objects": sorted({n for r in relations for n in (r.subject, r.reference)})},
            ) from error
        return {item.id: item.pose(spots[item.id], template.table.height + spots[item.id].z) for item in items}

    def _stuck(self, poses: Mapping[str, Pose]) -> list[str]:
        """Ids of objects to be taken out of others and out of a hand's reach."""
        if not self._taken:
            return []
        things = {o.id: self._thing(o, poses[o.id]) for o in self._objects if o.id in poses}
        return [
            name
            for name in self._taken
            if not hand_has_room(things[name], [o for key, o in things.items() if key != name], self._robot)
        ]

    def _stowed(self, poses: Mapping[str, Pose], rng: np.random.Generator) -> dict[str, Pose]:
        """Poses of the objects that start in moving parts or in a heap, by id, where these are of all others."""
        objects, found = {o.id: o for o in self._objects}, dict[str, Pose]()
        for name, part in dict.fromkeys((o.starts_in, o.starts_in_part) for o in objects.values() if o.starts_in_part):
            holder = self._thing(objects[str(name)], poses[str(name)])
            lying = [o for o in objects.values() if (o.starts_in, o.starts_in_part) == (name, part)]
            things = [self._thing(o, holder.pose) for o in lying]
            found |= stow(holder, str(part), things, self._robot, rng)
        for name in dict.fromkeys(str(o.starts_in) for o in objects.values() if o.heaped):
            things = [self._thing(o, Pose()) for o in objects.values() if o.heaped and o.starts_in == name]
            found |= heaped_in(self._thing(objects[name], poses[name]), things, rng)
        return found

    def records(self, poses: Mapping[str, Pose]) -> list[ObjectRecord]:
        """The records of the objects at poses by id, with their moving parts as they start."""
        return [self._thing(o, poses[o.id]).record for o in self._objects]

    def _thing(self, o: NamedObject, pose: Pose) -> SceneObject:
        return scene_object(o, asset_of(o, self._context), pose, self._joints.get(o.id, ()))


def _joints(
    objects: Sequence[NamedObject], steps: Sequence[Collection[Goal]], context: StageContext
) -> dict[str, tuple[float, ...]]:
    """Positions of the moving parts of each object: parts to be closed are open at the start, the others at rest."""
    open_parts = open_at_start(steps)
    found = {}
    for o in objects:
        links = asset_of(o, context).model.links
        there = tuple(link.joint.far_end if (o.id, link.name) in open_parts else 0.0 for link in links)
        found[o.id] = there if any(there) else ()
    return found


def _place_items(objects: Sequence[NamedObject], template: SceneTemplate, context: StageContext) -> list[TableItem]:
    """Items of the placement; objects that a task carries or fills must be where an arm reaches."""
    assets = {o.id: asset_of(o, context) for o in objects}
    inside = {o.id: o.starts_in for o in objects}
    openings = {
        name: opening_for(asset, contents)
        for name, asset in assets.items()
        if (contents := [assets[other] for other, holder in inside.items() if holder == name])
    }

    def lift_m(name: str) -> float:
        """Height of an object's support above the table: the floors of all that it lies in."""
        holder = inside[name]
        opening = openings.get(str(holder))
        return 0.0 if holder is None or opening is None else opening.floor + lift_m(holder)

    bounds = np.array([template.workspace.lower, template.workspace.upper])
    items = []
    for o in objects:
        support, height = template.table.height + lift_m(o.id), float(assets[o.id].size[2])
        items.append(
            replace(
                table_item(o.id, assets[o.id]),
                allowed=context.within_reach(assets[o.id], o.role, template),
                within=view_rectangles(template.top_camera.camera(), support, height, bounds, BORDER_PX),
                inside=o.starts_in,
                opening=openings.get(o.id),
            )
        )
    return items


def asset_of(o: NamedObject, context: StageContext) -> Asset:
    return context.library.asset(o.asset, o.variant)


def started(objects: Sequence[NamedObject], reading: Reading, library: Library) -> list[NamedObject]:
    """The objects as they start by the descriptions and goals of a reading: what is to be stood up lies on its side.

    Raises:
        InfeasibleScene: descriptions contradict each other, or there is no room; names the objects and sizes.
    """
    found, wrong = starting_as_described(objects, reading.descriptions)
    for complaints, way_out in (
        (_lying_complaints(found, reading, library), f"stand up what lies on its side on the table, such as {LIES}"),
        (_sliding_complaints(found, reading), "leave out where it starts, and it stands on the table"),
    ):
        if unfit := list(complaints):
            raise _cannot_start([*wrong, *unfit], way_out)
    if not wrong:
        found = [_laid(o) if o.id in to_stand_up(reading) else o for o in found]
    found = [replace(o, heaped=_is_heaped(o, library)) for o in found]
    rooms = {o.id: capacity_of(o.id, library.asset(o.asset, o.variant)) for o in found}
    wrong = wrong or [*room_complaints(found, rooms), *_drawer_complaints(found, library)]
    if wrong:
        raise _cannot_start(wrong, "ask for a smaller thing, or for a place with more room")
    return found


def _cannot_start(wrong: list[str], way_out: str) -> InfeasibleScene:
    return InfeasibleScene(
        f"not all can start as the instruction says: {'; '.join(wrong)}",
        hint=f"{way_out}; another --seed does not help",
        details={"problems": wrong},
    )


def to_stand_up(reading: Reading) -> set[str]:
    """Ids of the objects that a reading asks to be stood up."""
    return {asked.goal.subject for asked in reading.goals if asked.goal.relation == "upright"}


def _laid(o: NamedObject) -> NamedObject:
    """An object that starts on its side."""
    return o if o.variant.endswith(LYING) else replace(o, variant=f"{o.variant}{LYING}")


def _lying_complaints(objects: Sequence[NamedObject], reading: Reading, library: Library) -> Iterator[str]:
    """Why objects that are to be stood up cannot start on their sides."""
    for o in (o for o in objects if o.id in to_stand_up(reading)):
        asset = library.asset(o.asset, o.variant)
        if standing_in_lying(asset.standing or asset) is None:
            yield f"{o.id} {UNABLE}"
        elif o.starts_in is not None:
            yield f"{o.id} cannot lie on its side in or on {o.starts_in}: only what lies on the table is stood up"
        elif above := [other.id for other in objects if other.starts_in == o.id]:
            yield f"{', '.join(above)} cannot start in or on {o.id}, which lies on its side"


def _sliding_complaints(objects: Sequence[NamedObject], reading: Reading) -> Iterator[str]:
    """Why objects that are to be hung or inserted cannot be taken from where they start."""
    done = {asked.goal.subject: SLID[asked.goal.relation] for asked in reading.goals if asked.goal.relation in SLID}
    for o in (o for o in objects if o.id in done and o.starts_in is not None):
        there = f"in or on {o.starts_in}: only what stands on the table is {done[o.id]}"
        yield f"{o.id} cannot be {done[o.id]} from {there}"


def _is_heaped(o: NamedObject, library: Library) -> bool:
    """True for a ball that starts in another object, and in no moving part of that."""
    inside = o.starts_in is not None and o.starts_in_part is None
    return inside and library.asset(o.asset, o.variant).ball_radius is not None


def _drawer_complaints(objects: Sequence[NamedObject], library: Library) -> Iterator[str]:
    by_id = {o.id: o for o in objects}
    for o in objects:
        if o.starts_in is None or o.starts_in_part is None:
            continue
        holder, thing = (scene_object(one, library.asset(one.asset, one.variant)) for one in (by_id[o.starts_in], o))
        point, part = point_in(holder.asset, o.starts_in_part), part_words(o.starts_in_part)
        above = [other.id for other in objects if other.starts_in == o.id]
        if point is None:
            yield f"{o.id} cannot start in the {part} of {o.starts_in}, where nothing lies"
        elif above:
            yield f"{', '.join(above)} cannot start in or on {o.id}, which starts in the {part} of {o.starts_in}"
        elif not (check := fits(thing, holder, point)).passed:
            yield f"{o.id} has no room where it starts, in the {part} of {o.starts_in}: {check.message}"


def scene_object(o: NamedObject, asset: Asset, pose: Pose | None = None, joints: tuple[float, ...] = ()) -> SceneObject:
    """An object at a pose, with its moving parts at positions; without a pose it lies in nothing, to look at sizes."""
    at = pose or Pose()
    record = ObjectRecord(
        id=o.id,
        asset=o.asset,
        variant=o.variant,
        phrase=o.phrase,
        role=o.role,
        pose=PoseRecord.of(at),
        aabb=box_record(asset.bounds, at),
        joints=joints,
        container=None if pose is None else o.starts_in,
        container_part=None if pose is None else o.starts_in_part,
        heaped=o.heaped and pose is not None,
    )
    return SceneObject(record, asset, at, joints)
