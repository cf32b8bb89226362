"""The words that hold a command together, from ``lexicon.yml``; every other word belongs to the name of a thing."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Literal, get_args

import yaml

Verb = Literal[
    "put", "fill", "empty", "take", "open", "close", "press", "turn", "scan", "weigh", "hand", "stack", "gather"
]  # fmt: skip
"""What a verb asks for."""

Kind = Literal[
    "word", "noise", "wish", "and", "then", "first", "before", "after", "stop", "query", "colon", "prep", "article",
    "quantity", "number", "pronoun", "not", "except", "instead", "which", "be", "belong", "ought", "back", "there",
    "toward", "ask", "remark", "also", "stay", "again",
]  # fmt: skip
"""What a token does in a sentence; ``word`` for all that names, and for verbs, which only their place tells."""

_TABLES = yaml.safe_load(Path(__file__).with_suffix(".yml").read_text(encoding="utf-8"))

BASES: dict[str, Verb] = {word: verb for verb, words in _TABLES["verbs"].items() for word in words.split()}
"""Base form of a verb → what it asks for."""

IS = frozenset(_TABLES["is"].split())
"""Words before which a noun's 's is short for 'is'."""

SLIPS: dict[str, str] = dict(tuple(pair.split(" = ")) for pair in _TABLES["slips"].split("; "))
"""Slips of the pen → what was meant."""


def _forms() -> dict[str, str]:
    """Every participle and gerund → the verb's base form: 'placing' → 'place', 'dropped' → 'drop'."""
    found = dict(tuple(pair.split("=")) for pair in _TABLES["irregular"]["forms"].split())
    doubled = _TABLES["irregular"]["doubled"].split()
    for base in BASES:
        stem = base + base[-1] if base in doubled else base.removesuffix("e")
        found |= {f"{stem}ing": base, f"{stem}ed": base, f"{base}ing": base}
        if base.endswith("y"):
            found[f"{base[:-1]}ied"] = base
    return found


FORMS = _forms()


def _rows(pattern: str) -> Iterator[tuple[str, ...]]:
    """The rows of words that a pattern such as '{can|could} you {|please}' stands for."""
    for parts in itertools.product(*(part.split("|") for part in re.split(r"[{}]", pattern))):
        yield tuple("".join(parts).split())


PHRASES: dict[tuple[str, ...], tuple[Kind, str]] = {
    row: (kind, value)
    for kind in get_args(Kind)
    for value, patterns in _TABLES["phrases"].get(kind, {}).items()
    for pattern in patterns.split(" | ")
    for row in _rows(pattern)
}
"""Words in a row → what they do together, and which of the things that do so."""

OTHERS = frozenset(_TABLES["others"].split())
"""Words that mean something in the place where they stand."""

LONGEST = max(map(len, PHRASES))
