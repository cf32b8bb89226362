"""Where the objects of a scene are before they settle: on the table, in and on each other, and in closed drawers.

All that the instruction says of the start is true there, and a hand has room around what it wants taken out of a thing.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.layout.capacities import opening_for
from vcage.layout.items import Placement, TableItem, table_item
from vcage.layout.placement.place import place
from vcage.layout.placement.view import view_rectangles
from vcage.models.selection_check import NamedObject
from vcage.objects.asset import Asset
from vcage.objects.openings import Opening
from vcage.plans.actions import open_at_start
from vcage.plans.descriptions import HOLDING, described_relations
from vcage.plans.plain_words import in_words
from vcage.runs.context import StageContext
from vcage.scenes.start_relations import scene_object
from vcage.schema.goals import AskedGoal, Description, Goal, in_steps
from vcage.schema.plan import TABLE
from vcage.schema.scene import ObjectRecord, SceneTemplate
from vcage.sim.robots import load_robot
from vcage.tasks.feasibility import hand_has_room
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.stowing import stow

MARGIN = 0.015
"""Smallest gap between two objects, metres: wide enough for the picture to show the table between them."""

BORDER = 2.0
"""Pixels that stay free between an object and the edge of the top view."""

HAND_DRAWS = 40
"""Placements among which one is looked for in which a hand has room around what is to be taken out of a thing."""


class StartingPoses:
    """Draws where the objects of a scene start.

    Args:
        objects: of the scene.
        template: of the scene.
        descriptions: what must be true.
        goals: what is asked for.
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
        self._items = _place_items([o for o in objects if o.starts_in_part is None], template, context)
        self._described = [d for d in descriptions if d.part is None]
        moved = {asked.goal.subject for asked in goals}
        self._taken = [
            d.subject for d in self._described if d.relation in HOLDING and d.reference != TABLE and d.subject in moved
        ]

    def draw(self, rng: np.random.Generator) -> dict[str, Pose]:
        """Poses in the world, by id.

        Raises:
            InfeasibleScene: there is no room; or none in which what is described is true, or a hand gets to what it is
                to take out of a thing: names what.
        """
        stuck: list[str] = []
        for _ in range(HAND_DRAWS if self._taken else 1):
            spots, height = self._spots(rng), self._template.table.height
            poses = {item.id: item.pose(spots[item.id], height + spots[item.id].z) for item in self._items}
            stuck = self._stuck(poses)
            if not stuck:
                return poses | self._stowed(poses, rng)
        phrases = {o.id: o.phrase for o in self._objects}
        where = [f"{phrases[o.id]} out of {phrases[str(o.starts_in)]}" for o in self._objects if o.id in stuck]
        raise InfeasibleScene(
            f"no hand has room to take {' and '.join(where)}",
            hint="ask for something smaller, or for another place that it is taken from",
            details={"objects": stuck},
        )

    def _spots(self, rng: np.random.Generator) -> dict[str, Placement]:
        """A place for every item, such that what is described of it is true."""
        template, items = self._template, self._items
        workspace = np.array([template.workspace.lower, template.workspace.upper])
        known = {TABLE, *(item.id for item in items)}
        relations = [r for r in described_relations(self._described) if {r.subject, r.reference} <= known]
        try:
            return place(items, workspace, rng, margin=MARGIN, relations=relations)
        except InfeasibleScene as error:
            if not relations:
                raise
            place(items, workspace, rng, margin=MARGIN)  # where there is no room at all it says so
            phrases = {o.id: o.phrase for o in self._objects}
            raise InfeasibleScene(
                f"no placement was found in which "
                f"{' and '.join(f'{in_words(d, phrases)} ({d.words!r})' for d in self._described)}",
                hint="say it otherwise, or with fewer or smaller objects",
                details=error.details | {"objects": sorted({n for r in relations for n in (r.subject, r.reference)})},
            ) from error

    def _stuck(self, poses: Mapping[str, Pose]) -> list[str]:
        """Ids of objects that are to be taken out of things and that no hand gets to."""
        if not self._taken:
            return []
        things = {o.id: self._thing(o, poses[o.id]) for o in self._objects if o.id in poses}
        return [
            name
            for name in self._taken
            if not hand_has_room(things[name], [o for key, o in things.items() if key != name], self._robot)
        ]

    def _stowed(self, poses: Mapping[str, Pose], rng: np.random.Generator) -> dict[str, Pose]:
        """Poses of what starts in moving parts, by id, where these are of all else."""
        objects, found = {o.id: o for o in self._objects}, dict[str, Pose]()
        for name, part in dict.fromkeys((o.starts_in, o.starts_in_part) for o in objects.values() if o.starts_in_part):
            holder = self._thing(objects[str(name)], poses[str(name)])
            lying = [o for o in objects.values() if (o.starts_in, o.starts_in_part) == (name, part)]
            things = [self._thing(o, holder.pose) for o in lying]
            found |= stow(holder, str(part), things, self._robot, rng)
        return found

    def records(self, poses: Mapping[str, Pose]) -> list[ObjectRecord]:
        """The records of the objects at poses by id, with their moving parts as they start."""
        return [self._thing(o, poses[o.id]).record for o in self._objects]

    def _thing(self, o: NamedObject, pose: Pose) -> SceneObject:
        return scene_object(o, asset_of(o, self._context), pose, self._joints.get(o.id, ()))


def _joints(
    objects: Sequence[NamedObject], steps: Sequence[Collection[Goal]], context: StageContext
) -> dict[str, tuple[float, ...]]:
    """Positions of the moving parts of each object: what is to be closed is open at the start, the rest at rest."""
    open_parts = open_at_start(steps)
    found = {}
    for o in objects:
        links = asset_of(o, context).model.links
        there = tuple(link.joint.far_end if (o.id, link.name) in open_parts else 0.0 for link in links)
        found[o.id] = there if any(there) else ()
    return found


def _place_items(objects: Sequence[NamedObject], template: SceneTemplate, context: StageContext) -> list[TableItem]:
    """Items of the placement; what a task carries or fills must be where an arm reaches."""
    openings = _openings(objects, context)
    return [_place_item(o, objects, openings, template, context) for o in objects]


def _openings(objects: Sequence[NamedObject], context: StageContext) -> dict[str, Opening]:
    """The room of each object that others start in, in its own frame, by its id."""
    contents: dict[str, list[Asset]] = {}
    for o in objects:
        if o.starts_in is not None and o.starts_in_part is None:
            contents.setdefault(o.starts_in, []).append(asset_of(o, context))
    holders = [o for o in objects if o.id in contents]
    return {
        o.id: opening for o in holders if (opening := opening_for(asset_of(o, context), contents[o.id])) is not None
    }


def _lift(o: NamedObject, objects: Sequence[NamedObject], openings: Mapping[str, Opening]) -> float:
    """How far above the table an object stands: the floors of all that it lies in, metres."""
    holder = next((other for other in objects if other.id == o.starts_in), None)
    return openings[holder.id].floor + _lift(holder, objects, openings) if holder else 0.0


def _place_item(
    o: NamedObject,
    objects: Sequence[NamedObject],
    openings: Mapping[str, Opening],
    template: SceneTemplate,
    context: StageContext,
) -> TableItem:
    asset = asset_of(o, context)
    bounds = np.array([template.workspace.lower, template.workspace.upper])
    support = template.table.height + _lift(o, objects, openings)
    seen = view_rectangles(template.top_camera.camera(), support, float(asset.size[2]), bounds, BORDER)
    return replace(
        table_item(o.id, asset),
        allowed=context.within_reach(asset, o.role, template),
        within=seen,
        inside=o.starts_in,
        opening=openings.get(o.id),
    )


def asset_of(o: NamedObject, context: StageContext) -> Asset:
    return context.library.asset(o.asset, o.variant)
