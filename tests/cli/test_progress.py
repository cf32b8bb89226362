"""What people see while a command works."""

from __future__ import annotations

import json
import logging

import pytest

from vcage.cli.progress import progress, set_up, time_left
from vcage.cli.streams import stray_output_on_stderr


@pytest.mark.parametrize(
    ("elapsed", "done", "total", "expected"),
    [
        (60, 0, 4, ""),
        (5, 1, 100, ""),
        (60, 3, 4, "about 20 s"),
        (600, 1, 4, "about 30 min"),
        (3600, 1, 4, "about 3.0 h"),
        (60, 4, 4, ""),
    ],
)
def test_the_remaining_time_is_reported_once_it_is_known_and_long(elapsed, done, total, expected):
    assert time_left(elapsed, done, total) == expected


def test_work_of_an_earlier_call_does_not_count_for_the_remaining_time(caplog, monkeypatch):
    moments = iter([0, 0, 100, 200, 200, 260])
    monkeypatch.setattr("time.monotonic", lambda: float(next(moments)))
    with caplog.at_level(logging.INFO), progress("compress") as show:
        show("a", 90, 100)
        show("b", 91, 100)
        show("again", 50, 100)
        show("c", 51, 100)
    assert [message.partition("(")[2] for message in caplog.messages] == [
        "",
        "about 15 min left)",
        "",
        "about 49 min left)",
    ]


def test_each_step_is_a_line_where_stderr_is_no_terminal(caplog):
    with caplog.at_level(logging.INFO), progress("collect") as show:
        show("episode 0", 0, 2)
        show("episode 1", 1, 2)
    assert caplog.messages == ["collect: [1/2] episode 0", "collect: [2/2] episode 1"]


def test_steps_are_json_lines_on_stdout_on_request(capsys):
    set_up(False, "json")
    with stray_output_on_stderr(), progress("collect") as show:
        print("stray")
        show("2 episodes run", 2, 5)
    set_up(False, "text")
    out, err = capsys.readouterr()
    assert [json.loads(line) for line in out.splitlines()] == [
        {"stage": "collect", "step": "2 episodes run", "done": 2, "total": 5}
    ]
    assert err == "stray\n"
