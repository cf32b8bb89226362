"""Present: an object is put down on the customer's side of the table, its front towards the customer."""

from __future__ import annotations

from collections.abc import Collection

from vcage.schema.goals import Goal
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates.set_down import SetDown


def _presented_goals(thing: SceneObject, asked: Collection[Goal]) -> list[Goal]:
    """The goal on request; a sign exists to be shown."""
    shown = Goal(subject=thing.id, relation="presented")
    return [shown] if shown in asked or thing.asset.annotation.words.category == "sign" else []


PRESENT = SetDown("present", _presented_goals)
