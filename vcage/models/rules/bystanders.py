"""What may stand beside a task: nothing that a word of it could mean, and nothing that changes how it is read."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from vcage.base.errors import UnreadInstruction
from vcage.base.words import lemma, lemmas, same_word
from vcage.models.rules.goals import read_goals
from vcage.objects.names import confusable, is_of_kind, names_of
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import Goal

Things = Mapping[str, CatalogueEntry]
"""The catalogue's entries by object id, each with the object's own look only."""

Asked = tuple[frozenset[tuple[int, Goal]], frozenset[str]]
"""Goals with their steps, and what is left alone."""

ALIKE = 2.0
"""Factor within which sizes of things lie that are taken for each other."""


def bystanders(
    texts: Collection[str], present: Collection[CatalogueEntry], catalogue: Sequence[CatalogueEntry]
) -> list[CatalogueEntry]:
    """Kinds that answer to no word of some texts, and that nothing there could be taken for, by name or by look.

    Args:
        texts: all that is said of a task.
        present: the kinds of the objects that are there.
        catalogue: to choose from, in this order.
    """
    said = {word for text in texts for word in lemmas(text)}
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


def asked_by(text: str, things: Things, lying: Mapping[str, str]) -> Asked | None:
    """What a text asks for among things, whatever its words; None where the rules do not understand it.

    Args:
        text: a command.
        things: what there is.
        lying: object id → id of what it lies in or on.
    """
    try:
        reading = read_goals(text, things, lying)
    except UnreadInstruction:
        return None
    return frozenset((asked.step, asked.goal) for asked in reading.goals), frozenset(reading.untouched)
