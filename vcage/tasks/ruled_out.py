"""Goals that nothing brings about wherever the objects stand: of the wrong size, without a place, or without a tool."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from vcage.base.errors import NoFeasibleTask
from vcage.base.text import listed
from vcage.plans.actions import HOLDING
from vcage.schema.goals import AskedGoal, Goal, part_words
from vcage.schema.subtasks import PairAnswer, PairQuestion
from vcage.tasks.asked_arms import require_arms
from vcage.tasks.filled import require_level
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import SMALLER, is_about, sensible


def require_way(goals: Sequence[AskedGoal], objects: Sequence[SceneObject], arms: Collection[str]) -> None:
    """Nothing, unless sizes rule out a goal wherever the objects stand, nothing is put in or on what it names, or its
    tool is missing.

    Args:
        goals: that are asked for.
        objects: of the scene; where they stand does not matter.
        arms: of the robot.

    Raises:
        NoFeasibleTask: names each such goal with its words, and why; also what would have to be carried with something
            in it that would fall out, and what is asked of an arm that is not there.
    """
    require_arms(goals, arms)
    require_level(goals, objects)
    asked = [one.goal for one in goals]
    found, refused, _ = sensible(objects, _all_sensible, asked)
    able = {goal for proposal in found for goal in proposal.goals}
    ruled_out = {}
    by_id = {o.id: o for o in objects}
    alike: dict[tuple[str, ...], list[str]] = {}  # things of one kind fail for the same reasons
    for one in goals:
        reasons = list(dict.fromkeys(refusal.reason for refusal in refused if is_about(refusal, one.goal)))
        reasons = reasons or _no_place(one.goal, by_id) or _no_tool(one.goal, objects)
        if one.goal not in able and reasons:
            ruled_out[str(one.goal)] = (one.words, reasons)
            phrase = by_id[one.goal.subject].record.phrase
            alike.setdefault((one.words, *(reason.replace(phrase, "") for reason in reasons)), []).append(str(one.goal))
    if ruled_out:
        told = [_with_reasons(goals, *ruled_out[goals[0]]) for goals in alike.values()]
        raise NoFeasibleTask(
            f"wherever the objects stand, nothing can bring about {'; '.join(told)}",
            hint=f"{SMALLER}; another --seed does not help",
            details={"missing": list(ruled_out), "reasons": [r for _, reasons in ruled_out.values() for r in reasons]},
        )


def _no_place(goal: Goal, by_id: Mapping[str, SceneObject]) -> list[str]:
    """That nothing is put in or on an object so: says where things are put, and how much room there is."""
    holder = by_id.get(goal.reference or "")
    if goal.relation not in HOLDING or holder is None:
        return []
    room = []
    for point in holder.asset.annotation.functional_points:
        width, depth = holder.asset.opening(point).size
        part = f" its {part_words(point.link)}" if point.link else " it"
        room.append(f"{point.holds}{part} ({width * 100:.1f} × {depth * 100:.1f} cm)")
    phrase = holder.record.phrase
    word = f"in the {part_words(goal.part)} of" if goal.part else "in" if goal.relation == "inside" else "on"
    there = f"they go {listed(dict.fromkeys(room))}" if room else "it holds nothing"
    return [f"nothing is put {word} the {phrase}: {there}"]


def _no_tool(goal: Goal, objects: Sequence[SceneObject]) -> list[str]:
    """That nothing stands there to scan or weigh with."""
    kinds = [o.asset.annotation for o in objects if o.id != goal.subject]
    if goal.relation == "scanned" and not any(kind.faces_of("reader") for kind in kinds):
        return ["no scanner stands there"]
    if goal.relation == "weighed" and not any(point.weighs for kind in kinds for point in kind.functional_points):
        return ["no scale stands there"]
    return []


def _with_reasons(goals: Sequence[str], words: str, reasons: Sequence[str]) -> str:
    """The first of some goals that fail for the same reasons, how many more there are, and the reasons."""
    more = f" and {len(goals) - 1} more like it" if len(goals) > 1 else ""
    return f"{goals[0]}{more} ({words!r}): {', '.join(reasons[:3])}"


def _all_sensible(questions: Sequence[PairQuestion]) -> list[PairAnswer]:
    """A judge that leaves it to the one who is asked later."""
    return [PairAnswer(object=q.object, receptacle=q.receptacle, sensible=True, reason="not asked") for q in questions]
