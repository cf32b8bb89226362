"""The library as a compact text for a prompt."""

from __future__ import annotations

from collections.abc import Iterable

from vcage.schema.asset import CatalogueEntry


def catalogue_text(entries: Iterable[CatalogueEntry]) -> str:
    """One line per kind: name, words, variants, size in centimetres, and what it can do."""
    return "\n".join(_line(entry) for entry in entries)


def size_class(entry: CatalogueEntry) -> str:
    """'tiny', 'small', 'medium' or 'large' by the longest edge: up to 6, 12, 20 cm, and beyond."""
    longest = max(entry.size)
    return next(
        (word for word, limit in (("tiny", 0.06), ("small", 0.12), ("medium", 0.20)) if longest <= limit), "large"
    )


def _line(entry: CatalogueEntry) -> str:
    words = entry.words
    size = " x ".join(f"{100 * edge:.0f}" for edge in entry.size)
    variants = ", ".join(v.id for v in entry.variants)
    holds = sorted({f"holds things {p.holds} it" for p in entry.functional_points})
    can = ", ".join((["can be grasped"] if entry.contact_points else ["cannot be grasped"]) + holds)
    also = f" (also: {', '.join(words.synonyms)})" if words.synonyms else ""
    tags = f" [{', '.join(words.scene_tags)}]" if words.scene_tags else ""
    kind = f"{words.category}, {size_class(entry)}, {size} cm"
    return f"- {entry.name}: {words.name}{also}; {words.description} {kind}; variants {variants}; {can}{tags}"
