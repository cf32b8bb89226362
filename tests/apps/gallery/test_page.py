from __future__ import annotations

from vcage.apps.gallery.page import write_gallery
from vcage.objects.library import Library


def test_the_page_shows_every_variant_that_is_asked_for(tmp_path) -> None:
    library = Library.load()
    page = write_gallery(library, tmp_path, ["block"])
    text = page.read_text()
    variants = [v.id for v in library.annotation("block").variants]
    assert all(f"pictures/block-{v}.png" in text and (tmp_path / f"pictures/block-{v}.png").is_file() for v in variants)
