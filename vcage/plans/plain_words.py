"""Goals, relations and descriptions as a person says them."""

from __future__ import annotations

from collections.abc import Mapping

from vcage.schema.goals import AskedGoal, Description, Goal, Reading, part_words
from vcage.schema.plan import TABLE

_BETWEEN: Mapping[str, str] = {
    "inside": "inside", "on": "on", "left_of": "to the left of", "right_of": "to the right of",
    "in_front_of": "in front of", "behind": "behind", "beside": "beside", "near": "near",
    "center": "in the middle of", "row_left_of": "in a row to the left of",
    "in_place_of": "at the old place of", "poured": "into", "hung_on": "on", "inserted_in": "in",
}  # fmt: skip
_ON_TABLE: Mapping[str, str] = {
    "on": "on", "left_of": "on the left of", "right_of": "on the right of", "in_front_of": "at the front of",
    "behind": "at the back of", "center": "in the middle of",
}  # fmt: skip


def relation_in_words(word: str, reference: str, phrases: Mapping[str, str], part: str | None = None) -> str:
    """A relation and its reference as a person says it: ``to the left of the blue plate``.

    Args:
        word: the relation.
        reference: id of an object, or ``table``.
        phrases: name of each object, by id; the id itself of missing ones.
        part: of the reference.
    """
    if reference == TABLE:
        return f"{_ON_TABLE.get(word, word)} the table"
    of_part = "" if part is None else f"the {part_words(part)} of "
    return f"{_BETWEEN[word]} {of_part}the {phrases.get(reference, reference)}"


def in_words(description: Description, phrases: Mapping[str, str]) -> str:
    """A description as a sentence without its full stop: ``the white plate is to the left of the blue plate``."""
    d = description
    where = relation_in_words(d.relation, d.reference, phrases, d.part)
    return f"the {phrases.get(d.subject, d.subject)} is {where}"


def goal_in_words(goal: Goal, phrases: Mapping[str, str]) -> str:
    """A goal as a sentence without its full stop: ``the red marker is inside the top drawer of the cabinet``."""
    thing, where = f"the {phrases.get(goal.subject, goal.subject)}", ""
    if goal.kind.refers_to == "object":
        where = relation_in_words(goal.relation, str(goal.reference), phrases, goal.part)
    elif goal.part is not None:
        thing = f"the {part_words(goal.part)} of {thing}"
    return goal.kind.plain.format(thing=thing, where=where, reference=goal.reference)


def reading_in_words(reading: Reading, phrases: Mapping[str, str]) -> list[str]:
    """A reading as a list of sentences: the start, the actions in order, the objects left alone."""
    found = [f"At the start {in_words(described, phrases)}." for described in reading.descriptions]
    steps = sorted({asked.step for asked in reading.goals})
    for number, step in enumerate(steps, 1):
        order = f"Step {number}: " if len(steps) > 1 else ""
        found += [f"{order}{_goal_in_words(asked, phrases)}." for asked in reading.goals if asked.step == step]
    return found + [f"The {phrases.get(name, name)} is left alone." for name in reading.untouched]


def _goal_in_words(asked: AskedGoal, phrases: Mapping[str, str]) -> str:
    arm = f", by the {asked.arm} arm" if asked.arm else ""
    return f"{goal_in_words(asked.goal, phrases)}{arm}"
