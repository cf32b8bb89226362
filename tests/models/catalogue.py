"""A small catalogue for tests."""

from __future__ import annotations

from collections.abc import Sequence

from vcage.schema.asset import CatalogueEntry, ContactPoint, FunctionalPoint, Variant, Words
from vcage.schema.plan import Selection

KITCHEN = ("kitchen", "dining_table")


def entry(
    name: str,
    words: str,
    category: str,
    colours: Sequence[str] = ("white",),
    tags: Sequence[str] = ("office_desk",),
    size: tuple[float, float, float] = (0.05, 0.05, 0.05),
    synonyms: Sequence[str] = (),
    holds: str | None = None,
) -> CatalogueEntry:
    points = [FunctionalPoint(id=0, name="floor", holds=holds, position=(0, 0, 0.005))] if holds else []
    contact = ContactPoint(id=0, name="middle", position=(0, 0, 0.02), approach=(0, 0, -1), closing=(1, 0, 0))
    return CatalogueEntry(
        name=name,
        words=Words(
            name=words, plural=f"{words}s", synonyms=list(synonyms), description=f"A {words}.", category=category,
            scene_tags=list(tags),
        ),
        variants=[Variant(id=colour, colour=colour) for colour in colours],
        size=size,
        contact_points=[contact],
        functional_points=points,
    )  # fmt: skip


CATALOGUE = [
    entry("marker_pen", "marker pen", "stationery", ("black", "red", "blue", "green"), synonyms=("marker",)),
    entry("whiteboard_eraser", "whiteboard eraser", "stationery", ("blue",)),
    entry("packaging_box", "packaging box", "container", ("brown",), synonyms=("cardboard box",), holds="in"),
    entry("bread_box", "bread box", "container", ("wood",), KITCHEN, holds="in"),
    entry("block", "block", "toy", ("red", "blue", "green", "yellow"), ("playroom",)),
    entry("plate", "plate", "tableware", ("white",), (*KITCHEN, "playroom"), holds="on"),
    entry("baguette_piece", "piece of baguette", "food", ("golden",), KITCHEN, synonyms=("bread",)),
    entry("croissant", "croissant", "food", ("golden",), KITCHEN),
    entry("bagel", "bagel", "food", ("brown",), KITCHEN),
    entry("apple", "apple", "food", ("red", "green"), KITCHEN),
    entry("mug", "mug", "tableware", ("white", "red"), (*KITCHEN, "office_desk"), holds="in"),
    entry("stapler", "stapler", "stationery", ("black",)),
    entry("book", "book", "stationery", ("red", "green"), size=(0.2, 0.14, 0.03), holds="on"),
    entry("bowl", "bowl", "tableware", ("white",), KITCHEN, holds="in"),
    entry("toy_car", "toy car", "toy", ("red",), ("playroom",)),
]


def unchecked(_: Selection) -> list[str]:
    """A check without complaints."""
    return []
