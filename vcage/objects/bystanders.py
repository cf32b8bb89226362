"""Clutter for a task: objects that none of its words could mean."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from vcage.base.words import lemma, lemmas, same_word, word_set
from vcage.objects.names import confusable, is_of_kind, names_of
from vcage.schema.asset import CatalogueEntry

_OF_THE_TABLE = word_set(
    "table tabletop side left right front back rear top bottom middle centre center corner edge row line arm hand"
)
"""Words for places on the table and for arms: they name no object."""


def bystanders(
    texts: Collection[str], present: Collection[CatalogueEntry], catalogue: Sequence[CatalogueEntry]
) -> list[CatalogueEntry]:
    """Exclude from the catalogue the kinds that a text may mean, and look-alikes of the objects present.

    Args:
        texts: everything said about the task.
        present: kinds of the objects in the scene.
        catalogue: kinds to choose from, in this order.
    """
    said = {word for text in texts for word in lemmas(text)} - _OF_THE_TABLE
    return [
        entry
        for entry in catalogue
        if not any(_answers(word, entry) for word in said)
        and not any(confusable(entry, other) or _alike(entry, other) for other in present)
    ]


def _alike(entry: CatalogueEntry, other: CatalogueEntry, size_factor: float = 2.0) -> bool:
    """True if both have one category and sizes within a factor of each other, as toy bricks and blocks."""
    if entry.words.category != other.words.category:
        return False
    ratios = (a / b for a, b in zip(sorted(entry.size), sorted(other.size), strict=True))
    return all(1 / size_factor < ratio < size_factor for ratio in ratios)


def _answers(word: str, entry: CatalogueEntry) -> bool:
    """True if a word is one of an entry's names or its kind, allowing one wrong letter."""
    names = names_of(entry)
    known = {other for name in names.all for other in name} | {lemma(entry.words.category.lower())}
    heads = {name[-1] for name in names.all}
    return word in known or is_of_kind(word, entry) or any(same_word(word, head) for head in heads)
