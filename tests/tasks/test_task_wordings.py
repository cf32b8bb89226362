"""Sentences that say a whole task."""

from __future__ import annotations

from vcage.tasks.wording import task_wordings

OPEN = ["Open the drawer.", "Please open the drawer.", "Pull the drawer open.", "The drawer should be open."]
PUT = ["Put the red cup into the drawer.", "Place the red cup in the drawer."]


def test_one_step_is_said_in_its_own_wordings():
    assert task_wordings([OPEN], {}) == OPEN


def test_several_are_said_in_their_order_in_one_sentence():
    found = task_wordings([OPEN, PUT], {})
    assert found[:2] == [
        "Open the drawer, then put the red cup into the drawer.",
        "Open the drawer, and put the red cup into the drawer.",
    ]
    assert "Pull the drawer open, then place the red cup in the drawer." in found


def test_wishes_and_statements_are_not_strung_together():
    assert not any("please" in text.lower() or "should" in text for text in task_wordings([OPEN, PUT], {}))


def test_what_has_a_short_name_is_also_called_by_it():
    assert "Open the drawer, then put the cup into the drawer." in task_wordings([OPEN, PUT], {"red cup": "cup"})
