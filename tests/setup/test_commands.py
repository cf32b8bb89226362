"""Running the tools that fetch."""

from __future__ import annotations

import sys

import pytest

from vcage.base.errors import FetchFailed
from vcage.setup.commands import reason, run


def test_a_command_returns_its_output() -> None:
    assert run([sys.executable, "-c", "print('yes')"]) == "yes\n"


def test_a_failure_names_the_tool_and_its_complaint() -> None:
    code = "import sys; sys.exit('W: first\\nE: no such package')"
    with pytest.raises(FetchFailed, match="mirror: no such package") as caught:
        run([sys.executable, "-c", code], tool="mirror")
    assert caught.value.retryable and caught.value.exit_code == 6


def test_an_earlier_complaint_is_the_reason_where_it_says_more() -> None:
    code = "import sys; sys.exit('E: Unable to locate package x')"
    with pytest.raises(FetchFailed, match="W: Failed to fetch the list"):
        run([sys.executable, "-c", code], context="W: Failed to fetch the list")


@pytest.mark.parametrize(
    ("complaint", "line"), [("a\nE: b\nc", "b"), ("ERROR: no match\nhint", "no match"), ("", "no reason given")]
)
def test_the_telling_line_of_a_complaint_is_taken(complaint: str, line: str) -> None:
    assert reason(complaint) == line
