"""Slots of sub-tasks filled by a model: the answer type over feasible choices, its checks, and its meaning."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from vcage.models.structured import NONE, Answer, narrowed, one_of, one_or_none
from vcage.schema.subtasks import GraspOption, PlaceOption, Preference, SlotAnswer, SlotQuestion


class _Step(Answer):
    subtask: str
    grasp: str
    place: str
    statements: list[str]
    reason: str


class StepsAnswer(Answer):
    """The model's answer: one entry per sub-task."""

    steps: list[_Step]


def answer_type(questions: Sequence[SlotQuestion]) -> type[StepsAnswer]:
    """The type of an answer with names from the questions only."""
    grasps = {str(option): None for question in questions for option in _all_grasps(question)}
    places = {str(place.point): None for question in questions for place in question.places}
    statements = {str(statement): None for question in questions for statement in question.statements}
    item = narrowed(
        _Step,
        subtask=one_of([question.subtask for question in questions]),
        grasp=one_or_none(list(grasps)),
        place=one_or_none(list(places)),
        statements=list[one_or_none(list(statements))],  # pyrefly: ignore
    )
    return narrowed(StepsAnswer, steps=list[item])


def complaints(answer: StepsAnswer, questions: Sequence[SlotQuestion]) -> list[str]:
    """Complaints about an answer of the right type: names which step, and what it may say."""
    ids, given = [question.subtask for question in questions], [step.subtask for step in answer.steps]
    if given != ids:
        return [f"steps: expected one entry each for {', '.join(ids)}, in this order, got {', '.join(given) or 'none'}"]
    return [
        f"steps.{number}.{complaint}"
        for number, (step, question) in enumerate(zip(answer.steps, questions, strict=True))
        for complaint in _about(step, question)
    ]


def _about(step: _Step, question: SlotQuestion) -> Iterator[str]:
    """Complaints about the names of one step, each beginning with its field."""
    places = [str(place.point) for place in question.places]
    if step.place and step.place not in places:
        yield f"place: {step.place} is no place of {question.subtask}: {_listed(places)}"
        return  # its grasps are not known
    grasps = [str(option) for option in _grasps_at(question, step.place)]
    if step.grasp and step.grasp not in grasps:
        there = f"at place {step.place} of" if step.place else "of"
        yield f"grasp: {step.grasp} is no grasp {there} {question.subtask}: {_listed(grasps)}"
    known = [str(statement) for statement in question.statements]
    for name in step.statements:
        if name and name not in known:
            yield f"statements: {name!r} is no statement about {question.subtask}: {_listed(known)}"


def meaning(answer: StepsAnswer, questions: Sequence[SlotQuestion]) -> list[SlotAnswer]:
    """The answer in the records of the engine, one for each question; of an answer without complaints."""
    return [_slot_answer(step, question) for step, question in zip(answer.steps, questions, strict=True)]


def _slot_answer(step: _Step, question: SlotQuestion) -> SlotAnswer:
    grasps = [option for option in _grasps_at(question, step.place) if str(option) == step.grasp]
    return SlotAnswer(
        subtask=question.subtask,
        grasp=next((Preference(contact=option.contact, arm=option.arm) for option in grasps), None),
        point=int(step.place) if step.place else None,
        statements=[statement for statement in question.statements if str(statement) in step.statements],
    )


def _all_grasps(question: SlotQuestion) -> list[GraspOption]:
    return [*question.grasps, *(option for place in question.places for option in place.grasps)]


def _grasps_at(question: SlotQuestion, place: str) -> list[GraspOption]:
    """The grasps that are feasible at a place, given by its number; at the planned one when it is empty."""
    chosen: list[PlaceOption] = [one for one in question.places if str(one.point) == place]
    return chosen[0].grasps if chosen else question.grasps


def _listed(names: Sequence[str]) -> str:
    return f"it has {', '.join(names)}, or say {NONE!r}" if names else f"it has none, say {NONE!r}"
