"""Names of entries, and what they answer, also where the words are of another script."""

from __future__ import annotations

from tests.models.catalogue import CATALOGUE, entry
from vcage.models.rules.catalogue_match import candidates, places
from vcage.models.rules.phrases import Phrase
from vcage.objects.names import confusable, names_of, score_name

CUP = entry("rt_cup", "杯子", "imported", synonyms=("杯", "beaker"), holds="in")


def test_names_without_a_latin_word_give_way_to_the_name_of_the_entry() -> None:
    plain = CUP.model_copy(update={"words": CUP.words.model_copy(update={"plural": "杯子"})})
    assert names_of(plain).all == [["rt", "cup"], ["rt", "cup"], ["rt", "cup"], ["beaker"]]


def test_an_entry_that_is_all_articles_still_has_a_name() -> None:
    assert names_of(entry("the", "杯子", "imported"))[0] == ["the"]


def test_an_entry_without_a_latin_word_answers_by_its_name() -> None:
    cup = Phrase(text="cup", lemmas=("cup",), colour=None, count=1)
    assert candidates(cup, [CUP, *CATALOGUE])[0].entry.name == "rt_cup"
    assert places(cup, [CUP], moved=[cup])[0].entry.name == "rt_cup"
    assert confusable(CUP, CUP)


def test_a_shared_head_counts_more_than_a_shared_qualifier() -> None:
    assert score_name(["box"], ["bread", "box"]) > score_name(["bread"], ["bread", "box"])
