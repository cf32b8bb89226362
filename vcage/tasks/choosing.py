"""Slots of a chain's sub-tasks that a reasoner may fill: feasible grasps and places, and statements to check."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from vcage.plans.actions import HOLDING, Action, State
from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE
from vcage.schema.subtasks import (
    Grasp,
    GraspOption,
    PlaceOption,
    Preference,
    SlotAnswer,
    SlotQuestion,
    Statement,
    Subtask,
)
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import StillState
from vcage.tasks.templates.push import HEADINGS
from vcage.tasks.truth import goals_hold

_STAYS = ("open", "closed", *HOLDING)
"""Goals that may be said to stay true."""


def slot_questions(
    chain: Sequence[Subtask],
    kept: Iterable[Subtask],
    objects: Sequence[SceneObject],
    initial: State,
    actions: Mapping[str, Action],
) -> list[SlotQuestion]:
    """Choices in each sub-task of a chain.

    Args:
        chain: the sub-tasks, in order.
        kept: all feasible ones, including equivalents at other places.
        objects: of the scene, at the start of the chain.
        initial: goals true at that time.
        actions: of the chain's sub-tasks, by id.
    """
    by_id, others, state = {o.id: o for o in objects}, list(kept), initial
    # A part that stands half open is neither: nothing may be said of it.
    unclear = {g for g in initial if g.relation in _STAYS and g.reference != TABLE and not _holds(g, by_id)}
    found = []
    for subtask in chain:
        after = actions[subtask.id].after(state)
        elsewhere = [one for one in others if _same_elsewhere(one, subtask)]
        held = by_id[subtask.grasped or subtask.object]
        found.append(
            SlotQuestion(
                subtask=subtask.id,
                text=subtask.text,
                held=held.record.phrase,
                grasps=_grasps(subtask, by_id),
                places=[_place(one, by_id) for one in (subtask, *elsewhere)] if elsewhere else [],
                statements=_statements(subtask, by_id, state, (state & after) - unclear),
            )
        )
        state = after
    return [_in_every_turn(question, found) for question in found]


def _in_every_turn(question: SlotQuestion, questions: Sequence[SlotQuestion]) -> SlotQuestion:
    """A question with the statements that are true whenever its sub-task is done: a chain may do it twice."""
    same = [one for one in questions if one.subtask == question.subtask]
    stays = [s for s in question.statements if all(s in one.statements for one in same)]
    return question.model_copy(update={"statements": stays})


def filled(chain: Sequence[Subtask], kept: Mapping[str, Subtask], answers: Sequence[SlotAnswer]) -> list[Subtask]:
    """The chain as a reasoner would have it done: its place and grasp first, with its statements to check.

    Args:
        chain: the sub-tasks, in order.
        kept: all that were found, by id.
        answers: one for each of the chain.
    """
    return [_filled(subtask, kept.values(), answer) for subtask, answer in zip(chain, answers, strict=True)]


def checked(chain: Sequence[Subtask], answers: Sequence[SlotAnswer]) -> list[Subtask]:
    """The chain as it is ranked, with the reasoner's statements to check.

    Args: as of :func:`filled`.
    """
    return [s.model_copy(update={"statements": a.statements}) for s, a in zip(chain, answers, strict=True)]


def with_open_parts(subtask: Subtask, question: SlotQuestion, answer: SlotAnswer) -> SlotAnswer:
    """An answer with the statements that other open parts of the handled things stay open: their look depends on it.

    Args:
        subtask: that is asked about.
        question: with all that it leaves true.
        answer: of the reasoner.
    """
    things = {subtask.object, subtask.receptacle, subtask.grasped}
    stay_open = [s for s in question.statements if s.word == "open" and s.subject in things]
    return answer.model_copy(update={"statements": list(dict.fromkeys([*answer.statements, *stay_open]))})


def as_chosen(found: Subtask, subtask: Subtask) -> Subtask:
    """A sub-task that was examined again, with the earlier choices of the reasoner.

    Args:
        found: among objects at other places.
        subtask: the original.
    """
    update = {"prefers": subtask.prefers, "statements": subtask.statements}
    return found.model_copy(update={**update, "grasps": preferred_first(found.grasps, subtask.prefers)})


def preferred_first(grasps: Sequence[Grasp], prefers: Preference | None) -> list[Grasp]:
    """Some grasps, the preferred one first where it is among them, the others in their order."""
    return sorted(grasps, key=lambda g: prefers is None or (g.contact, g.arm) != (prefers.contact, prefers.arm))


def moved_by(subtask: Subtask) -> set[str]:
    """Ids of the objects that a sub-task moves as a whole."""
    carried = {subtask.object} if subtask.receptacle is not None else set[str]()
    return carried if subtask.grasped is None else carried | {subtask.grasped}


def _filled(subtask: Subtask, kept: Iterable[Subtask], answer: SlotAnswer) -> Subtask:
    there = [s for s in kept if _same_elsewhere(s, subtask) and s.functional_point == answer.point]
    chosen = next(iter(there), subtask)
    return as_chosen(chosen, chosen.model_copy(update={"prefers": answer.grasp, "statements": answer.statements}))


def _same_elsewhere(one: Subtask, subtask: Subtask) -> bool:
    """Check if a sub-task does the same as another at another functional point of the same object."""
    same = all(
        getattr(one, name) == getattr(subtask, name)
        for name in ("template", "object", "receptacle", "requires", "goals", "arm", "hand_to")
    )
    return same and one.functional_point != subtask.functional_point


def _place(subtask: Subtask, objects: Mapping[str, SceneObject]) -> PlaceOption:
    annotation = objects[str(subtask.receptacle)].asset.annotation
    point = annotation.functional_point(int(subtask.functional_point or 0))
    return PlaceOption(point=point.id, name=point.name, subtask=subtask.id, grasps=_grasps(subtask, objects))


def _grasps(subtask: Subtask, objects: Mapping[str, SceneObject]) -> list[GraspOption]:
    kind = objects[subtask.grasped or subtask.object].asset.annotation

    def name(contact: int) -> str:
        if subtask.template == "push":
            return f"side, pushed at {np.degrees(HEADINGS[contact]):.0f}° from its own +x"
        return kind.contact_point(contact).name

    return [GraspOption(contact=g.contact, name=name(g.contact), arm=g.arm) for g in subtask.grasps]


def _statements(subtask: Subtask, objects: Mapping[str, SceneObject], before: State, stays: State) -> list[Statement]:
    """Statements that a sub-task leaves true: other objects are unmoved, and facts hold before and after."""
    lies = {g.subject: g.reference for g in before if g.relation in HOLDING}
    handled = moved_by(subtask) | {subtask.object}
    still = [name for name in objects if not _rides(name, lies, handled) and name not in moved_by(subtask)]
    facts = sorted((g for g in stays if g.relation in _STAYS and g.reference != TABLE), key=str)
    return [
        *(Statement(subject=name, word="unmoved") for name in still),
        *(_statement(g) for g in facts),
    ]


def _statement(goal: Goal) -> Statement:
    fields = {"subject": goal.subject, "word": goal.relation, "reference": goal.reference, "part": goal.part}
    return Statement.model_validate(fields)


def _rides(name: str, lies: Mapping[str, str | None], handled: set[str]) -> bool:
    """True if an object lies in or on a handled one."""
    holder = lies.get(name)
    return holder is not None and (holder in handled or _rides(holder, lies, handled))


def _holds(goal: Goal, objects: Mapping[str, SceneObject]) -> bool:
    return goals_hold([goal], StillState(objects)).success
