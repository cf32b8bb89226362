"""Hooks of mkdocs: pages of the site that lie outside ``docs/``, and the links between all pages.

Every page keeps the links that are right in the repository; here they become those of the site. A link to what is
no page stays as it is, and ``mkdocs build --strict`` refuses it.
"""

from __future__ import annotations

import ast
import posixpath
import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = "examples"
PLACES = {
    "README.md": "index.md",
    "SKILL.md": "SKILL.md",
    "CHANGELOG.md": "changelog.md",
    "LICENSE": "LICENSE.txt",
    "NOTICE": "NOTICE.txt",
    EXAMPLES: "examples.md",
}
PLACES |= {
    path.relative_to(ROOT).as_posix(): path.relative_to(ROOT).as_posix()
    for path in sorted(ROOT.glob("skills/*/**/*.md"))
}
"""Path in the repository → path in the site; files of ``docs/`` lie at its top."""

_FENCED = re.compile(r"^(```|~~~).*?^\1\s*$", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"\[(?P<text>[^\[\]]*)\]\((?P<target>[^()\s]+)\)")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that lie elsewhere."""
    for source, place in PLACES.items():
        if source == EXAMPLES:
            files.append(File.generated(config, place, content=examples()))
        else:
            files.append(File.generated(config, place, abs_src_path=str(ROOT / source)))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Turn the links of a page, outside its code, into those of the site."""
    source = {place: source for source, place in PLACES.items()}.get(page.file.src_uri, f"docs/{page.file.src_uri}")
    code = [match.span() for match in _FENCED.finditer(markdown)]

    def mended(link: re.Match[str]) -> str:
        inside_code = any(start <= link.start() < end for start, end in code)
        return link.group() if inside_code else _mended(link, source, page.file.src_uri)

    return _LINK.sub(mended, markdown)


def _mended(link: re.Match[str], source: str, place: str) -> str:
    """A link of the page that lies at ``source`` in the repository and at ``place`` in the site."""
    target, _, anchor = link["target"].partition("#")
    if not target or re.match(r"[a-z]+:", target):
        return link.group()
    named = posixpath.normpath(posixpath.join(posixpath.dirname(source), target))
    found = PLACES.get(named) or (named.removeprefix("docs/") if named.startswith("docs/") else "")
    if not found:
        return link.group()
    text = title(ROOT / named) if link["text"] == target and named.endswith(".md") else link["text"]
    path = posixpath.relpath(found, posixpath.dirname(place) or ".")
    return f"[{text}]({path}{'#' if anchor else ''}{anchor})"


def title(page: Path) -> str:
    """The first heading of a page."""
    return re.search(r"^# (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)[1]


def examples() -> str:
    """A page of the programs in ``examples/``, each under the beginning of its docstring."""
    parts = ["# Examples\n\nThe programs of the folder `examples/`. Each runs as it stands, from the checkout.\n"]
    for path in sorted((ROOT / EXAMPLES).glob("*.py")):
        text = path.read_text(encoding="utf-8")
        heading = re.split(r"[:.]", ast.get_docstring(ast.parse(text)), maxsplit=1)[0]
        parts.append(f'## {heading}\n\n```python title="examples/{path.name}"\n{text}```\n')
    return "\n".join(parts)
