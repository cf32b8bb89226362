"""Objects that are filled and then moved are carried with their contents, if they can be held level."""

from __future__ import annotations

from collections.abc import Sequence

from vcage.base.errors import NoFeasibleTask
from vcage.schema.goals import AskedGoal, Goal, in_steps
from vcage.tasks.primitives.grip import stays_level
from vcage.tasks.scene_objects import SceneObject


def require_level(goals: Sequence[AskedGoal], objects: Sequence[SceneObject]) -> None:
    """Refuse to move an object that was filled before, if it tips when it is carried.

    Args:
        goals: that are asked for.
        objects: of the scene.

    Raises:
        NoFeasibleTask: names the thing, what lies in it, and the order in which it can be done.
    """
    by_id, lies = {o.id: o for o in objects}, dict[str, str]()
    words = {one.goal: one.words for one in goals}
    for step in in_steps(goals):
        moved = {goal.subject: goal for goal in sorted(step, key=str) if goal.kind.acts_on is None}
        for name, goal in moved.items():
            contents = sorted(other for other, holder in lies.items() if holder == name and other not in moved)
            if contents and not stays_level(by_id[name]):
                raise _tips(by_id[name], by_id[contents[0]], goal, words[goal])
        lies = {name: holder for name, holder in lies.items() if name not in moved}
        lies |= {g.subject: str(g.reference) for g in step if g.relation == "inside" and g.part is None}


def _tips(thing: SceneObject, content: SceneObject, goal: Goal, words: str) -> NoFeasibleTask:
    """The error about an object that tips when it is carried with its content."""
    name, other = thing.record.phrase, content.record.phrase
    return NoFeasibleTask(
        f"the {name} cannot be carried with the {other} in it ({words!r}): the gripper "
        "holds it only by its edge, where it tips",
        hint=f"ask to move the {name} first, and then to put the {other} into it",
        details={"missing": [str(goal)]},
    )
