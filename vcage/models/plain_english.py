"""Tell if an instruction is in English, and if it says plainly what it asks for: other checks need both."""

from __future__ import annotations

import re
from collections.abc import Iterable

from vcage.base.word_classes import FUNCTION_WORDS, VERBS
from vcage.base.words import COLOURS, DETERMINERS, NUMBERS, PARTS, lemma, tokens
from vcage.objects.names import texts_of
from vcage.schema.asset import CatalogueEntry

_LATIN = re.compile(r"[^\W\d_]")


def in_english(instruction: str, entries: Iterable[CatalogueEntry]) -> bool:
    """Check if at least half of the words are known to be English; of another language no words are checked."""
    letters = _LATIN.findall(instruction)
    if sum(letter.isascii() for letter in letters) < len(letters) * 0.9:
        return False
    named = {word for entry in entries for text in texts_of(entry) for word in tokens(text)}
    known = FUNCTION_WORDS | VERBS | COLOURS | DETERMINERS | NUMBERS.keys() | PARTS | named | {*map(lemma, named)}
    said = tokens(instruction)
    return 2 * sum(word in known or lemma(word) in known for word in said) >= len(said)
