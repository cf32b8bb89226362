"""Names of the catalogue's kinds: what each is called, whether a word or phrase may mean it, and which look alike."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from vcage.base.words import ANYTHING, CATEGORIES, KINDS, kinds_of, lemma, lemmas, same_word
from vcage.schema.asset import CatalogueEntry

LOOK_ALIKE = frozenset(("bread", "pastry", "fruit", "vegetable", "cutlery"))
"""Kinds whose members resemble each other."""

_PLACE_CATEGORIES = frozenset(("container", "furniture", "fixture", "appliance", "mat"))
"""What 'the objects' are never: things that others are put into, or that stay where they are."""


class Names(NamedTuple):
    """Lemmas of what an entry is called, the head of each name last. No name is empty: what has no Latin word gives
    way to the entry's own name, and as a synonym it is dropped."""

    words: list[str]
    plural: list[str]
    own: list[str]
    synonyms: list[list[str]]

    @property
    def all(self) -> list[list[str]]:
        """Every name, synonyms last."""
        return [self.words, self.plural, self.own, *self.synonyms]


def names_of(entry: CatalogueEntry) -> Names:
    """What an entry is called, by its annotation and in the catalogue."""
    words, own = entry.words, lemmas(entry.name) or [entry.name]
    synonyms = [name for name in map(lemmas, words.synonyms) if name]
    return Names(lemmas(words.name) or own, lemmas(words.plural) or own, own, synonyms)


def score_name(phrase: Sequence[str], name: Sequence[str]) -> float:
    """How well a name answers a phrase, in [0, 1]; both are lemmas, the head last.

    1 for equal names; at least 0.6 when the heads agree (``box`` and ``bread box``); 0.45 when the phrase is
    only a qualifier of the name (``marker`` and ``marker pen``); else 0.
    """
    if not phrase or not name:
        return 0.0
    shared = sum(any(same_word(word, other) for other in name) for word in phrase)
    union = len(phrase) + len(name) - shared
    if same_word(phrase[-1], name[-1]):
        return 0.6 + 0.4 * shared / union
    return 0.45 if shared == len(phrase) else 0.0


def is_of_kind(word: str, entry: CatalogueEntry, names: Names) -> bool:
    """Whether a word for a kind of things covers the entry; a word for its very self does not count."""
    category = entry.words.category.lower()
    if word in ANYTHING:
        return entry.can_be_carried and category not in _PLACE_CATEGORIES
    head = names.words[-1]
    if same_word(head, word):
        return word in KINDS
    plain = {name[0] for name in names.synonyms if len(name) == 1}
    return (
        word in plain
        or word == lemma(category)
        or category in CATEGORIES.get(word, ())
        or any(word in kinds_of(other, category) for other in {head, *plain})
    )


def confusable(entry: CatalogueEntry, other: CatalogueEntry) -> bool:
    """Whether the two are called alike or are foods of one kind, which look alike."""
    a, b = names_of(entry).words[-1], names_of(other).words[-1]
    kinds = kinds_of(a, entry.words.category) & kinds_of(b, other.words.category)
    return a == b or bool(kinds & LOOK_ALIKE)
