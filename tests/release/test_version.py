"""The version is the same wherever it is written."""

from __future__ import annotations

import re

from tests.run_folders import REPOSITORY
from vcage.base.version import __version__


def test_the_changelog_begins_with_the_version() -> None:
    text = (REPOSITORY / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.findall(r"^## (\S+)$", text, re.MULTILINE)[0] == __version__


def test_every_wheel_that_a_page_names_is_of_the_version() -> None:
    pages = [*REPOSITORY.glob("*.md"), *REPOSITORY.glob("docs/*.md")]
    named = {one for page in pages for one in re.findall(r"vcage-(\d[\d.]*)-py3", page.read_text(encoding="utf-8"))}
    assert named == {__version__}
