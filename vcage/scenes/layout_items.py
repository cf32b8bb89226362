"""What the optimisation of a layout needs of each object of a scene, and the nearest layout to where they should be."""

from __future__ import annotations

import functools
import logging
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike

from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.layout.capacities import opening_for
from vcage.layout.groups import intersections
from vcage.layout.hands import hand_clearance
from vcage.layout.items import TableItem, table_item
from vcage.layout.optimize import LayoutOptions, LayoutResult, optimize_layout
from vcage.plans.relations import DIRECTIONS, third_of
from vcage.runs.context import StageContext
from vcage.schema.plan import TABLE, Relation
from vcage.schema.scene import Role, Scene
from vcage.sim.robots import load_robot
from vcage.tasks.asked_arms import ANY_ARM
from vcage.tasks.one_arm import for_one_arm, reached_by
from vcage.tasks.scene_objects import SceneObject

SETTLING = 0.002
"""Distance that things in a third of the table keep from its edges, metres: things settle a little."""

logger = logging.getLogger(__name__)

T = TypeVar("T")


def nearest_layout(
    scene: Scene,
    targets: Mapping[str, Pose],
    inside: Mapping[str, str],
    relations: Sequence[Relation],
    rng: Callable[[], np.random.Generator],
    options: LayoutOptions,
    context: StageContext,
) -> LayoutResult:
    """The nearest layout without collisions (:func:`~vcage.layout.optimize.optimize_layout`) in which arms reach all.

    What one arm must reach (:mod:`~vcage.tasks.one_arm`) it does where there is room for that. Where there is none,
    some arm reaches each object however it is turned, or else as it is turned. Beside a thing that something is to be
    put beside, there is room for that, if the table has it.

    Args:
        scene, targets, inside, context: as :func:`layout_items` takes them.
        relations: of the plan.
        rng: makes the random numbers of one try.
        options: of the optimisation.

    Raises:
        InfeasibleScene: there is none.
    """
    items = layout_items(scene, targets, inside, context)
    workspace = np.array([scene.workspace.lower, scene.workspace.upper])
    room, beside = _room_beside(scene, items)
    if room:
        try:
            found = optimize_layout([*items, *room], workspace, scene.table, rng(), [*relations, *beside], options)
            return _without(found, {item.id for item in room})
        except InfeasibleScene as error:
            logger.debug("no room is kept free: %s", error.message)
    for asked in (_in_reach_of_one_arm(items, scene, context), items):
        try:
            return optimize_layout(asked, workspace, scene.table, rng(), relations, options)
        except InfeasibleScene as error:
            logger.debug("less is asked of the arms: %s", error.message)
    items = layout_items(scene, targets, inside, context, headed=True)
    return optimize_layout(items, workspace, scene.table, rng(), relations, options)


def _room_beside(scene: Scene, items: Sequence[TableItem]) -> tuple[list[TableItem], list[Relation]]:
    """Room on the table for what the instruction wants on one side of a thing: an item and a relation for each."""
    by_id, room, beside = {item.id: item for item in items}, list[TableItem](), list[Relation]()
    for goal in (asked.goal for asked in scene.goals):
        if goal.relation not in DIRECTIONS or goal.reference not in by_id:
            continue
        thing, other = by_id[goal.subject], by_id[goal.reference]
        apart = np.array(DIRECTIONS[goal.relation]) * (np.array(thing.size[:2]) + other.size[:2]) / 2
        x, y = (np.array(other.target) + apart).tolist()
        room.append(replace(thing, id=f"room-{len(room)}", target=(x, y), inside=None, opening=None, hand=None))
        beside.append(Relation(subject=room[-1].id, relation=goal.relation, reference=other.id))
    return room, beside


def _without(layout: LayoutResult, names: Collection[str]) -> LayoutResult:
    """A layout without some of its items."""

    def rest(values: Mapping[str, T]) -> dict[str, T]:
        return {name: value for name, value in values.items() if name not in names}

    return replace(
        layout,
        positions=rest(layout.positions),
        containers=rest(layout.containers),
        displaced=rest(layout.displaced),
        repaired=[name for name in layout.repaired if name not in names],
        released=[name for name in layout.released if name not in names],
        out_of_reach=[name for name in layout.out_of_reach if name not in names],
    )


def layout_items(
    scene: Scene,
    targets: Mapping[str, Pose],
    inside: Mapping[str, str],
    context: StageContext,
    headed: bool = False,
) -> list[TableItem]:
    """Every object that has a place of its own at its heading, with where it should be and may be.

    Args:
        scene: with its robot.
        targets: where the objects should be, at their headings, by id.
        inside: what an object lies in or on, by id; what lies in moving parts is passed over.
        context: the library, and what the robots reach.
        headed: whether an object is within reach at its own heading alone, not at any.
    """
    objects = [o for o in context.objects(scene) if o.record.container_part is None]
    asked = reached_by(objects, scene.goals)
    hand = hand_clearance(load_robot(scene.robot))
    items = []
    for o in objects:
        contents = [other.asset for other in objects if inside.get(other.id) == o.id]
        # Without an instruction a receptacle receives what either arm brings, and a scanner reads what either has.
        shared = o.record.role == "receptacle" or bool(o.asset.annotation.faces_of("reader"))
        yaw, every = targets[o.id].yaw, shared and scene.instruction is None
        items.append(
            replace(
                table_item(o.id, o.asset),
                yaws=(yaw,),
                target=(float(targets[o.id].p[0]), float(targets[o.id].p[1])),
                opening=opening_for(o.asset, contents),
                inside=inside.get(o.id),
                allowed=_where_reached(o, scene, asked.get(o.id, ()), yaw if headed else None, every, context),
                hand=hand if o.record.role == "content" else None,
            )
        )
    return [replace(item, allowed=_where_described(item, item.allowed, scene)) for item in items]


def _where_described(item: TableItem, allowed: ArrayLike | None, scene: Scene) -> np.ndarray | None:
    """(m, 2, 2) what is in the thirds of the table that an item is described to be in, of where it is allowed; None
    for anywhere."""
    ground = np.array([scene.workspace.lower, scene.workspace.upper])
    found = None if allowed is None else np.asarray(allowed, dtype=np.float64).reshape(-1, 2, 2)
    for d in scene.descriptions:
        if d.subject == item.id and d.reference == TABLE and d.relation != "on":
            off = item.body_rectangle().mean(axis=0) - item.rectangle().mean(axis=0)
            third = third_of(d.relation, ground) - off + [[SETTLING], [-SETTLING]]
            found = third[None] if found is None else intersections(found, third[None])
    return found


def _where_reached(
    thing: SceneObject, scene: Scene, arms: Collection[str], yaw: float | None, every: bool, context: StageContext
) -> np.ndarray | None:
    """Rectangles (m, 2, 2) of the table where each of some arms reaches an object, or where none is asked for some arm
    does; None for anywhere.

    Raises:
        InfeasibleScene: there is no place that all of them reach.
    """
    if not arms:
        return context.within_reach(thing.asset, thing.record.role, scene, yaw, every=every)
    reach = [context.within_reach(thing.asset, _part_of(thing), scene, yaw, arm=arm) for arm in sorted(arms)]
    found = functools.reduce(_common, [rectangles for rectangles in reach if rectangles is not None], None)
    if found is not None and not len(found):
        named = " and the ".join(sorted(arms))
        raise InfeasibleScene(f"there is no place for {thing.record.phrase} that the {named} arm reach", hint=ANY_ARM)
    return found


def _common(some: np.ndarray | None, others: np.ndarray) -> np.ndarray:
    """(m, 2, 2) what rectangles have in common with others, where that has an inside."""
    if some is None:
        return others
    lower = np.maximum(some[:, None, 0], others[None, :, 0])
    upper = np.minimum(some[:, None, 1], others[None, :, 1])
    both = np.stack([lower, upper], axis=2).reshape(-1, 2, 2)
    return both[np.all(both[:, 0] < both[:, 1], axis=1)]


def _in_reach_of_one_arm(items: Sequence[TableItem], scene: Scene, context: StageContext) -> list[TableItem]:
    """The items, those that one arm must reach where one does: the nearest that way."""
    found, by_id = {item.id: item for item in items}, {o.id: o for o in context.objects(scene)}
    asked = reached_by(list(by_id.values()), scene.goals)
    for group in for_one_arm(list(by_id.values()), [one.goal for one in scene.goals]):
        moved = [found[name] for name in sorted(group) if not by_id[name].asset.articulated]
        choices = [_in_reach_of(arm, moved, by_id, scene, context) for arm in _arms_for(group, asked, scene)]
        nearest = min(filter(None, choices), key=lambda choice: sum(map(_way_to_reach, choice)), default=[])
        found |= {item.id: item for item in nearest}
    return list(found.values())


def _arms_for(group: Collection[str], asked: Mapping[str, Collection[str]], scene: Scene) -> Collection[str]:
    """The arms of which one alone may reach all of a group: the one that is asked for, any where none is; none where
    several are asked for."""
    named = {arm for name in group for arm in asked.get(name, ())}
    if not named:
        return load_robot(scene.robot).arms
    return named if len(named) == 1 else ()


def _in_reach_of(
    arm: str, items: Sequence[TableItem], objects: Mapping[str, SceneObject], scene: Scene, context: StageContext
) -> list[TableItem]:
    """The items, allowed where an arm reaches them; none where it reaches one of them nowhere."""
    found = []
    for item in items:
        o = objects[item.id]
        reach = _where_described(item, context.within_reach(o.asset, _part_of(o), scene, arm=arm), scene)
        if reach is None or not len(reach):
            return []
        found.append(replace(item, allowed=reach))
    return found


def _part_of(thing: SceneObject) -> Role:
    """What an arm does with a thing that a goal needs, whatever the layout calls it: a scale may be context."""
    return "receptacle" if thing.asset.annotation.functional_points else "content"


def _way_to_reach(item: TableItem) -> float:
    """How far an item's target is from where it may stand, metres."""
    lower, upper = np.moveaxis(np.asarray(item.allowed), 1, 0)
    target = np.asarray(item.target)
    return float(np.linalg.norm(target - np.clip(target, lower, upper), axis=1).min())
