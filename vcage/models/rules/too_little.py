"""Nouns that say too little in a command: a head that names several things in English, or a direction."""

from __future__ import annotations

import re
from collections.abc import Sequence

from vcage.models.rules.nouns import Doubt
from vcage.models.rules.sentence import Command

NEVER_ALONE = {
    "top": "say on top of which thing",
    "side": "no goal names this side; say of which thing",
    "area": "no goal names this area; say which thing it is",
    "glass": "it may be one to drink from or to look through; give its full name",
}
"""Names that say too little without another word, and why."""

_DIRECTION = re.compile(r"\bto the (far )?(left|right)( side)?$")
_MOTIONS = {"turn", "turn_off", "press", "show", "lift", "shake", "hold", "in_hands", "hold_with_both", "away", "face"}
"""Commands after which "to the left" says where a thing is moved, not which one it is."""


def require_plain(commands: Sequence[Command]) -> None:
    """Refuse nouns that only count with another word, and directions in which nothing is moved.

    Raises:
        Doubt: names the noun.
    """
    for noun in (noun for c in commands for noun in (*c.things, c.place, c.source) if noun is not None):
        if why := NEVER_ALONE.get(" ".join(noun.words)):
            raise Doubt(noun.text, why)
    for noun in (noun for c in commands if c.verb in _MOTIONS for noun in c.things):
        if _DIRECTION.search(noun.text.lower()):
            raise Doubt(noun.text, "no goal says in which direction it is moved; say which one as in: the left one")
