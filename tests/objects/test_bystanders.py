"""Clutter beside a task."""

from vcage.objects.bystanders import bystanders
from vcage.objects.library import Library

ENTRIES = Library.load().entries()
BY_NAME = {entry.name: entry for entry in ENTRIES}


def names(*texts: str, present: tuple[str, ...] = ()) -> set[str]:
    return {entry.name for entry in bystanders(texts, [BY_NAME[name] for name in present], ENTRIES)}


def test_clutter_excludes_names_with_a_word_of_the_text():
    found = names("Collect three marker pens and a whiteboard eraser, and place them into the packaging box")
    assert found
    assert not found & {"marker", "whiteboard_eraser", "rubber_eraser", "packaging_box", "gift_box", "tea_box"}


def test_clutter_excludes_kinds_named_in_the_text():
    assert not names("Put the fruit on the plate") & {"apple", "banana", "peach"}


def test_where_everything_is_meant_clutter_excludes_portable_objects():
    assert not any(BY_NAME[name].can_be_carried and BY_NAME[name].words.category == "food"
                   for name in names("Put everything on the tray"))  # fmt: skip


def test_clutter_excludes_look_alikes():
    assert "bread_roll" not in names("Put it away", present=("croissant",))


def test_clutter_excludes_objects_of_the_same_category_and_size():
    assert not names("Put them away", present=("block",)) & {"toy_brick", "puzzle_cube"}
    assert "toy_brick" in names("Put them away", present=("plate",))
    assert "toy_car" in names("Put them away", present=("block",))


def test_words_for_places_on_the_table_exclude_nothing():
    assert names("Put it on the left side of the table, in the middle row") == names("Put it in")
