"""Words by which a sentence says a goal, a side, a drawer, an order, or where something is taken from."""

from __future__ import annotations

from collections.abc import Mapping

from vcage.base.words import SIDES, WHICH_PART
from vcage.goals import KINDS
from vcage.schema.goals import Goal


def says(goal: Goal) -> frozenset[str]:
    """The words that say a goal: one of them must stand in a sentence that asks for it."""
    return frozenset(goal.kind.says.split())


def claimed() -> frozenset[str]:
    """Words of goals and sides that may stand only where something that is asked for is said so."""
    return frozenset(SIDES).union(*(kind.claims.split() for kind in KINDS.values()))


IN_ORDER = frozenset(("then", "afterwards", "afterward", "finally", "followed"))
FIRST = frozenset(("first", "last", "lastly"))
NOT = frozenset(("not", "don't", "never", "without", "except", "avoid", "leave", "no", "nothing", "but"))
VERB_TO_PART_WORDS = 6
"""Words from the verb that opens or presses a part to the word that says which."""

FROM = frozenset(("from", "out", "off"))
"""Words before what something is taken from."""

WITHIN = frozenset(("of", "the", "a", "inside", "within", *WHICH_PART))
"""Words that may stand between such a word and the name, with those of a drawer."""

LIES: Mapping[str, frozenset[str]] = {"inside": frozenset(("in", "inside", "within")), "on": frozenset(("on",))}
"""Words by which a name says where its object lies."""


def levels(text: str) -> frozenset[str]:
    """The levels that words name: top, middle, bottom."""
    return frozenset(WHICH_PART[word] for word in text.split() if word in WHICH_PART)
