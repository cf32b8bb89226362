"""Judges whether one thing can sensibly be put in or on another, by words and sizes."""

from __future__ import annotations

from collections.abc import Sequence

from vcage.models.rules.words import kinds_of, lemmas
from vcage.schema.subtasks import PairAnswer, PairQuestion

IN_WORDS = frozenset(
    [
        "box",
        "bowl",
        "basket",
        "bin",
        "crate",
        "tray",
        "drawer",
        "cup",
        "mug",
        "jar",
        "pot",
        "pan",
        "bucket",
        "holder",
        "case",
        "container",
        "rack",
        "carton",
        "toolbox",
        "cabinet",
        "carrier",
        "planter",
        "vase",
        "dish",
        "organizer",
        "microwave",
        "oven",
    ]
)
"""Heads of names of things that people put other things into."""

ON_WORDS = frozenset(
    [
        "plate",
        "tray",
        "board",
        "mat",
        "coaster",
        "saucer",
        "rack",
        "shelf",
        "stand",
        "platter",
        "book",
        "notebook",
        "dish",
        "napkin",
        "scale",
        "block",
        "cabinet",
        "drawer",
        "microwave",
        "oven",
    ]
)
"""Heads of names of things that people put other things on."""

STACKING = frozenset(["block", "cube", "brick", "book", "plate", "bowl", "notebook"])
"""Things that are put on their own like and on little else of this list."""

_DRINKING = frozenset(["cup", "mug", "glass"])
_FOOD_PLACES = frozenset(
    [
        "plate",
        "bowl",
        "bread",
        "basket",
        "tray",
        "board",
        "dish",
        "platter",
        "lunch",
        "saucer",
        "pan",
        "pot",
        "rack",
        "napkin",
        "mat",
        "scale",
        "carton",
        "microwave",
        "oven",
    ]
)
_NOT_FOOD_PLACES = frozenset(
    ["book", "notebook", "stapler", "keyboard", "pencil", "pen", "tool", "packaging", "holder", "coaster", "block"]
)
_FOOD = ("bread", "pastry", "fruit", "vegetable", "food")

MARGIN = 0.004
"""Free space that an object needs on each side of an opening, metres."""


def split_words(words: str) -> tuple[str, str]:
    """The phrase and the description of an object: what stands before and after the first colon."""
    phrase, _, description = words.partition(":")
    return phrase.strip(), description.strip()


def judge_pair(question: PairQuestion) -> PairAnswer:
    """Whether people would do that, and whether it fits; the sentence and the relation when they would."""
    thing, _ = split_words(question.object_words)
    place, _ = split_words(question.receptacle_words)
    objection = (
        _about_receptacle(place, question)
        or _about_pair(lemmas(thing), lemmas(place), question.holds)
        or _about_size(thing, place, question)
    )
    relation = "inside" if question.holds == "in" else "on"
    if objection:
        return PairAnswer(
            object=question.object, receptacle=question.receptacle, sensible=False, reason=objection, relation=relation
        )
    word = "into" if question.holds == "in" else "onto"
    return PairAnswer(
        object=question.object,
        receptacle=question.receptacle,
        sensible=True,
        reason=f"a {place} holds things {word[:2]} it, and the {thing} fits",
        text=f"Put the {thing} {word} the {place}.",
        relation=relation,
    )


def _about_receptacle(place: str, question: PairQuestion) -> str:
    names = lemmas(place)
    known = IN_WORDS if question.holds == "in" else ON_WORDS
    if names and names[-1] in known:
        return ""
    return f"nobody puts things {question.holds} a {place}"


def _about_pair(thing: Sequence[str], place: Sequence[str], holds: str) -> str:
    """What common sense says about the pair."""
    thing_head, place_head = thing[-1] if thing else "", place[-1] if place else ""
    thing_name, place_name = " ".join(thing), " ".join(place)
    food = bool(kinds_of(thing_head) & set(_FOOD)) or any(word in _FOOD for word in thing)
    if food and (set(place) & _NOT_FOOD_PLACES or not set(place) & _FOOD_PLACES):
        return f"food such as a {thing_name} does not belong {holds} a {place_name}"
    if thing_head in IN_WORDS and holds == "in" and place_head not in ("box", "crate", "basket", "bin", "drawer"):
        return f"a {thing_name} is a container itself and does not go into a {place_name}"
    if place_head in _DRINKING and not kinds_of(thing_head) & {"stationery", "cutlery"}:
        return f"a {thing_name} does not go into a {place_name}"
    if "bread" in place and not food:
        return f"a {place_name} is for bread, not for a {thing_name}"
    if holds == "on" and place_head in STACKING and place_head not in ("plate", "bowl") and thing_head != place_head:
        return f"a {thing_name} is not stacked on a {place_name}"
    return ""


def _about_size(thing: str, place: str, question: PairQuestion) -> str:
    """Whether the object, turned by a quarter if need be, fits the opening."""
    across = sorted(question.object_size[:2])
    free = sorted(question.opening_size[:2])
    margin = 2 * MARGIN if question.holds == "in" else 0.0
    if across[0] + margin > free[0] or across[1] + margin > free[1]:
        return (
            f"the {thing} ({across[1] * 100:.1f} x {across[0] * 100:.1f} cm) is larger than the space "
            f"of the {place} ({free[1] * 100:.1f} x {free[0] * 100:.1f} cm)"
        )
    return ""
