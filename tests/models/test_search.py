from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from tests.models.catalogue import CATALOGUE, entry
from vcage.models import search as module
from vcage.models.search import (
    EmbeddingSearch,
    LexicalSearch,
    best_search,
    shortlist,
)

MEANINGS = {"drink": (1, 0), "mug": (0.9, 0.1), "bowl": (0.5, 0.5), "book": (0, 1)}


class TinyEmbedder:
    """Sums the meanings of the words that it knows; counts the texts that it was given."""

    def __init__(self) -> None:
        self.texts = 0

    def __call__(self, texts: Sequence[str]) -> np.ndarray:
        self.texts += len(texts)
        rows = np.array([[1e-6, 1e-6] + sum(np.array(m) for w, m in MEANINGS.items() if w in text) for text in texts])
        return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def names(found: Sequence) -> list[str]:
    return [kind.name for kind, _ in found]


THREE = [kind for kind in CATALOGUE if kind.name in ("mug", "bowl", "book")]


def test_embeddings_find_objects_no_word_names() -> None:
    assert names(EmbeddingSearch(TinyEmbedder(), "tiny").search("drink", THREE, 2)) == ["mug", "bowl"]


def test_a_text_is_embedded_once() -> None:
    embedder = TinyEmbedder()
    search = EmbeddingSearch(embedder, "tiny")
    search.search("drink", THREE, 3)
    before = embedder.texts
    search.search("drink", THREE, 3)
    assert embedder.texts == before


@pytest.mark.parametrize("search", [LexicalSearch(), EmbeddingSearch(TinyEmbedder(), "tiny")])
def test_an_empty_catalogue_has_no_answer(search: module.Search) -> None:
    assert search.search("drink", [], 3) == []


@pytest.mark.parametrize(
    ("query", "best"),
    [("marker", "marker_pen"), ("cardboard boxes", "packaging_box"), ("fruit", "apple"), ("stapeler", "stapler")],
)
def test_words_find_names_synonyms_kinds_and_slips_of_the_pen(query: str, best: str) -> None:
    assert names(LexicalSearch().search(query, CATALOGUE, 1)) == [best]


def test_a_name_without_latin_words_is_found() -> None:
    cup = entry("rt_cup", "杯子", "imported", synonyms=("杯",))
    assert names(LexicalSearch().search("cup", [*CATALOGUE, cup], 1)) == ["rt_cup"]


def test_rare_words_count_more_than_frequent_ones() -> None:
    assert names(LexicalSearch().search("a box for bread", CATALOGUE, 1)) == ["bread_box"]


def test_lexical_scores_lie_between_0_and_1_and_fall() -> None:
    scores = [score for _, score in LexicalSearch().search("red toy car", CATALOGUE, 99)]
    assert scores == sorted(scores, reverse=True) and 0 <= scores[-1] <= scores[0] <= 1


def test_without_the_package_words_are_compared(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "PACKAGE", "no_such_package")
    assert isinstance(best_search(), LexicalSearch)


def test_a_shortlist_holds_the_best_of_every_query() -> None:
    assert {kind.name for kind in shortlist(["apple", "stapler"], CATALOGUE, LexicalSearch(), 2)} == {
        "apple",
        "stapler",
    }
