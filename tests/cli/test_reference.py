"""The page about the commands is what the commands say of themselves."""

from __future__ import annotations

import pytest

from tests.run_folders import REPOSITORY
from vcage.base import errors
from vcage.cli.main import COMMANDS
from vcage.cli.reference import reference


@pytest.fixture(scope="module")
def page() -> str:
    """Made once: every command renders its help for it."""
    with pytest.MonkeyPatch.context() as narrow:
        narrow.setenv("COLUMNS", "40")
        return reference()


def test_the_page_is_up_to_date(page):
    found = (REPOSITORY / "docs" / "cli.md").read_text(encoding="utf-8")
    assert found == page, "run: python -m vcage.cli.reference > docs/cli.md"


def test_it_does_not_depend_on_the_terminal(page, monkeypatch):
    monkeypatch.setenv("COLUMNS", "200")
    assert reference() == page


def test_it_has_a_section_for_every_command(page):
    assert all(f"\n## vcage {name}\n" in page for name in COMMANDS)


def test_it_explains_every_exit_code_of_the_error_tree(page):
    codes = {kind.exit_code for kind in vars(errors).values() if hasattr(kind, "exit_code")}
    assert all(f"\n| {code} | " in page for code in codes)
