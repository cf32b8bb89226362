"""Check a built site: ``python -m tests.docs.check_site FOLDER``.

Every link within the site leads to a file, and to an anchor that the file has. Nothing is loaded from elsewhere when a
page is shown: no script, style, font or picture.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADING = {"script": "src", "img": "src", "iframe": "src", "source": "src", "video": "src", "object": "data"}
"""Attributes by which an element loads something."""

_IN_CSS = re.compile(r"(?:url\(|@import\s+)\s*[\"']?((?:https?:)?//[^\"')\s]+)")


class Page(HTMLParser):
    """The links, loaded files and anchors of a page."""

    def __init__(self, text: str):
        super().__init__()
        self.links: list[str] = []
        self.loads: list[str] = _IN_CSS.findall(text)
        self.anchors: set[str] = set()
        self.diagrams = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take in an element."""
        found = {name: value or "" for name, value in attrs}
        self.anchors |= {found[name] for name in ("id", "name") if found.get(name)}
        # The theme loads its drawing program for these from elsewhere.
        self.diagrams = self.diagrams or "mermaid" in found.get("class", "").split()
        if tag == "a" and "href" in found:
            self.links.append(found["href"])
        if tag == "link" and found.get("rel") not in ("canonical", "next", "prev"):
            self.loads.append(found.get("href", ""))
        if tag in LOADING and found.get(LOADING[tag]):
            self.loads.append(found[LOADING[tag]])


def complaints(site: Path) -> list[str]:
    """The faults of the pages and styles of a site, each with the file's name."""
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(site.rglob("*.html"))}
    found = [
        f"{path.relative_to(site)}: {what}" for path, page in pages.items() for what in _of_page(path, page, pages)
    ]
    for path in sorted(site.rglob("*.css")):
        loads = _IN_CSS.findall(path.read_text(encoding="utf-8"))
        found += [f"{path.relative_to(site)}: loads {address} from elsewhere" for address in loads]
    return found if pages else [f"{site}: no pages"]


def _of_page(path: Path, page: Page, pages: dict[Path, Page]) -> Iterator[str]:
    if page.diagrams:
        yield "has a diagram that a script from elsewhere draws"
    for address in page.loads:
        if _elsewhere(address):
            yield f"loads {address} from elsewhere"
    for address in [*page.links, *page.loads]:
        parts = urlsplit(address)
        if parts.scheme or parts.netloc or path.name == "404.html":  # its links are of the server's top
            continue
        target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
        target = target / "index.html" if target.is_dir() else target
        if not target.is_file():
            yield f"{address} leads nowhere"
        elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
            yield f"{address}: there is no such heading"


def _elsewhere(address: str) -> bool:
    parts = urlsplit(address)
    return bool(parts.netloc) or parts.scheme not in ("", "data")


def main() -> int:
    """Print the complaints; the exit code is 1 where there are any."""
    site = Path(sys.argv[1]).resolve()
    found = complaints(site)
    print("\n".join(found) or f"{site}/index.html: {len(list(site.rglob('*.html')))} pages, all links lead somewhere")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
