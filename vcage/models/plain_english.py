"""Tell if an instruction is in English: other checks read English alone."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from vcage.base.words import COLOURS, DETERMINERS, FUNCTION_WORDS, NUMBERS, PARTS, VERBS, lemma, tokens
from vcage.objects.names import texts_of
from vcage.schema.asset import CatalogueEntry

_LETTER = re.compile(r"[^\W\d_]")


@dataclass(frozen=True)
class EnglishSettings:
    """Limits from which a sentence counts as English.

    Args:
        ascii_share: least share of its letters that are ASCII.
        known_share: least share of its words that are known to be English.
    """

    ascii_share: float = 0.9
    known_share: float = 0.5


SETTINGS = EnglishSettings()


def in_english(instruction: str, entries: Iterable[CatalogueEntry]) -> bool:
    """Check if enough letters are ASCII and enough words known; of another language no words are checked."""
    letters = _LETTER.findall(instruction)
    if sum(letter.isascii() for letter in letters) < len(letters) * SETTINGS.ascii_share:
        return False
    named = {word for entry in entries for text in texts_of(entry) for word in tokens(text)}
    known = FUNCTION_WORDS | VERBS | COLOURS | DETERMINERS | NUMBERS.keys() | PARTS | named | {*map(lemma, named)}
    said = tokens(instruction)
    return sum(word in known or lemma(word) in known for word in said) >= len(said) * SETTINGS.known_share
