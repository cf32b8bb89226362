"""Compare two readings of an instruction, up to objects that look alike."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping

from vcage.base.errors import UnreadInstruction
from vcage.models.checked_reading import Instructed
from vcage.models.second_look import second_look
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import AskedGoal, Description, Reading

ThirdReader = Callable[[Instructed], Reading]
"""Reads an instruction without a model, or raises UnreadInstruction."""

_SWAPPED = {"right_of": "left_of", "behind": "in_front_of"}
"""Relations that say the same as another one with subject and reference exchanged."""


def contradictions(asked: Instructed, reading: Reading, third: ThirdReader | None) -> list[str]:
    """Complaints about a reading by the second look, or else by a reader without a model where it reads all of it.

    Args:
        asked: the instruction.
        reading: what is taken from it.
        third: a reader without a model; None for none.
    """
    found = second_look(asked, reading)
    if found or third is None:
        return found
    try:
        other = third(asked)
    except UnreadInstruction:  # not a complaint about the reading
        return []
    if second_look(Instructed(asked.instruction, asked.things), other):
        return []
    missing, more = differences(reading, other, asked.things)
    found = [f"a grammar reads the instruction otherwise: it asks for {one}" for one in missing]
    return found + [f"a grammar reads the instruction otherwise: it does not ask for {one}" for one in more]


def differences(reading: Reading, other: Reading, things: Mapping[str, CatalogueEntry]) -> tuple[list[str], list[str]]:
    """Things that one of two readings asks for and the other does not.

    Objects of one kind and look may replace each other. An order only in this reading is no difference: following
    it does no harm.

    Args:
        reading, other: of the same instruction.
        things: the catalogue's entries by object id, with no other look than the object's.
    """
    looks = {name: f"{entry.name}/{entry.variants[0].id}" for name, entry in things.items()}
    mine = Counter(_goal(asked, looks) for asked in reading.goals)
    theirs = Counter(_goal(asked, looks) for asked in other.goals)
    texts: dict[tuple[str, ...], str] = {}
    for asked in (*reading.goals, *other.goals):
        texts.setdefault(_goal(asked, looks), f"{asked.goal}{f' by the {asked.arm} arm' if asked.arm else ''}")
    missing = [texts[goal] for goal in (theirs - mine).elements()]
    more = [texts[goal] for goal in (mine - theirs).elements()]
    missing += _missing_statements(other, reading, looks)
    more += _missing_statements(reading, other, looks)
    if not missing and not more:
        missing += _out_of_order(reading, other, looks)
    return missing, more


def _missing_statements(reading: Reading, other: Reading, looks: Mapping[str, str]) -> list[str]:
    """Descriptions and untouched objects that one reading has and the other lacks."""
    stated = {_description(one, looks) for one in other.descriptions}
    alone = {looks.get(name, name) for name in other.untouched}
    found = [f"{one} at the start" for one in reading.descriptions if _description(one, looks) not in stated]
    return found + [f"{name} left alone" for name in reading.untouched if looks.get(name, name) not in alone]


def _goal(asked: AskedGoal, looks: Mapping[str, str]) -> tuple[str, ...]:
    goal = asked.goal
    subject, reference = looks.get(goal.subject, goal.subject), str(goal.reference)
    subject, word, reference = _one_way(subject, goal.relation, looks.get(reference, reference))
    return subject, word, reference, goal.part or "", asked.arm or ""


def _description(described: Description, looks: Mapping[str, str]) -> tuple[str, ...]:
    subject, reference = (
        looks.get(described.subject, described.subject),
        looks.get(described.reference, described.reference),
    )
    return (*_one_way(subject, described.relation, reference), described.part or "")


def _one_way(subject: str, word: str, reference: str) -> tuple[str, str, str]:
    return (reference, _SWAPPED[word], subject) if word in _SWAPPED else (subject, word, reference)


def _out_of_order(reading: Reading, other: Reading, looks: Mapping[str, str]) -> list[str]:
    """Pairs of goals ordered in the other reading and not in this one; a repeated goal is skipped."""
    steps = {_goal(asked, looks): asked.step for asked in reading.goals}
    count = Counter(_goal(asked, looks) for asked in other.goals)
    once = [asked for asked in other.goals if count[_goal(asked, looks)] == 1]
    return [
        f"{first.goal} before {then.goal}"
        for first in once
        for then in once
        if first.step < then.step and steps[_goal(first, looks)] >= steps[_goal(then, looks)]
    ]
