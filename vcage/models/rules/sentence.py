"""From a sentence to commands: every way in which the grammar can read it."""

from __future__ import annotations

import functools
import math
import re
from typing import Any

from lark import Token, Tree, UnexpectedInput
from lark.visitors import CollapseAmbiguities

from vcage.models.rules.commands import Command, commands_of
from vcage.models.rules.grammar import LIMITS, grammar, not_read
from vcage.models.rules.plain_text import plain_text, word_at

_CLAUSE_ENDS = re.compile(r"[,.;]|\b(and|then)\b")
_TWO_ARMS = re.compile(
    r"\b(simultaneously|at the same time"
    r"|(both|two|separate|each|another)( (of|the|your|available|free|separate))* (arm|hand|gripper)s?)\b"
)
_ONE_BY_ONE = "two arms at once cannot be promised; say which arm does what, left or right, or leave the arms out"
"""Why two arms are not read where they do anything but hold something up."""


@functools.lru_cache(maxsize=100)
def parse(instruction: str) -> tuple[tuple[Command, ...], ...]:
    """Every way in which a sentence can be read; pronouns and "one" are still to be resolved.

    Kept, since objects are chosen for a sentence before its goals are read with them.

    Raises:
        UnreadInstruction: there is none; names the first word that does not fit and the nearest form that does.
    """
    typed = " ".join(instruction.split())
    text = plain_text(typed)
    try:
        tree = grammar().parse(text)
    except UnexpectedInput as error:
        if found := _TWO_ARMS.search(text):
            raise not_read(typed, found[0], _ONE_BY_ONE) from None
        at = len(text) if error.pos_in_stream in (None, -1) else int(error.pos_in_stream)
        raise not_read(typed, _misfit(typed, text, at), "it does not fit any form of sentence that is read") from None
    if _readings(tree) > LIMITS.readings:
        raise not_read(typed, typed, f"there are more than {LIMITS.readings} ways to read it")
    ways = map(_located, CollapseAmbiguities().transform(tree))
    return tuple(dict.fromkeys(commands_of(one, typed) for one in ways))


def _misfit(typed: str, text: str, at: int) -> str:
    """The first word that does not fit: where parsing ends, or the first word of the clause, if that is no verb."""
    begins = max((found.end() for found in _CLAUSE_ENDS.finditer(text, 0, at)), default=0)
    clause = text[begins:].lstrip()
    known = any(re.match(t.pattern.to_regexp(), clause) for t in grammar().terminals if t.name not in ("WORD", "_AND"))
    return word_at(typed, at if known else begins)


def _located(tree: Tree[Any]) -> Tree[Any]:
    """A tree with the place of every part in the sentence: lark leaves out that of a part with several readings."""
    for part in tree.iter_subtrees():
        places = [child if isinstance(child, Token) else child.meta for child in part.children]
        places += [] if part.meta.empty else [part.meta]
        part.meta.start_pos = min(place.start_pos or 0 for place in places)
        part.meta.end_pos = max(place.end_pos or 0 for place in places)
        part.meta.empty = False
    return tree


def _readings(tree: Tree[Any]) -> int:
    counts = [_readings(child) for child in tree.children if isinstance(child, Tree)]
    return sum(counts) if tree.data == "_ambig" else math.prod(counts)
