"""Arms that an instruction names: "with the left arm" must be true of the execution, and is part of its wordings.

Where things stand, one arm must reach those that it brings together, and those asked of it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import TypeVar

from vcage.base.errors import NoFeasibleTask
from vcage.schema.goals import AskedGoal, Goal, in_steps
from vcage.schema.subtasks import Subtask
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import stands_flush

T = TypeVar("T")

ANY_ARM = "let any arm do it: leave the arm out of the instruction"
"""The way out where the arm that is asked for cannot do it."""

_UNFIT = ("The", "Make", "Find", "See", "Let")
"""First words of sentences that do not go on with "with the left arm"."""


def asked_arms(asked: Iterable[AskedGoal]) -> dict[Goal, str]:
    """The arm required for each goal that names one.

    Raises:
        NoFeasibleTask: a goal is asked of two arms.
    """
    found: dict[Goal, str] = {}
    for one in asked:
        if one.arm is not None and found.setdefault(one.goal, one.arm) != one.arm:
            raise NoFeasibleTask(
                f"{one.goal} ({one.words!r}) is asked of the {found[one.goal]} arm and of the {one.arm} arm",
                hint="name one arm for it",
                details={"missing": [str(one.goal)], "reasons": []},
            )
    return found


def require_arms(asked: Iterable[AskedGoal], arms: Collection[str]) -> None:
    """Check that every goal's required arm exists and can achieve it.

    Raises:
        NoFeasibleTask: names the goal, the arm, and the existing arms.
    """
    asked = list(asked)
    steps = in_steps(asked)
    _require_enough_arms(frozenset().union(*steps), arms)
    _require_free_arms(steps, arms)
    by_goal = asked_arms(asked)
    _require_one_each(by_goal)
    for goal, arm in by_goal.items():
        why = None
        if arm not in arms:
            why = f"the robot has no arm {arm!r}, it has {', '.join(arms)}"
        elif goal.kind.refers_to == "arm" and arm == goal.reference:
            why = f"the {arm} arm cannot give what it is to be given"
        elif goal.kind.arms > 1:
            why = f"it takes {goal.kind.arms} arms, not the {arm} arm alone"
        if why is not None:
            raise NoFeasibleTask(f"{goal}: {why}", hint=ANY_ARM, details={"missing": [str(goal)], "reasons": [why]})


def _require_enough_arms(goals: Collection[Goal], arms: Collection[str]) -> None:
    """Check that the robot has an arm for each thing that it is to hold at the end.

    Raises:
        NoFeasibleTask: it has not; names the goals.
    """
    held = sorted((goal for goal in goals if goal.kind.fleeting), key=str)
    takes = sum(goal.kind.arms for goal in held)
    if takes > len(arms):
        named = " and ".join(map(str, held))
        why = f"{named} {'take' if len(held) > 1 else 'takes'} {takes} arms, and the robot has {len(arms)}"
        raise NoFeasibleTask(
            why, hint="hold up fewer things", details={"missing": [str(goal) for goal in held], "reasons": [why]}
        )


def _require_free_arms(steps: Sequence[Collection[Goal]], arms: Collection[str]) -> None:
    """Check that enough arms are free for each goal after those that hold something up to the end.

    Raises:
        NoFeasibleTask: they are not; names the goal, and what is held.
    """
    held = list[Goal]()
    for step in steps:
        free = len(arms) - sum(goal.kind.arms for goal in held)
        for goal in sorted(step, key=str):
            takes = 2 if goal.kind.refers_to == "arm" else goal.kind.arms
            if takes > free and goal.subject not in {one.subject for one in held}:
                why = f"{goal} comes after {' and '.join(map(str, held))}, when {free or 'no'} arm is free"
                hint = "hold things up last"
                raise NoFeasibleTask(why, hint=hint, details={"missing": [str(goal)], "reasons": [why]})
        held += sorted((goal for goal in step if goal.kind.fleeting), key=str)


def _require_one_each(asked: Mapping[Goal, str]) -> None:
    """Check that no arm is asked to hold up several things at the end.

    Raises:
        NoFeasibleTask: one is; names the goals.
    """
    held = sorted((goal for goal in asked if goal.kind.fleeting), key=str)
    for arm in dict.fromkeys(asked[goal] for goal in held):
        own = [str(goal) for goal in held if asked[goal] == arm]
        if len(own) > 1:
            why = f"{' and '.join(own)} are asked of the {arm} arm, which holds up one thing"
            raise NoFeasibleTask(why, hint=ANY_ARM, details={"missing": own, "reasons": [why]})


def arm_for(goals: Iterable[Goal], arms: Mapping[Goal, str], hand_to: str | None) -> tuple[str | None, str | None]:
    """The arm that must take hold for some goals, None for any; and why no arm does for all of them, or None.

    Args:
        goals: of a sub-task.
        arms: the required ones, by goal.
        hand_to: the receiving arm of a hand-over: goals true afterwards are its doing.
    """
    named = {goal: arms[goal] for goal in goals if goal in arms}
    takes = {arm for goal, arm in named.items() if hand_to is None or goal.kind.refers_to == "arm"}
    if len(takes) > 1:
        return None, f"it is asked of the {' and of the '.join(sorted(takes))} arm at once"
    puts = {arm for goal, arm in named.items() if hand_to is not None and goal.kind.refers_to != "arm"}
    if puts - {hand_to}:
        return None, f"the {hand_to} arm would put it down, not the {min(puts)} arm"
    return next(iter(takes), None), None


def those_of(arms: Mapping[str, T], arm: str | None, hand_to: str | None) -> Mapping[str, T]:
    """The arms that may take part in a sub-task: all, or the required one and the one it hands to.

    Args:
        arms: by name.
        arm: that must do it; None for any.
        hand_to: that it is handed to.
    """
    return arms if arm is None else {name: value for name, value in arms.items() if name in (arm, hand_to)}


def bound_to(subtask: Subtask, arm: str | None) -> Subtask:
    """The sub-task as an arm must do it, which its words then say.

    Args:
        subtask: with grasps of that arm.
        arm: None for any.
    """
    if arm is None:
        return subtask
    text, *others = _with_arm(arm, [subtask.text, *subtask.texts], subtask.goals[0], subtask.hand_to)
    return subtask.model_copy(update={"arm": arm, "text": text, "texts": others})


def _with_arm(arm: str, texts: Sequence[str], goal: Goal, hand_to: str | None) -> list[str]:
    if goal.relation == "handed":
        first = texts[0].replace(f" to the {hand_to} arm", f" from the {arm} arm to the {hand_to} arm")
        return [first, *(text.replace("Hand ", f"{verb} ", 1) for verb in ("Pass", "Give") for text in [first])]
    fit = [text for text in texts if text.split()[0] not in _UNFIT]
    use = f"Use the {arm} arm to {texts[0][0].lower()}{texts[0][1:]}"
    return [*(f"{text[:-1]} with the {arm} arm{text[-1]}" for text in fit), use]


def for_one_arm(objects: Sequence[SceneObject], goals: Collection[Goal]) -> list[set[str]]:
    """Groups of ids, each within reach of one arm for the goals to be achievable.

    Objects put in or on another are in no group: where no arm reaches both, they are handed over. Stacked ones are.

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
    """The arms that must reach each object, by its id, for goals with a required arm.

    Args:
        objects: of the scene.
        asked: goals; those without an arm put no demand on places.
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
    if goal.relation in ("poured", "hung_on", "inserted_in") and below is not None:
        return {below.id}
    if goal.relation == "on" and below is not None:
        points = [point for point in below.asset.annotation.functional_points if point.is_of(goal.part)]
        if points and all(stands_flush(objects[goal.subject], below, point) for point in points):
            return {below.id}
    return set()
