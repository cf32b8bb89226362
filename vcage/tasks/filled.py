"""Things that are filled and then moved are carried with their contents, if they can be held level."""

from __future__ import annotations

from collections.abc import Sequence

from vcage.base.errors import NoFeasibleTask
from vcage.schema.goals import AskedGoal, in_steps
from vcage.tasks.primitives.grip import stays_level
from vcage.tasks.scene_objects import SceneObject

STAYING = ("open", "closed", "turned", "pressed")
"""Goals for which their object stays where it is."""


def require_level(goals: Sequence[AskedGoal], objects: Sequence[SceneObject]) -> None:
    """Refuse to move a thing that was filled before, if it tips when it is carried.

    Args:
        goals: that are asked for.
        objects: of the scene.

    Raises:
        NoFeasibleTask: names the thing, what lies in it, and the order in which it can be done.
    """
    by_id, lies = {o.id: o for o in objects}, dict[str, str]()
    words = {one.goal: one.words for one in goals}
    for step in in_steps(goals):
        moved = {goal.subject: goal for goal in sorted(step, key=str) if goal.relation not in STAYING}
        for name, goal in moved.items():
            contents = sorted(other for other, holder in lies.items() if holder == name and other not in moved)
            if contents and not stays_level(by_id[name]):
                thing, content = by_id[name].record.phrase, by_id[contents[0]].record.phrase
                raise NoFeasibleTask(
                    f"the {thing} cannot be carried with the {content} in it ({words[goal]!r}): the gripper "
                    "holds it only by its edge, where it tips",
                    hint=f"ask to move the {thing} first, and then to put the {content} into it",
                    details={"missing": [str(goal)]},
                )
        lies = {name: holder for name, holder in lies.items() if name not in moved}
        lies |= {g.subject: str(g.reference) for g in step if g.relation == "inside" and g.part is None}
