"""Things that one arm must reach: those it brings together where nothing changes hands, and those asked of it."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from vcage.schema.goals import AskedGoal, Goal
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates.place import stands_flush


def for_one_arm(objects: Sequence[SceneObject], goals: Collection[Goal]) -> list[set[str]]:
    """Groups of ids, each of things that one arm must reach for the goals to be brought about.

    What is put in or on another is in none: where no arm reaches both, it is handed over. What is stacked is.

    Args:
        objects: of the scene.
        goals: that are asked for.
    """
    by_id = {o.id: o for o in objects}
    groups: list[set[str]] = []
    for goal in sorted(goals, key=str):
        needed = {goal.subject, *_met(goal, by_id)}
        if len(needed) > 1:
            meeting = [group for group in groups if group & needed]
            groups = [group for group in groups if group not in meeting] + [needed.union(*meeting)]
    return groups


def reached_by(objects: Sequence[SceneObject], asked: Iterable[AskedGoal]) -> dict[str, set[str]]:
    """The arms that must reach each object, by its id, for goals that are asked of an arm.

    Args:
        objects: of the scene.
        asked: goals; those that name no arm ask nothing of where things stand.
    """
    by_id = {o.id: o for o in objects}
    found: dict[str, set[str]] = {}
    for one in asked:
        goal = one.goal
        if one.arm is not None:
            for name in (goal.subject, str(goal.reference), *_met(goal, by_id)):
                if name in by_id:
                    found.setdefault(name, set()).add(one.arm)
    return found


def _met(goal: Goal, objects: dict[str, SceneObject]) -> set[str]:
    """Ids of objects to which an arm brings the subject of a goal."""
    if goal.kind.tool is not None:
        return {o.id for o in objects.values() if goal.relation in o.kind().tool_for}
    below = objects.get(goal.reference or "")
    if goal.relation == "on" and below is not None:
        points = [point for point in below.asset.annotation.functional_points if point.link == goal.part]
        if points and all(stands_flush(objects[goal.subject], below, point) for point in points):
            return {below.id}
    return set()
