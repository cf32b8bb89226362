"""One plain sentence that asks for given goals in their order: an instruction for goals that nobody put into words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from vcage.base.errors import UsageError
from vcage.base.words import NUMBERS
from vcage.schema.goals import OF_A_PART, AskedGoal, Description, Goal, part_words
from vcage.schema.plan import TABLE
from vcage.tasks.wording import wordings

_WHERE = {
    "inside": "in", "on": "on", "left_of": "to the left of", "right_of": "to the right of",
    "in_front_of": "in front of", "behind": "behind", "beside": "next to", "near": "near",
}  # fmt: skip
_OF_THE_TABLE = {
    "center": "in the middle of", "left_of": "on the left of", "right_of": "on the right of",
    "in_front_of": "at the front of", "behind": "at the back of",
}  # fmt: skip
_COUNTS = {NUMBERS[word]: word for word in ("two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")}


@dataclass(frozen=True)
class Called:
    """What an object is called.

    Args:
        phrase: "white plate".
        plural: "white plates".
    """

    phrase: str
    plural: str


@dataclass(frozen=True)
class Sentence:
    """A sentence, and the words of it that ask for each goal and say each start condition.

    Args:
        text: the whole.
        goals: as they were given, each with its clause.
        descriptions: as they were given, each with its words; with the whole where the sentence has no use for it.
    """

    text: str
    goals: list[AskedGoal]
    descriptions: list[Description]


def sentence_of(
    goals: Sequence[AskedGoal], descriptions: Sequence[Description], called: Mapping[str, Called]
) -> Sentence:
    """The plainest sentence: "Put the red marker pen into the packaging box, then close the lid of the lidded box."

    Args:
        goals: in their order; their words do not matter.
        descriptions: of where things are at the start; they tell apart what is called the same.
        called: all objects of the scene, by id.

    Raises:
        UsageError: objects are called the same, and nothing tells apart which of them a goal means.
    """
    return _Writer(descriptions, called).write(goals)


class _Writer:
    """Writes one sentence; remembers what was mentioned."""

    def __init__(self, descriptions: Sequence[Description], called: Mapping[str, Called]):
        self._descriptions, self._called = descriptions, called
        self._alike = Counter(one.phrase for one in called.values())
        self._mentioned: set[str] = set()
        self._said: dict[Description, str] = {}

    def write(self, goals: Sequence[AskedGoal]) -> Sentence:
        steps: list[str] = []
        asked: list[AskedGoal] = []
        for _, step in groupby(goals, key=lambda one: one.step):
            clauses: list[str] = []
            for group in _groups(list(step)):
                clause = self._clause([one.goal for one in group], group[0].arm)
                clause = clause if not steps and not clauses else clause[0].lower() + clause[1:]
                asked += [one.model_copy(update={"words": clause}) for one in group]
                clauses.append(clause)
            steps.append(" and ".join([", ".join(clauses[:-1]), clauses[-1]] if clauses[1:] else clauses))
        text = f"{', then '.join(steps)}."
        told = [one.model_copy(update={"words": self._said.get(one, text)}) for one in self._descriptions]
        return Sentence(text, [next(a for a in asked if _same(a, one)) for one in goals], told)

    def _clause(self, goals: Sequence[Goal], arm: str | None) -> str:
        """What asks for goals that differ in their subject alone, as a command without its full stop."""
        goal = goals[0]
        phrases = {goal.subject: self._noun([one.subject for one in goals])}
        if goal.reference in self._called:
            phrases[str(goal.reference)] = self._noun([str(goal.reference)])
        plain = next(text for text in wordings(goal, phrases) if "," not in text).rstrip(".")
        return plain if arm is None else f"{plain} with the {arm} arm"

    def _noun(self, names: Sequence[str]) -> str:
        """What comes after "the" to name some objects: "apple and the lemon", "two blocks"."""
        phrases = list(dict.fromkeys(self._called[name].phrase for name in names))
        nouns: list[str] = []
        for phrase in phrases:
            alike = [name for name in names if self._called[name].phrase == phrase]
            if len(alike) == self._alike[phrase] > 1:
                number = _COUNTS.get(len(alike), str(len(alike)))
                nouns.append(f"{number} {self._called[alike[0]].plural}")
            else:
                nouns += [self._one(name) for name in alike]
        return " and the ".join([", the ".join(nouns[:-1]), nouns[-1]] if nouns[1:] else nouns)

    def _one(self, name: str) -> str:
        """One object; with where it is at the start when it is first mentioned, or when others are called the same."""
        phrase = self._called[name].phrase
        own = self._start_of(name)
        alone, new = self._alike[phrase] == 1, name not in self._mentioned
        self._mentioned.add(name)
        others = [o for o, called in self._called.items() if called.phrase == phrase and o != name]
        unique = all({*own.values()} != {*self._start_of(other).values()} for other in others)
        if own and unique and (new or not alone):
            self._said = own | self._said
            return f"{phrase} that {'is' if new else 'was'} {' and '.join(own.values())}"
        if alone:
            return phrase
        if len(others) == 1 and unique:
            return f"other {phrase}"
        raise UsageError(
            f"{name} and {', '.join(others)} are all called {phrase!r}: no sentence says which one is meant",
            hint=f"give looks in --objects, tell them apart by --start '{name} left_of {others[0]}', or say a sentence",
        )

    def _start_of(self, name: str) -> dict[Description, str]:
        """What is said of where an object is at the start, in words."""
        return {one: self._where(one) for one in self._descriptions if one.subject == name}

    def _where(self, one: Description) -> str:
        """Where an object is at the start: "in the top drawer of the cabinet"."""
        if one.reference == TABLE:
            return f"{_OF_THE_TABLE[one.relation]} the table"
        phrase = self._called[one.reference].phrase
        alike = self._called[one.subject].phrase == phrase
        owner = f"other {phrase}" if alike and self._alike[phrase] == 2 else phrase
        place = owner if one.part is None else f"{part_words(one.part)} of the {owner}"
        return f"{_WHERE[one.relation]} the {place}"


def _groups(step: Sequence[AskedGoal]) -> list[list[AskedGoal]]:
    """Goals of a step that one clause asks for."""
    found: dict[object, list[AskedGoal]] = {}
    for one in step:
        goal = one.goal
        alone = goal.subject if goal.relation in (*OF_A_PART, "handed") else None
        found.setdefault((goal.relation, goal.reference, goal.part, one.arm, alone), []).append(one)
    return list(found.values())


def _same(a: AskedGoal, b: AskedGoal) -> bool:
    return (a.goal, a.step, a.arm) == (b.goal, b.step, b.arm)
