"""Clutter beside a task."""

from vcage.objects.bystanders import bystanders
from vcage.objects.library import Library

ENTRIES = Library.load().entries()
BY_NAME = {entry.name: entry for entry in ENTRIES}


def names(*texts: str, present: tuple[str, ...] = ()) -> set[str]:
    return {entry.name for entry in bystanders(texts, [BY_NAME[name] for name in present], ENTRIES)}


def test_nothing_that_is_called_by_a_word_of_the_text_stands_by():
    found = names("Collect three marker pens and a whiteboard eraser, and place them into the packaging box")
    assert found
    assert not found & {"marker", "whiteboard_eraser", "rubber_eraser", "packaging_box", "gift_box", "tea_box"}


def test_nothing_of_a_kind_that_the_text_names_stands_by():
    assert not names("Put the fruit on the plate") & {"apple", "banana", "peach"}


def test_where_everything_is_meant_nothing_that_can_be_carried_stands_by():
    assert not any(BY_NAME[name].can_be_carried and BY_NAME[name].words.category == "food"
                   for name in names("Put everything on the tray"))  # fmt: skip


def test_what_looks_like_what_is_there_does_not_stand_by():
    assert "bread_roll" not in names("Put it away", present=("croissant",))


def test_what_is_of_a_category_and_about_as_large_as_what_is_there_does_not_stand_by():
    assert not names("Put them away", present=("block",)) & {"toy_brick", "puzzle_cube"}
    assert "toy_brick" in names("Put them away", present=("plate",))
    assert "toy_car" in names("Put them away", present=("block",))


def test_words_for_places_on_the_table_exclude_nothing():
    assert names("Put it on the left side of the table, in the middle row") == names("Put it in")
