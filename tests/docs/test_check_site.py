"""The check of a built site finds what is wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.docs.check_site import complaints


def site(folder: Path, body: str) -> Path:
    (folder / "sub").mkdir()
    (folder / "style.css").write_text("body { background: url(picture.png); }")
    (folder / "sub" / "other.html").write_text('<h2 id="here">Here</h2><a href="../index.html">back</a>')
    head = '<link rel="stylesheet" href="style.css"><link rel="canonical" href="https://example.org/">'
    (folder / "index.html").write_text(f"{head}<p id='top'>{body}</p>")
    return folder


def test_a_site_whose_links_all_lead_somewhere_passes(tmp_path: Path) -> None:
    body = '<a href="#top">a</a><a href="sub/other.html#here">b</a><a href="https://example.org">c</a>'
    assert complaints(site(tmp_path, body)) == []


@pytest.mark.parametrize(
    ("body", "complaint"),
    [
        ('<a href="none.html">a</a>', "none.html leads nowhere"),
        ('<a href="sub/other.html#gone">a</a>', "sub/other.html#gone: there is no such heading"),
        ('<script src="https://cdn.example.org/x.js"></script>', "loads https://cdn.example.org/x.js from elsewhere"),
        ('<img src="//example.org/x.png">', "loads //example.org/x.png from elsewhere"),
        ('<link rel="preconnect" href="https://fonts.example.org">', "loads https://fonts.example.org from elsewhere"),
        ("<style>@import 'https://example.org/x.css'</style>", "loads https://example.org/x.css from elsewhere"),
        ('<img src="none.png">', "none.png leads nowhere"),
        ('<pre class="mermaid"></pre>', "has a diagram that a script from elsewhere draws"),
    ],
)
def test_what_is_wrong_is_named_with_its_page(tmp_path: Path, body: str, complaint: str) -> None:
    assert complaints(site(tmp_path, body)) == [f"index.html: {complaint}"]


def test_a_style_that_loads_a_font_from_elsewhere_is_found(tmp_path: Path) -> None:
    folder = site(tmp_path, "")
    (folder / "style.css").write_text("@font-face { src: url('https://fonts.example.org/x.woff2'); }")
    assert complaints(folder) == ["style.css: loads https://fonts.example.org/x.woff2 from elsewhere"]


def test_a_folder_without_pages_does_not_pass(tmp_path: Path) -> None:
    assert complaints(tmp_path) == [f"{tmp_path}: no pages"]
