"""Links of the pages: each leads to a file of the repository, and to a heading that the file has."""

from __future__ import annotations

import itertools
import re
from pathlib import Path

import pytest
import yaml

from tests.run_folders import REPOSITORY

TOP = ("README.md", "SKILL.md", "CHANGELOG.md")
PAGES = [*(REPOSITORY / name for name in TOP), *sorted(REPOSITORY.glob("docs/*.md"))]
PAGES += sorted(REPOSITORY.glob("skills/*/**/*.md"))
CODE = re.compile(r"^(```|~~~).*?^\1\s*$|(?<!`)`[^`\n]+`(?!`)", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\((?P<target>[^()\s]+)\)")


def links(text: str) -> list[str]:
    """The targets of a page's links and pictures, outside its code."""
    return LINK.findall(CODE.sub("", text))


def anchors(page: Path) -> set[str]:
    """The anchors of a page's headings."""
    text = re.sub(r"^(```|~~~).*?^\1\s*$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    headings = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"\s+", "-", re.sub(r"[^\w\s-]", "", heading).strip().lower()) for heading in headings}


def broken(page: Path, text: str) -> list[str]:
    """Links of a page that lead nowhere, or out of the repository."""
    found = []
    for link in links(text):
        target, _, anchor = link.partition("#")
        if re.match(r"https?:", link):
            continue
        file = (page.parent / target).resolve() if target else page
        known = file.exists() and file.is_relative_to(REPOSITORY)
        if not known or (anchor and anchor not in anchors(file)):
            found.append(link)
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(REPOSITORY).as_posix())
def test_every_link_of_a_page_leads_somewhere(page: Path) -> None:
    assert broken(page, page.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(
    "link", ["missing.md", "cli.md#no-such-command", "#no-such-heading", "/etc", "pictures/no.jpg"]
)
def test_a_link_that_leads_nowhere_is_found(link: str) -> None:
    assert broken(REPOSITORY / "docs" / "runs.md", f"See [it](cli.md#vcage-run) and ![that]({link}).") == [link]


def test_links_in_code_are_none() -> None:
    assert links("`[a](b)` [c](d)\n```\n[e](f)\n```\n") == ["d"]


def test_a_list_begins_after_an_empty_line_as_the_site_needs_it() -> None:
    found = []
    for page in PAGES:
        lines = CODE.sub("", page.read_text(encoding="utf-8")).splitlines()
        for before, line in itertools.pairwise(lines):
            begins = re.match(r"([-*]|\d+\.) ", line)
            if begins and before.strip() and not re.match(r"([-*]|\d+\.) |\s|#", before):
                found.append(f"{page.name}: {line[:60]}")
    assert found == []


# --- the site ----------------------------------------------------------------------------------------------


def pages_of(entry: object) -> list[str]:
    """The pages of a part of the navigation."""
    if isinstance(entry, str):
        return [entry]
    parts = entry.values() if isinstance(entry, dict) else entry
    assert not isinstance(parts, str)
    return [page for part in parts for page in pages_of(part)]


def test_the_site_leads_to_every_page_once() -> None:
    settings = yaml.safe_load((REPOSITORY / "mkdocs.yml").read_text(encoding="utf-8"))
    ours = {"README.md": "index.md", "CHANGELOG.md": "changelog.md"}
    expected = [page.relative_to(REPOSITORY).as_posix().removeprefix("docs/") for page in PAGES]
    assert sorted(pages_of(settings["nav"])) == sorted([*(ours.get(name, name) for name in expected), "examples.md"])
