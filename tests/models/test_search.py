from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from tests.models.catalogue import CATALOGUE, KITCHEN, entry
from vcage.models import search as module
from vcage.models.search import (
    MOST_CATALOGUE_TEXT,
    MOST_KINDS,
    EmbeddingSearch,
    LexicalSearch,
    best_search,
    narrow,
    shortlist,
)
from vcage.objects.catalogue import catalogue_text

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


def test_embeddings_find_what_no_word_names() -> None:
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


def test_what_has_no_latin_word_is_found_by_its_name() -> None:
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


def test_a_small_catalogue_is_shown_whole() -> None:
    assert narrow("Put the apple into the bowl", CATALOGUE, LexicalSearch) == CATALOGUE


def test_a_large_catalogue_is_narrowed_to_what_the_instruction_needs() -> None:
    filler = [entry(f"gadget_{i}", f"gadget {i}", "toy", tags=KITCHEN) for i in range(MOST_KINDS)]
    shown = [kind.name for kind in narrow("Put the croissant into the bread box", [*filler, *CATALOGUE], LexicalSearch)]
    assert len(shown) <= MOST_KINDS and {"croissant", "bread_box"} <= set(shown)


def test_a_long_catalogue_is_narrowed_to_the_characters_of_a_prompt() -> None:
    wordy = [entry(f"thing_{i}", "thing " + "very " * 200 + str(i), "toy") for i in range(60)]
    shown = narrow("Put the croissant into the bread box", [*wordy, *CATALOGUE], LexicalSearch)
    assert len(catalogue_text(shown)) <= MOST_CATALOGUE_TEXT
    assert {"croissant", "bread_box"} <= {kind.name for kind in shown}
