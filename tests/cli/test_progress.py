"""What people see while a command works."""

from __future__ import annotations

import logging

import pytest

from vcage.cli.progress import progress, time_left


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
def test_the_time_left_is_told_once_it_is_known_and_long(elapsed, done, total, expected):
    assert time_left(elapsed, done, total) == expected


def test_each_step_is_a_line_where_stderr_is_no_terminal(caplog):
    with caplog.at_level(logging.INFO), progress("collect") as show:
        show("episode 0", 0, 2)
        show("episode 1", 1, 2)
    assert caplog.messages == ["collect: [1/2] episode 0", "collect: [2/2] episode 1"]
