"""Objects that may stand beside a task: none that a word of it could mean."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from vcage.base.words import lemma, lemmas, same_word
from vcage.objects.names import confusable, is_of_kind, names_of
from vcage.schema.asset import CatalogueEntry

ALIKE = 2.0
"""Factor within which sizes of things lie that are taken for each other."""

_OF_THE_TABLE = frozenset(
    ("table", "tabletop", "side", "left", "right", "front", "back", "rear", "top", "bottom", "middle", "centre")
    + ("center", "corner", "edge", "row", "line", "arm", "hand")
)
"""Words that say where on the table something is, or which arm moves it: they name no object."""


def bystanders(
    texts: Collection[str], present: Collection[CatalogueEntry], catalogue: Sequence[CatalogueEntry]
) -> list[CatalogueEntry]:
    """Kinds that answer to no word of some texts, and that nothing there could be taken for, by name or by look.

    Args:
        texts: all that is said of a task.
        present: the kinds of the objects that are there.
        catalogue: to choose from, in this order.
    """
    said = {word for text in texts for word in lemmas(text)} - _OF_THE_TABLE
    return [
        entry
        for entry in catalogue
        if not any(_answers(word, entry) for word in said)
        and not any(confusable(entry, other) or _alike(entry, other) for other in present)
    ]


def _alike(entry: CatalogueEntry, other: CatalogueEntry) -> bool:
    """Whether both are of one category and of about one size, as toy bricks and blocks are."""
    ratios = (a / b for a, b in zip(sorted(entry.size), sorted(other.size), strict=True))
    return entry.words.category == other.words.category and all(1 / ALIKE < ratio < ALIKE for ratio in ratios)


def _answers(word: str, entry: CatalogueEntry) -> bool:
    """Whether a word is one of an entry's names, or of its kind, were it misspelled by a letter."""
    names = names_of(entry)
    known = {other for name in names.all for other in name} | {lemma(entry.words.category.lower())}
    heads = {name[-1] for name in names.all}
    return word in known or is_of_kind(word, entry, names) or any(same_word(word, head) for head in heads)
