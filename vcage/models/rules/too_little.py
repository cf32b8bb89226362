"""Nouns that say too little in a command: a head that names several things in English, or a direction."""

from __future__ import annotations

import itertools
import re
from collections.abc import Collection, Iterator, Sequence

from vcage.base.words import CATEGORIES, lemma, word_set
from vcage.models.rules.commands import Command, nouns_of
from vcage.models.rules.nouns import Doubt, Noun

NEVER_ALONE = {
    "top": "say on top of which thing",
    "side": "no goal names this side; say of which thing",
    "area": "no goal names this area; say which thing it is",
    "card": "it may be one to play with, to pay with or to give away; give its full name",
    "paper": "it may be a sheet, a roll or a box of it; give its full name",
    "glass": "it may be one to drink from or to look through; give its full name",
    "dish": "it may be a bowl, or one for soap, for butter or for the oven; give its full name",
    "lamp": "it may be a desk lamp or a torch; give its full name",
    "gun": "it may be a bar code scanner or another tool; give its full name",
    "ring": "it may be something to eat or to wear; give its full name",
    "tree": "it may be a rack for mugs or a plant; give its full name",
    "machine": "it says too little; give its full name",
}
"""Names that say too little without another word, and why; "the dishes" is a kind of things."""

_DIRECTION = re.compile(r"\bto the (far )?(left|right)( side)?$")
_MOTIONS = word_set("turn turn_off show lift shake hold in_hands hold_with_both away face stand_up")
"""Commands after which "to the left" says where a thing is moved, not which one it is."""
_PEGS = word_set("peg hook")
"""Last words of a place that name a peg, not a rack."""


def require_plain(commands: Sequence[Command]) -> None:
    """Refuse nouns that are too vague alone, and requests that no goal states.

    Raises:
        Doubt: names the noun.
    """
    nouns = nouns_of(commands)
    whole = {noun.words[-1] for noun in nouns if len(noun.words) > 1}
    vague = ((noun, why) for noun in nouns if (why := _vague(noun, whole)))
    for noun, why in (*vague, *(found for command in commands for found in _beyond_goals(command))):
        raise Doubt(noun.text, why)


def _vague(noun: Noun, whole: Collection[str]) -> str | None:
    """Why a noun says too little; ``whole`` are the last words of nouns with more words in the sentence."""
    why = NEVER_ALONE.get(" ".join(noun.words))
    if why and noun.words[-1] not in whole and not (noun.several and noun.words[-1] in CATEGORIES):
        return why
    if noun.but and noun.count not in (None, 1):
        return "its number may count what is excepted, or not; leave out one of them"
    return None


def _beyond_goals(command: Command) -> Iterator[tuple[Noun, str]]:
    """Nouns of a command by which it asks for what no goal says, and why."""
    for noun, after in itertools.pairwise(command.things):
        if _shares_number(noun, after):
            one, other, name = noun.colour, after.colour, after.text.split()[-1]
            each = f"two {one} and two {other} {name}, or: all the {one} and all the {other} {name}"
            yield noun, f"its number may be of one colour, or of all; say it of each, as in: {each}"
    for noun in command.things:
        if command.verb == "wipe" and noun.of_table:
            yield noun, "the table itself stays as it is; wipe a flat thing on it, as in: wipe the mat with the sponge"
        if command.verb in _MOTIONS and _DIRECTION.search(noun.text.lower()):
            yield noun, "no goal says in which direction it is moved; say which one as in: the left one"
    place = command.place
    if command.verb == "pour":
        yield from _beyond_pouring(command)
    if command.verb == "hang" and place is not None and not _PEGS.isdisjoint(place.words[-1:]):
        yield place, "no goal says on which peg it hangs; say on what, as in: hang the mug on the mug rack"


def _shares_number(noun: Noun, after: Noun) -> bool:
    """True for "three red" before "and blue blocks": three may be red, or red and blue together."""
    counts = noun.count not in (None, 1) and not (after.count or after.quantifier)
    elided = lemma(noun.text.lower().split()[-1]) not in noun.words
    return counts and elided and after.words == noun.words and None not in (noun.colour, after.colour)


def _beyond_pouring(command: Command) -> Iterator[tuple[Noun, str]]:
    """Nouns of a pouring of something else than all that lies in a vessel, and why that is not done."""
    for noun in command.things:
        if _is_everything_in_nothing(noun):
            yield noun, "only balls are poured, all that lie in a vessel; name it, as in: everything in the cup"
    for named in (*command.things, command.place, command.source):
        if named is not None and named.but:
            yield named.but[0], "all that lies in a vessel is poured; leave the exception out"


def _is_everything_in_nothing(noun: Noun) -> bool:
    """True for "everything" that is said to be in no vessel."""
    told = {how for how, _ in noun.relations}
    return noun.words == ("thing",) and noun.quantifier == "all" and "in" not in told
