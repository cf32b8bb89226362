"""Words by which a sentence says a goal, a side, a drawer, an order, or where something is taken from."""

from __future__ import annotations

from collections.abc import Mapping

from vcage.base.words import SIDES, WHICH_PART

SAYS: Mapping[str, frozenset[str]] = {
    word: frozenset(said.split())
    for word, said in {
        "inside": "in into inside within",
        "on": "on onto upon top",
        "left_of": "left",
        "right_of": "right",
        "in_front_of": "front before",
        "behind": "behind back rear",
        "beside": "beside next side alongside",
        "near": "near nearby close far",
        "open": "open opened",
        "closed": "close closed shut back",
        "pressed": "press pressed push hit",
        "turned": "turn turned rotate rotated twist swing",
        "weighed": "weigh weighs weighed weight heavy",
        "scanned": "scan scanned scanner code",
        "presented": "customer show present turn front before hand",
        "back": "back return returned stood before",
        "handed": "hand handed pass give transfer arm hands",
    }.items()
}
"""The words that say a goal: one of them must stand in a sentence that asks for it."""

ASKS_MORE = frozenset(
    (*SIDES, "behind", "open", "opened", "close", "closed", "shut", "press", "pressed", "turn", "turned", "rotate",
     "rotated", "twist", "weigh", "weighs", "weighed", "scan", "scanned", "customer", "show", "return", "returned")
)  # fmt: skip
"""Words of goals and sides that may stand only where something that is asked for is said so."""

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
