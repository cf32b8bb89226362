"""Goals that are impossible wherever the objects stand: of the wrong size, without a place or a tool, or tipped on
the way.

Objects that are filled and then moved are carried with their contents, if they can be held level.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from vcage.base.errors import NoFeasibleTask
from vcage.base.text import listed
from vcage.plans.actions import HOLDING
from vcage.schema.goals import AskedGoal, Goal, in_steps, part_words
from vcage.schema.robot import Arm
from vcage.tasks.asked_arms import require_arms
from vcage.tasks.holds_with_both import places_for_both
from vcage.tasks.meeting import has_room_beside, no_room_for_hands
from vcage.tasks.primitives.grip import stays_level
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import SMALLER, is_about, judging, sensible
from vcage.tasks.slots import HEADING


def require_way(goals: Sequence[AskedGoal], objects: Sequence[SceneObject], arms: Mapping[str, Arm]) -> None:
    """Refuse goals that sizes rule out at any layout, or that lack a place or a tool.

    Args:
        goals: the requested ones.
        objects: of the scene; their places do not matter.
        arms: of the robot, by name.

    Raises:
        NoFeasibleTask: names each such goal with its words and the reason; also objects that would be carried with
            loose contents, those that have no front to turn to the robot or no room for two hands, and goals that are
            asked of an unknown arm.
    """
    require_arms(goals, arms)
    require_level(goals, objects, arms.values())
    require_fronts(goals, objects)
    require_room_for_hands(goals, objects, arms)
    require_only_stood_up(goals, objects)
    if ruled_out := _ruled_out(goals, objects):
        raise NoFeasibleTask(
            f"at any layout, nothing can achieve {'; '.join(_reported(ruled_out))}",
            hint=f"{SMALLER}, or for what these things are made for; another --seed does not help",
            details={
                "missing": [str(one.asked.goal) for one in ruled_out],
                "reasons": [reason for one in ruled_out for reason in one.reasons],
            },
        )


class _RuledOut(NamedTuple):
    """A goal nothing achieves, the phrase of its subject, and the reasons."""

    asked: AskedGoal
    phrase: str
    reasons: list[str]


def _ruled_out(goals: Sequence[AskedGoal], objects: Sequence[SceneObject]) -> list[_RuledOut]:
    """Each goal no sensible proposal achieves, if the obstacle is known."""
    proposals, refused, _ = sensible(objects, judging(True), [one.goal for one in goals])
    able = set[Goal]().union(*(proposal.goals for proposal in proposals))
    by_id = {o.id: o for o in objects}
    found = []
    for goal, one in {one.goal: one for one in goals if one.goal not in able}.items():
        reasons = list(dict.fromkeys(refusal.reason for refusal in refused if is_about(refusal, goal)))
        if reasons := reasons or _no_place(goal, by_id) or _no_tool(goal, objects):
            found.append(_RuledOut(one, by_id[goal.subject].record.phrase, reasons))
    return found


def _reported(ruled_out: Sequence[_RuledOut]) -> list[str]:
    """Goals with their reasons; things of one kind, which fail for the same reasons, together."""
    alike: dict[tuple[str, ...], list[_RuledOut]] = {}
    for one in ruled_out:
        key = (one.asked.words, *(reason.replace(one.phrase, "") for reason in one.reasons))
        alike.setdefault(key, []).append(one)
    return [_with_reasons(group) for group in alike.values()]


def _no_place(goal: Goal, by_id: Mapping[str, SceneObject]) -> list[str]:
    """The reason why nothing is put in or on an object so: where things are put, and how much room there is."""
    holder = by_id.get(goal.reference or "")
    if goal.relation not in HOLDING or holder is None:
        return []
    room = []
    for point in holder.asset.annotation.functional_points:
        width, depth = holder.asset.opening(point).size
        part = f" its {part_words(point.part)}" if point.part else " it"
        room.append(f"{point.holds}{part} ({width * 100:.1f} × {depth * 100:.1f} cm)")
    phrase = holder.record.phrase
    word = f"in the {part_words(goal.part)} of" if goal.part else "in" if goal.relation == "inside" else "on"
    there = f"they go {listed(dict.fromkeys(room))}" if room else "it holds nothing"
    return [f"nothing is put {word} the {phrase}: {there}"]


_MISSING = {
    "reads_codes": "no scanner stands there",
    "weighs": "no scale stands there",
    "hits": "no tool with a head to hit with stands there",
    "wipes": "no tool with a pad to wipe with stands there",
}
"""Property of a tool → the reason where no object has it."""


def _no_tool(goal: Goal, objects: Sequence[SceneObject]) -> list[str]:
    """The reason why a thing cannot be scanned, weighed, hit or wiped: nothing stands there to do it with."""
    tool = goal.kind.tool
    if tool is None or any(getattr(o.kind(), tool) for o in objects if o.id != goal.subject):
        return []
    return [_MISSING[tool]]


def _with_reasons(alike: Sequence[_RuledOut]) -> str:
    """The first of some goals that fail for the same reasons, the number of others, and the reasons."""
    more = f" and {len(alike) - 1} more like it" if len(alike) > 1 else ""
    return f"{alike[0].asked.goal}{more} ({alike[0].asked.words!r}): {', '.join(alike[0].reasons[:3])}"


def require_fronts(goals: Sequence[AskedGoal], objects: Sequence[SceneObject]) -> None:
    """Refuse to turn an object without a front to the robot.

    Raises:
        NoFeasibleTask: names the goal and the object.
    """
    by_id = {o.id: o for o in objects}
    for one in goals:
        thing = by_id.get(one.goal.subject)
        if one.goal.relation == HEADING and thing is not None and not thing.asset.annotation.front:
            raise NoFeasibleTask(
                f"the {thing.record.phrase} has no front that could face the robot ({one.words!r})",
                hint="ask it of a thing with a front, such as a cereal box, a sign or an alarm clock",
                details={"missing": [str(one.goal)], "reasons": ["it has no front"]},
            )


def require_room_for_hands(goals: Sequence[AskedGoal], objects: Sequence[SceneObject], arms: Mapping[str, Arm]) -> None:
    """Refuse to hand over, or to hold with both arms, an object that can be carried, and has no room for two hands.

    Raises:
        NoFeasibleTask: names the goal and the object.
    """
    by_id = {o.id: o for o in objects if o.asset.annotation.carrying_points}
    for one in goals:
        thing = by_id.get(one.goal.subject)
        lacks = None if thing is None else _lacking_room(one.goal, thing, arms)
        if lacks is not None:
            why, hint = lacks
            details = {"missing": [str(one.goal)], "reasons": [why]}
            raise NoFeasibleTask(f"{why} ({one.words!r})", hint=hint, details=details)


def _lacking_room(goal: Goal, thing: SceneObject, arms: Mapping[str, Arm]) -> tuple[str, str] | None:
    """Why two hands have no room on an object, and a hint; None where they have, or one hand is enough."""
    if goal.kind.arms == 2:
        if any(places_for_both(thing, arm.gripper) for arm in arms.values()):
            return None
        why = f"{thing.record.phrase} has no two places at which two hands can hold it"
        return why, "ask it of a thing with two handles or a long one, such as a pot, a rolling pin or a hammer"
    if goal.relation != "handed" or goal.reference not in arms:
        return None
    taker = arms[goal.reference].gripper
    givers = [arm.gripper for name, arm in arms.items() if name != goal.reference]
    if not givers or any(has_room_beside(thing, giver, taker) for giver in givers):
        return None
    return no_room_for_hands(thing, taker), "ask it of a longer thing, such as a long block, a hammer or a bottle"


def require_only_stood_up(goals: Sequence[AskedGoal], objects: Sequence[SceneObject]) -> None:
    """Refuse anything with an object that lies on its side but standing it up, and putting things beside it after that.

    Raises:
        NoFeasibleTask: names the goal and the object.
    """
    lying = {o.id: o.record.phrase for o in objects if o.asset.standing is not None}
    stands = {one.goal.subject: one.step for one in goals if one.goal.relation == "upright"}
    for one in goals:
        beside = one.goal.relation in _BESIDE and one.step >= stands.get(str(one.goal.reference), math.inf)
        able = {one.goal.subject: one.goal.relation in _STANDING, one.goal.reference: beside}
        name = next((n for n, fine in able.items() if n in lying and not fine), None)
        if name is not None:
            raise NoFeasibleTask(
                f"the {lying[name]} lies on its side at the start, and is only put down standing ({one.words!r})",
                hint="say where it is to stand, or ask for the rest in a task of its own",
                details={"missing": [str(one.goal)], "reasons": ["it lies on its side"]},
            )


_BESIDE = ("left_of", "right_of", "in_front_of", "behind", "beside", "near")
_STANDING = ("upright", "inside", "on", "centred", *_BESIDE)
"""Words of goals about where an object is put down."""


def require_level(goals: Sequence[AskedGoal], objects: Sequence[SceneObject], arms: Collection[Arm]) -> None:
    """Refuse to move an object that was filled before, or to fill one that is held up, if it tips in a hand.

    Steps are judged in order; in what order the goals of one step are done is left to the planner.

    Args:
        goals: that are asked for.
        objects: of the scene.
        arms: of the robot.

    Raises:
        NoFeasibleTask: names the container, its contents, and a possible order.
    """
    by_id, words = {o.id: o for o in objects}, {one.goal: one.words for one in goals}
    loads = _Loads({name for name, thing in by_id.items() if not stays_level(thing, arms)})
    for step in (sorted(goals_of_step, key=str) for goals_of_step in in_steps(goals)):
        if (poured := loads.poured(step)) is not None:
            raise _pours(by_id[str(poured.reference)], by_id[poured.subject], poured, words[poured])
        for goal, content in loads.tipped(step):
            raise _tips(by_id[goal.subject], by_id[content], goal, words[goal])
        loads.after(step)


@dataclass
class _Loads:
    """Contents of objects, and objects that are held up, from step to step of a task.

    Args:
        tipping: ids of objects that tip when one hand carries them.
        lies: object → the one in which it was put.
        held: ids of objects that one arm holds up.
    """

    tipping: Collection[str]
    lies: dict[str, str] = field(default_factory=dict)
    held: set[str] = field(default_factory=set)

    def poured(self, step: Sequence[Goal]) -> Goal | None:
        """The first goal of a step that puts something into or onto what tips in the hand that holds it up."""
        into = {name for name in self.held if name in self.tipping}
        return next((goal for goal in step if goal.relation in HOLDING and goal.reference in into), None)

    def tipped(self, step: Sequence[Goal]) -> list[tuple[Goal, str]]:
        """Goals of a step for which one hand carries what tips, each with an object that lies in it and stays there."""
        moved = _moved(step)
        laden = sorted((holder, other) for other, holder in self.lies.items() if holder in moved and other not in moved)
        carried = [(moved[name], content) for name, content in laden if name in self.tipping]
        return [(goal, content) for goal, content in carried if goal.kind.arms == 1]

    def after(self, step: Sequence[Goal]) -> None:
        """Note where things are when a step is done."""
        moved = _moved(step)
        put = {goal.subject: str(goal.reference) for goal in step if goal.relation == "inside" and goal.part is None}
        self.lies = {name: holder for name, holder in self.lies.items() if name not in moved} | put
        self.held |= {goal.subject for goal in step if goal.kind.fleeting and goal.kind.arms == 1}


def _moved(step: Sequence[Goal]) -> dict[str, Goal]:
    """Object → the goal of a step for which it is taken from its place."""
    return {goal.subject: goal for goal in step if goal.kind.moves}


def _tips(thing: SceneObject, content: SceneObject, goal: Goal, words: str) -> NoFeasibleTask:
    """The error about an object that tips when it is carried with its content."""
    name, other = thing.record.phrase, content.record.phrase
    return NoFeasibleTask(
        f"the {name} cannot be carried with the {other} in it ({words!r}): the gripper "
        "holds it only by its edge, where it tips",
        hint=f"ask to move the {name} first, and then to put the {other} into it",
        details={"missing": [str(goal)]},
    )


def _pours(thing: SceneObject, content: SceneObject, goal: Goal, words: str) -> NoFeasibleTask:
    """The error about an object that is held up and tips in the hand, so that nothing stays in it."""
    name, other = thing.record.phrase, content.record.phrase
    return NoFeasibleTask(
        f"the {other} cannot be put into the {name} while that is held up ({words!r}): the gripper "
        "holds it only by its edge or handle, where it tips",
        hint=f"ask to put the {other} into the {name} where it stands",
        details={"missing": [str(goal)]},
    )
