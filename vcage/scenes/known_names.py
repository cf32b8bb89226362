"""Names that goals and sub-tasks of a scene may use, and the lists of them that errors show."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Mapping, Sequence

from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE
from vcage.tasks.scene_objects import SceneObject


def near_names(name: str, known: Collection[str]) -> str:
    """Known names that are like an unknown one; some of all where none is."""
    near = difflib.get_close_matches(name, known, n=3) or sorted(known)[:12]
    return f"{', '.join(near)}{' or another of those that there are' if len(near) < len(known) else ''}"


def all_names(objects: Sequence[SceneObject]) -> str:
    """Objects and parts that goals may be about, for an error."""
    parts = [f"{o.id}/{link.name}" for o in objects for link in o.asset.model.links]
    return f"what there is: {', '.join([*(o.id for o in objects), *parts])}"


def unknown_name(goal: Goal, objects: Mapping[str, SceneObject], arms: Collection[str]) -> str | None:
    """The first thing or part that a goal names and the scene does not have; None where it has all."""
    if goal.subject not in objects:
        return goal.subject
    if goal.reference is not None and goal.reference not in {*objects, TABLE, *arms}:
        return goal.reference
    owner = objects.get(goal.reference or "", objects[goal.subject])
    parts = {link.name for thing in (owner, objects[goal.subject]) for link in thing.asset.model.links}
    return goal.part if goal.part is not None and goal.part not in parts else None
