"""Errors name the thing and the way out."""

from __future__ import annotations

import pickle

import pytest

from vcage.base import errors
from vcage.base.errors import InfeasibleScene, UnknownName, UsageError, VcageError


def test_unknown_name_suggests_the_nearest():
    error = UnknownName("asset", "markr", ["marker", "mug"])
    assert "marker, mug" in error.message
    assert error.hint == "did you mean marker?"


def test_a_line_holds_message_and_hint_in_one_line():
    line = InfeasibleScene("no room\nfor plate", hint="drop one").as_line()
    assert line == "no room for plate (drop one)"


def test_a_record_holds_the_fields_for_programs():
    record = InfeasibleScene("no room", details={"missing_m2": 0.02}).as_record()
    assert record == {
        "code": "infeasible_scene",
        "message": "no room",
        "hint": "",
        "retryable": False,
        "details": {"missing_m2": 0.02},
    }


KINDS = [
    kind
    for kind in vars(errors).values()
    if isinstance(kind, type) and issubclass(kind, VcageError) and kind is not UnknownName
]
"""The errors of the tree; those with a constructor of their own apart."""


@pytest.mark.parametrize("kind", KINDS)
def test_an_error_comes_whole_from_another_process(kind):
    error = pickle.loads(pickle.dumps(kind("a.hdf5 is damaged", hint="fix it", details={"frame": 3})))
    assert type(error) is kind
    assert (error.message, error.hint, error.details) == ("a.hdf5 is damaged", "fix it", {"frame": 3})
    assert str(error) == "a.hdf5 is damaged"


def test_an_error_with_arguments_of_its_own_comes_whole_from_another_process():
    error = UnknownName("asset", "markr", ["marker", "mug"])
    again = pickle.loads(pickle.dumps(error))
    assert again.as_record() == error.as_record() and again.as_line() == error.as_line()


@pytest.mark.parametrize("unseen", ["\u200b", "\u202e", "\ufeff", "\xad"])
def test_invisible_characters_are_shown_as_escapes(unseen: str) -> None:
    error = UsageError(f"cu{unseen}p fits nothing", hint=f"near cu{unseen}p", command=f"vcage run cu{unseen}p")
    escape = repr(unseen)[1:-1]
    assert error.as_line() == f"cu{escape}p fits nothing; near cu{escape}p: vcage run cu{unseen}p"
    assert error.as_record()["message"] == f"cu{escape}p fits nothing"
    assert error.as_record()["hint"].startswith(f"near cu{escape}p: ")
