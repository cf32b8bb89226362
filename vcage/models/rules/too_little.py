"""Nouns that say too little in a command: a head that names several things in English, or a direction."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from vcage.base.words import word_set
from vcage.models.rules.nouns import Doubt, Noun
from vcage.models.rules.sentence import Command

NEVER_ALONE = {
    "top": "say on top of which thing",
    "side": "no goal names this side; say of which thing",
    "area": "no goal names this area; say which thing it is",
    "card": "it may be one to play with, to pay with or to give away; give its full name",
    "paper": "it may be a sheet, a roll or a box of it; give its full name",
    "glass": "it may be one to drink from or to look through; give its full name",
}
"""Names that say too little without another word, and why."""

_DIRECTION = re.compile(r"\bto the (far )?(left|right)( side)?$")
_MOTIONS = word_set("turn turn_off show lift shake hold in_hands hold_with_both away face stand_up")
"""Commands after which "to the left" says where a thing is moved, not which one it is."""


def require_plain(commands: Sequence[Command]) -> None:
    """Refuse nouns that only count with another word, and directions in which nothing is moved.

    Raises:
        Doubt: names the noun.
    """
    for noun in (noun for c in commands for noun in _with_relations(*c.things, c.place, c.source)):
        if why := NEVER_ALONE.get(" ".join(noun.words)):
            raise Doubt(noun.text, why)
    for noun in (noun for c in commands if c.verb in _MOTIONS for noun in c.things):
        if _DIRECTION.search(noun.text.lower()):
            raise Doubt(noun.text, "no goal says in which direction it is moved; say which one as in: the left one")


def _with_relations(*nouns: Noun | None) -> Iterator[Noun]:
    """Nouns, and those that they are described by: "the bowl on the side" has two."""
    for noun in nouns:
        if noun is not None:
            yield noun
            yield from _with_relations(*(other for _, other in noun.relations), *noun.but)
