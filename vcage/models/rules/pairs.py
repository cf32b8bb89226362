"""Judges whether one thing can sensibly be put in or on another, by words and sizes."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

from vcage.base.words import kinds_of, lemmas
from vcage.schema.subtasks import PairAnswer, PairQuestion

IN_WORDS = frozenset(
    ["box", "bowl", "basket", "bin", "crate", "tray", "drawer", "cup", "mug", "jar", "pot", "pan", "bucket",
     "holder", "case", "container", "rack", "carton", "toolbox", "cabinet", "carrier", "planter", "vase", "dish",
     "organizer", "microwave", "oven"]
)  # fmt: skip
"""Heads of names of things that people put other things into."""

ON_WORDS = frozenset(
    ["plate", "tray", "board", "mat", "coaster", "saucer", "rack", "shelf", "stand", "platter", "book", "notebook",
     "dish", "napkin", "scale", "block", "cabinet", "drawer", "microwave", "oven"]
)  # fmt: skip
"""Heads of names of things that people put other things on."""

STACKING = frozenset(["block", "cube", "brick", "book", "notebook"])
"""Things that only their own like is put on."""

_TAKE_CONTAINERS = frozenset(["box", "crate", "basket", "bin", "drawer"])
"""Containers that others go into."""

_DRINKING = frozenset(["cup", "mug", "glass"])
_FOOD_PLACES = frozenset(
    ["plate", "bowl", "bread", "basket", "tray", "board", "dish", "platter", "lunch", "saucer", "pan", "pot", "rack",
     "napkin", "mat", "scale", "carton", "microwave", "oven"]
)  # fmt: skip
_NOT_FOOD_PLACES = frozenset(
    ["book", "notebook", "stapler", "keyboard", "pencil", "pen", "tool", "packaging", "holder", "coaster", "block"]
)
_FOOD = frozenset(["bread", "pastry", "fruit", "vegetable", "food"])

OPENING_MARGIN_M = 0.004
"""Free space that an object needs on each side of an opening, metres."""


@dataclass(frozen=True)
class _Named:
    """An object by its words.

    Args:
        phrase: its name in the scene: 'red marker pens'.
        name: the lemmas of the phrase: 'red marker pen'.
        head: the last of them: 'pen'.
    """

    phrase: str
    name: str
    head: str

    @classmethod
    def of(cls, words: str) -> _Named:
        """From its phrase and, after a colon, its description."""
        phrase = words.partition(":")[0].strip()
        found = lemmas(phrase) or [""]
        return cls(phrase, " ".join(found), found[-1])

    @property
    def words(self) -> set[str]:
        return set(self.name.split())

    @property
    def is_food(self) -> bool:
        return bool((kinds_of(self.head) | self.words) & _FOOD)


def judge_object_and_place(question: PairQuestion) -> PairAnswer:
    """Judge a pair: would people do that, and does it fit?"""
    thing, place = _Named.of(question.object_words), _Named.of(question.receptacle_words)
    objections = itertools.chain(_by_use(thing, place, question), _by_kind_and_size(thing, place, question))
    objection = next(objections, "")
    return PairAnswer(
        object=question.object,
        receptacle=question.receptacle,
        sensible=not objection,
        reason=objection or f"a {place.phrase} holds things {question.holds} it, and the {thing.phrase} fits",
    )


def _by_use(thing: _Named, place: _Named, question: PairQuestion) -> Iterator[str]:
    """Objections to a place that nobody puts such a thing into or on."""
    if place.head not in (IN_WORDS if question.holds == "in" else ON_WORDS):
        yield f"nobody puts things {question.holds} a {place.phrase}"
    if thing.is_food and (place.words & _NOT_FOOD_PLACES or not place.words & _FOOD_PLACES):
        yield f"food such as a {thing.name} does not belong {question.holds} a {place.name}"
    if question.holds == "in" and thing.head in IN_WORDS and not place.words & _TAKE_CONTAINERS:
        yield f"a {thing.name} is a container itself and does not go into a {place.name}"
    if place.head in _DRINKING and not kinds_of(thing.head) & {"stationery", "cutlery"}:
        yield f"a {thing.name} does not go into a {place.name}"


def _by_kind_and_size(thing: _Named, place: _Named, question: PairQuestion) -> Iterator[str]:
    """Objections to a place for another kind of things, or without room, even after a quarter turn."""
    if "bread" in place.words and not thing.is_food:
        yield f"a {place.name} is for bread, not for a {thing.name}"
    if question.holds == "on" and place.head in STACKING and place.head != thing.head:
        yield f"a {thing.name} is not stacked on a {place.name}"
    across, free = sorted(question.object_size[:2]), sorted(question.opening_size[:2])
    margin = 2 * OPENING_MARGIN_M if question.holds == "in" else 0.0
    if across[0] + margin > free[0] or across[1] + margin > free[1]:
        yield (
            f"the {thing.phrase} ({across[1] * 100:.1f} x {across[0] * 100:.1f} cm) is larger than the space "
            f"of the {place.phrase} ({free[1] * 100:.1f} x {free[0] * 100:.1f} cm)"
        )
