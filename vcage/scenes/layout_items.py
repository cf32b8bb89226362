"""The items of a scene's layout optimisation, and the nearest layout to the targets."""

from __future__ import annotations

import functools
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vcage.base.attempts import GaveUp, first_accepted
from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.layout.capacities import opening_for
from vcage.layout.groups import intersections
from vcage.layout.items import TableItem, hand_clearance, table_item
from vcage.layout.optimize import LayoutOptions, LayoutResult, optimize_layout
from vcage.layout.placement.free_region import nearest_in_rectangles
from vcage.plans.relations import DIRECTIONS, third_of
from vcage.runs.context import StageContext
from vcage.schema.plan import TABLE, Relation
from vcage.schema.scene import Role, Scene
from vcage.sim.robots import load_robot
from vcage.tasks.asked_arms import ANY_ARM, for_one_arm, reached_by
from vcage.tasks.scene_objects import SceneObject

SETTLING_M = 0.002
"""Distance that objects in a third of the table keep from its edges: they settle a little."""


@dataclass(frozen=True)
class Targets:
    """A layout that is wanted.

    Args:
        poses: of the independently placed objects, at their headings, by id.
        inside: holder of each object that lies in or on another, by id; holders of objects in moving parts are ignored.
        relations: of the plan.
    """

    poses: Mapping[str, Pose]
    inside: Mapping[str, str]
    relations: Sequence[Relation] = ()


def nearest_layout(
    scene: Scene,
    targets: Targets,
    rng: Callable[[], np.random.Generator],
    options: LayoutOptions,
    context: StageContext,
) -> LayoutResult:
    """The nearest layout without collisions (:func:`~vcage.layout.optimize.optimize_layout`) in which arms reach all.

    Each demand is made only where there is room for it: first that one arm reaches what it alone must reach
    (:mod:`~vcage.tasks.asked_arms`), with room kept free for what is to be put beside something; then without that
    room; then that some arm reaches each object however it is turned; last as it is turned.

    Args:
        scene: with its robot.
        targets: the layout that is wanted.
        rng: makes the random numbers of one try.
        options: of the optimisation.
        context: the library, and the reach of the robots.

    Raises:
        InfeasibleScene: there is none.
    """
    items = layout_items(scene, targets, context)
    room, beside = _room_beside(scene, items)

    def optimized(asked: Sequence[TableItem], relations: Sequence[Relation]) -> LayoutResult:
        workspace = np.array([scene.workspace.lower, scene.workspace.upper])
        return optimize_layout(asked, workspace, scene.table, rng(), relations, options)

    def with_room() -> LayoutResult:
        return optimized([*items, *room], [*targets.relations, *beside]).without({item.id for item in room})

    demands = [with_room] if room else []
    demands += [
        lambda: optimized(_in_reach_of_one_arm(items, scene, context), targets.relations),
        lambda: optimized(items, targets.relations),
        lambda: optimized(layout_items(scene, targets, context, headed=True), targets.relations),
    ]
    try:
        return first_accepted(demands, InfeasibleScene).value
    except GaveUp as error:
        raise error.refusals[-1] from None


def _room_beside(scene: Scene, items: Sequence[TableItem]) -> tuple[list[TableItem], list[Relation]]:
    """Room on the table for the instruction's targets beside an object: an item and a relation for each."""
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


def layout_items(scene: Scene, targets: Targets, context: StageContext, headed: bool = False) -> list[TableItem]:
    """Every independently placed object at its heading, with its target and allowed area.

    Args:
        scene: with its robot.
        targets: the layout that is wanted.
        context: the library, and the reach of the robots.
        headed: True if an object is within reach at its own heading alone, not at any.
    """
    objects = [o for o in context.objects(scene) if not o.record.rides]
    arms = reached_by(objects, scene.goals)
    hand = hand_clearance(load_robot(scene.robot))
    items = []
    for o in objects:
        target = targets.poses[o.id]
        contents = [other.asset for other in objects if targets.inside.get(other.id) == o.id]
        item = replace(
            table_item(o.id, o.asset),
            yaws=(target.yaw,),
            target=(float(target.p[0]), float(target.p[1])),
            opening=opening_for(o.asset, contents),
            inside=targets.inside.get(o.id),
            hand=hand if o.record.role == "content" else None,
        )
        reach = _where_reached(o, scene, arms.get(o.id, ()), target.yaw if headed else None, context)
        items.append(replace(item, allowed=_where_described(item, reach, scene)))
    return items


def _where_described(item: TableItem, allowed: np.ndarray | None, scene: Scene) -> np.ndarray | None:
    """(m, 2, 2) parts of the allowed rectangles in the thirds of the table that the descriptions of an item name; None
    for anywhere."""
    ground = np.array([scene.workspace.lower, scene.workspace.upper])
    for d in scene.descriptions:
        if d.subject == item.id and d.reference == TABLE and d.relation != "on":
            off = item.body_rectangle().mean(axis=0) - item.rectangle().mean(axis=0)
            third = (third_of(d.relation, ground) - off + [[SETTLING_M], [-SETTLING_M]])[None]
            allowed = third if allowed is None else intersections(allowed, third)
    return allowed


def _where_reached(
    thing: SceneObject, scene: Scene, arms: Collection[str], yaw: float | None, context: StageContext
) -> np.ndarray | None:
    """Rectangles (m, 2, 2) of the table where each of some arms reaches an object, or where some arm does if none is
    asked for; None for anywhere.

    Raises:
        InfeasibleScene: there is no place in reach for all of them.
    """
    if not arms:
        # Without an instruction a receptacle receives objects from either arm, and a scanner reads for either.
        shared = thing.record.role == "receptacle" or bool(thing.asset.annotation.faces_of("reader"))
        every = shared and scene.instruction is None
        return context.within_reach(thing.asset, thing.record.role, scene, yaw, every=every)
    reach = [context.within_reach(thing.asset, _role_of(thing), scene, yaw, arm=arm) for arm in sorted(arms)]
    known = [rectangles for rectangles in reach if rectangles is not None]
    if not known:
        return None
    found = functools.reduce(_common, known)
    if not len(found):
        named = " and the ".join(sorted(arms))
        raise InfeasibleScene(f"there is no place for {thing.record.phrase} that the {named} arm reach", hint=ANY_ARM)
    return found


def _common(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(m, 2, 2) intersections of rectangles that have an inside."""
    both = intersections(a, b)
    return both[np.all(both[:, 0] < both[:, 1], axis=1)]


def _in_reach_of_one_arm(items: Sequence[TableItem], scene: Scene, context: StageContext) -> list[TableItem]:
    """The items, each group that one arm must reach allowed where the nearest such arm reaches it."""
    found = {item.id: item for item in items}
    for choices in choices_of_arms(items, scene, context):
        nearest = min(choices, key=lambda choice: sum(map(_distance_to_reach_m, choice)))
        found |= {item.id: item for item in nearest}
    return list(found.values())


def choices_of_arms(items: Sequence[TableItem], scene: Scene, context: StageContext) -> list[list[list[TableItem]]]:
    """For each group of items that one arm must reach: the group as allowed where an arm reaches it, for each such arm.

    A group that no arm reaches is left out.

    Args:
        items: of the scene.
        scene: with its robot and goals.
        context: the library, and the reach of the robots.
    """
    placed, by_id = {item.id: item for item in items}, {o.id: o for o in context.objects(scene)}
    asked = reached_by(list(by_id.values()), scene.goals)
    found = []
    for group in for_one_arm(list(by_id.values()), [one.goal for one in scene.goals]):
        moved = [placed[name] for name in sorted(group & placed.keys()) if not by_id[name].asset.articulated]
        choices = [_in_reach_of(arm, moved, by_id, scene, context) for arm in _arms_for(group, asked, scene)]
        found.append([choice for choice in choices if choice])
    return [choices for choices in found if choices]


def _arms_for(group: Collection[str], asked: Mapping[str, Collection[str]], scene: Scene) -> Collection[str]:
    """The arms that may reach all of a group alone: the requested one, any without a request; none where several are
    requested."""
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
        reach = _where_described(item, context.within_reach(o.asset, _role_of(o), scene, arm=arm), scene)
        if reach is None or not len(reach):
            return []
        found.append(replace(item, allowed=reach))
    return found


def _role_of(thing: SceneObject) -> Role:
    """The role of an object that a goal needs, regardless of its role in the layout: a scale may be context."""
    return "receptacle" if thing.asset.annotation.functional_points else "content"


def _distance_to_reach_m(item: TableItem) -> float:
    """Distance of an item's target from where it may stand."""
    return float(np.linalg.norm(nearest_in_rectangles(item.target, np.asarray(item.allowed)) - item.target))
