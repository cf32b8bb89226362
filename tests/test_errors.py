"""Errors name the thing and the way out."""

from __future__ import annotations

from vcage.errors import InfeasibleScene, UnknownName


def test_unknown_name_suggests_the_nearest():
    error = UnknownName("asset", "markr", ["marker", "mug"])
    assert "marker, mug" in error.message
    assert error.hint == "did you mean marker?"


def test_a_line_holds_message_and_hint_in_one_line():
    line = InfeasibleScene("no room\nfor plate", hint="drop one").as_line()
    assert line == "no room for plate (drop one)"


def test_a_record_holds_what_a_program_needs():
    record = InfeasibleScene("no room", details={"missing_m2": 0.02}).as_record()
    assert record == {
        "code": "infeasible_scene",
        "message": "no room",
        "hint": "",
        "retryable": False,
        "details": {"missing_m2": 0.02},
    }
