"""The page about the commands is what the commands say of themselves."""

from __future__ import annotations

import pytest

from tests.runs import REPOSITORY
from vcage.base import errors
from vcage.cli.main import COMMANDS
from vcage.cli.reference import reference


def test_the_page_is_up_to_date():
    found = (REPOSITORY / "docs" / "cli.md").read_text(encoding="utf-8")
    assert found == reference(), "run: python -m vcage.cli.reference > docs/cli.md"


@pytest.mark.parametrize("columns", ["40", "200"])
def test_it_does_not_depend_on_the_terminal(columns, monkeypatch):
    before = reference()
    monkeypatch.setenv("COLUMNS", columns)
    assert reference() == before


def test_it_has_a_section_for_every_command():
    assert all(f"\n## vcage {name}\n" in reference() for name in COMMANDS)


def test_it_explains_every_exit_code_of_the_error_tree():
    codes = {kind.exit_code for kind in vars(errors).values() if hasattr(kind, "exit_code")}
    assert all(f"\n| {code} | " in reference() for code in codes)
