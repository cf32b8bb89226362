"""Asking a model for the goals of an instruction.

The type of the answer holds names of the scene only. Three checks follow: by code, by a reader without a model where it
reads the sentence, and by a question more.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection

from vcage.base.errors import UnreadInstruction
from vcage.base.text import listed, one_line
from vcage.goals import KINDS, forms, words
from vcage.models import prompts
from vcage.models.checked_reading import Instructed
from vcage.models.same_reading import ThirdReader, contradictions
from vcage.models.structured import Answer, Asking, narrowed, one_of, one_or_none
from vcage.plans.consistency import inconsistencies
from vcage.plans.plain_words import reading_in_words
from vcage.plans.relations import DIRECTIONS
from vcage.schema.goals import AskedGoal, Description, Reading, RelationWord, goal_of
from vcage.schema.plan import TABLE


class _ReviewAnswer(Answer):
    lacks: list[str]
    adds: list[str]


def read_goals(ask: Asking, read: Instructed, reviewer: Asking | None, third: ThirdReader | None) -> Reading:
    """The model's reading, once no check complains about it.

    Args:
        ask: puts a prompt to the model.
        read: the instruction and its objects.
        reviewer: puts the review to a model; None for no review.
        third: a reader without a model; None for none.

    Raises:
        UnreadInstruction: words of it answer to no goal; or other objects are needed, and
            ``details["wrong_objects"]`` says why.
        ModelRefused: see :func:`vcage.models.structured.ask`.
    """
    prompt = prompts.fill(
        "read_goals",
        instruction=read.instruction,
        things=dict(read.things),
        lying=dict(read.lying),
        contents=list(read.moved),
        forms=forms(),
    )
    found = ask(prompt, answer_type(read), lambda a: _complaints(a, read, reviewer, third))
    if found.unread or found.wrong_objects:
        said = "; ".join([*found.unread, *found.wrong_objects])
        why = "no goal answers it" if found.unread else "the objects that were chosen do not allow it"
        error = UnreadInstruction.of(read.instruction, said, why)
        error.details["wrong_objects"] = [] if found.unread else list(found.wrong_objects)
        raise error
    return reading_of(found)


def _complaints(answer: GoalsAnswer, read: Instructed, reviewer: Asking | None, third: ThirdReader | None) -> list[str]:
    """The complaints of the first check that has any: later ones cost more."""
    if answer.unread or answer.wrong_objects:
        return ["goals: is not empty, although unread or wrong_objects is not"] if answer.goals else []
    found = misshapen(answer, read)
    if found:
        return found
    reading = reading_of(answer)
    return (
        inconsistencies(reading.goals, reading.descriptions)
        or contradictions(read, reading, third)
        or _review(reading, read, reviewer)
    )


def _review(reading: Reading, read: Instructed, reviewer: Asking | None) -> list[str]:
    """Requests that the goals lack or add, according to a model that reads them in plain words."""
    if reviewer is None:
        return []
    phrases = read.phrases
    prompt = prompts.fill(
        "review_goals",
        instruction=read.instruction,
        phrases=phrases,
        lying={name: read.lying.get(name, "") for name in phrases},
        sentences=reading_in_words(reading, phrases),
    )
    found = reviewer(prompt, _ReviewAnswer, lambda _: [])
    lacks = [f"a review says that the goals lack this: {text}" for text in found.lacks if text.strip()]
    return lacks + [f"a review says that the goals add this: {text}" for text in found.adds if text.strip()]


ARMS = ("left", "right")


class ReadGoal(Answer):
    """A goal as answered; a missing name is empty."""

    relation: str
    subject: str
    reference: str
    part: str
    step: int
    arm: str
    words: str


class ReadDescription(Answer):
    """A description as it is answered."""

    subject: str
    relation: RelationWord
    reference: str
    part: str
    words: str


class GoalsAnswer(Answer):
    """A model's answer about an instruction."""

    wrong_objects: list[str]
    unread: list[str]
    goals: list[ReadGoal]
    descriptions: list[ReadDescription]
    untouched: list[str]


def answer_type(read: Instructed) -> type[GoalsAnswer]:
    """The type of an answer that names objects, parts and arms of the scene only."""
    names = list(read.things)
    parts = one_or_none(sorted({part for entry in read.things.values() for part in entry.parts}))
    goal = narrowed(
        ReadGoal,
        relation=one_of(words()),
        subject=one_of(names),
        reference=one_or_none([*dict.fromkeys([TABLE, *ARMS, *names])]),
        part=parts,
        arm=one_or_none(ARMS),
    )
    described = narrowed(ReadDescription, subject=one_of(names), reference=one_of([TABLE, *names]), part=parts)
    return narrowed(
        GoalsAnswer,
        goals=list[goal],
        descriptions=list[described],
        untouched=list[one_of(names)],  # pyrefly: ignore
    )


def misshapen(answer: GoalsAnswer, read: Instructed) -> list[str]:
    """Complaints about each goal and description by itself, one sentence each."""
    found = [] if answer.goals else ["goals: is empty, and so are unread and wrong_objects"]
    said = Counter(str(goal) for goal in answer.goals)
    found += [f"goals: the same is given {count} times: {goal}" for goal, count in said.items() if count > 1]
    for number, goal in enumerate(answer.goals):
        found += [f"goals.{number}: {text}" for text in _wrong_goal(goal, answer.untouched, read)]
    for number, described in enumerate(answer.descriptions):
        found += [f"descriptions.{number}: {text}" for text in _wrong_description(described, read)]
    placed = {described.subject for described in answer.descriptions if described.relation in ("inside", "on")}
    return found + [
        f"descriptions: {name} starts in or on {read.lying[name]}, and no description says so"
        for name in read.moved
        if name in read.lying and name not in placed
    ]


def _wrong_goal(goal: ReadGoal, untouched: Collection[str], read: Instructed) -> list[str]:
    found = _wrong_words(goal.words, read.instruction)
    kind = KINDS[goal.relation]
    owner = goal.subject if kind.part_of == "subject" else goal.reference
    if goal.step < 1:
        found.append(f"step counts from 1, got {goal.step}")
    if (kind.refers_to is not None) != bool(goal.reference):
        found.append(f"{goal.relation!r} takes {'a' if kind.refers_to else 'no'} reference")
    elif (kind.refers_to == "arm") != (goal.reference in ARMS):
        found.append(f"{goal.reference!r} is no reference for {goal.relation!r}")
    if kind.acts_on is not None and not goal.part:
        found.append(f"{goal.relation!r} needs the part")
    if goal.part and kind.part_of is None:
        found.append(f"{goal.relation!r} takes no part")
    elif goal.part:
        found += _wrong_part(owner, goal.part, read)
    return found + _wrong_subject(goal, untouched)


def _wrong_subject(goal: ReadGoal, untouched: Collection[str]) -> list[str]:
    found = []
    if goal.reference == TABLE and goal.relation != "on":
        found.append(f"{goal.subject} cannot be {goal.relation} the table, only 'on' it")
    if goal.subject == goal.reference:
        found.append(f"{goal.subject} is its own reference")
    if goal.subject in untouched:
        found.append(f"{goal.subject} is also said to be untouched")
    return found


def _wrong_description(described: ReadDescription, read: Instructed) -> list[str]:
    found = _wrong_words(described.words, read.instruction)
    if described.reference == TABLE and described.relation not in (*DIRECTIONS, "center"):
        found.append(f"{described.relation!r} says nothing of a place on the table")
    if described.subject == described.reference:
        found.append(f"{described.subject} is its own reference")
    if described.part and described.relation not in ("inside", "on"):
        found.append(f"{described.relation!r} takes no part")
    return found + (_wrong_part(described.reference, described.part, read) if described.part else [])


def _wrong_words(words: str, instruction: str) -> list[str]:
    said = one_line(words).strip().rstrip(".!").casefold()
    copied = bool(said) and said in one_line(instruction).casefold()
    return [] if copied else [f"words are not copied from the instruction: {words!r}"]


def _wrong_part(owner: str, part: str, read: Instructed) -> list[str]:
    parts = read.things[owner].parts if owner in read.things else []
    known = f"; it has {listed(parts)}" if parts else ""
    return [] if part in parts else [f"{owner} has no part {part!r}{known}"]


def reading_of(answer: GoalsAnswer) -> Reading:
    """The reading that an answer without complaints stands for; empty names become None."""
    goals, described = answer.model_dump()["goals"], answer.model_dump()["descriptions"]
    of_goal = ("subject", "relation", "reference", "part")
    return Reading(
        goals=[
            AskedGoal(
                goal=goal_of([goal[name] or None for name in of_goal]),
                step=goal["step"],
                words=goal["words"],
                arm=goal["arm"] or None,
            )
            for goal in goals
        ],
        untouched=list(dict.fromkeys(answer.untouched)),
        descriptions=[Description.model_validate(one | {"part": one["part"] or None}) for one in described],
    )
