"""Judges whether one thing can sensibly be put in or on another, by words and sizes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from vcage.models.rules.words import kinds_of, lemmas
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

MARGIN = 0.004
"""Free space that an object needs on each side of an opening, metres."""


@dataclass(frozen=True)
class _Pair:
    """What is asked: may ``thing`` go ``in`` or ``on`` ``place``? Both are what stands before their descriptions."""

    thing: str
    place: str
    question: PairQuestion

    @classmethod
    def of(cls, question: PairQuestion) -> _Pair:
        thing, place = (words.partition(":")[0].strip() for words in (question.object_words, question.receptacle_words))
        return cls(thing, place, question)

    @property
    def goes_in(self) -> bool:
        return self.question.holds == "in"

    @cached_property
    def thing_lemmas(self) -> list[str]:
        return lemmas(self.thing) or [""]

    @cached_property
    def place_lemmas(self) -> list[str]:
        return lemmas(self.place) or [""]

    @property
    def thing_name(self) -> str:
        return " ".join(self.thing_lemmas)

    @property
    def place_name(self) -> str:
        return " ".join(self.place_lemmas)

    @cached_property
    def is_food(self) -> bool:
        return bool({*kinds_of(self.thing_lemmas[-1]), *self.thing_lemmas} & _FOOD)


def judge_pair(question: PairQuestion) -> PairAnswer:
    """Whether people would do that, and whether it fits; the sentence and the relation when they would."""
    pair = _Pair.of(question)
    objection = next((found for objects in OBJECTIONS if (found := objects(pair))), "")
    word = "into" if pair.goes_in else "onto"
    return PairAnswer(
        object=question.object,
        receptacle=question.receptacle,
        sensible=not objection,
        reason=objection or f"a {pair.place} holds things {word[:2]} it, and the {pair.thing} fits",
        text="" if objection else f"Put the {pair.thing} {word} the {pair.place}.",
        relation="inside" if pair.goes_in else "on",
    )


def _not_a_holder(pair: _Pair) -> str:
    known = IN_WORDS if pair.goes_in else ON_WORDS
    return "" if pair.place_lemmas[-1] in known else f"nobody puts things {pair.question.holds} a {pair.place}"


def _food_elsewhere(pair: _Pair) -> str:
    places = set(pair.place_lemmas)
    if pair.is_food and (places & _NOT_FOOD_PLACES or not places & _FOOD_PLACES):
        return f"food such as a {pair.thing_name} does not belong {pair.question.holds} a {pair.place_name}"
    return ""


def _container_in_container(pair: _Pair) -> str:
    if pair.goes_in and pair.thing_lemmas[-1] in IN_WORDS and pair.place_lemmas[-1] not in _TAKE_CONTAINERS:
        return f"a {pair.thing_name} is a container itself and does not go into a {pair.place_name}"
    return ""


def _in_a_drink(pair: _Pair) -> str:
    if pair.place_lemmas[-1] in _DRINKING and not kinds_of(pair.thing_lemmas[-1]) & {"stationery", "cutlery"}:
        return f"a {pair.thing_name} does not go into a {pair.place_name}"
    return ""


def _not_bread(pair: _Pair) -> str:
    if "bread" in pair.place_lemmas and not pair.is_food:
        return f"a {pair.place_name} is for bread, not for a {pair.thing_name}"
    return ""


def _stacked_on_another_kind(pair: _Pair) -> str:
    if not pair.goes_in and pair.place_lemmas[-1] in STACKING - {pair.thing_lemmas[-1]}:
        return f"a {pair.thing_name} is not stacked on a {pair.place_name}"
    return ""


def _too_large(pair: _Pair) -> str:
    """Whether the object, turned by a quarter if need be, fits the opening."""
    across = sorted(pair.question.object_size[:2])
    free = sorted(pair.question.opening_size[:2])
    margin = 2 * MARGIN if pair.goes_in else 0.0
    if across[0] + margin > free[0] or across[1] + margin > free[1]:
        return (
            f"the {pair.thing} ({across[1] * 100:.1f} x {across[0] * 100:.1f} cm) is larger than the space "
            f"of the {pair.place} ({free[1] * 100:.1f} x {free[0] * 100:.1f} cm)"
        )
    return ""


OBJECTIONS: tuple[Callable[[_Pair], str], ...] = (
    _not_a_holder,
    _food_elsewhere,
    _container_in_container,
    _in_a_drink,
    _not_bread,
    _stacked_on_another_kind,
    _too_large,
)
"""What common sense may say against a pair, asked in this order; "" where it says nothing."""
