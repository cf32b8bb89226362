"""Texts of RoboTwin about an object and its points, in fields with correct or wrong spelling."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

TEXTS = ("description", "discription")
"""How the fields with texts end; both spellings are in use."""


def description(data: dict[str, Any]) -> str:
    """The sentence about an object in a file's fields, well or badly spelt; empty when there is none."""
    for key in TEXTS:
        value = data.get(key)
        value = value[0] if isinstance(value, list) and value else value
        if isinstance(value, str) and value.strip():
            return value.strip()
    return ""


def point_texts(kind: str, data: dict[str, Any], info: dict[str, Any]) -> dict[int, str]:
    """Return the text of each point of a kind by index; the variant's own texts take precedence.

    Args:
        kind: 'contact' or 'functional'.
        data: fields of the variant.
        info: fields of ``points_info.json``.
    """
    texts = dict(_of_all_variants(kind, info))
    for key, value in data.items():
        if key.startswith(kind) and any(text in key for text in TEXTS) and isinstance(value, list):
            texts.update({i: x.strip() for i, x in enumerate(value) if isinstance(x, str) and x.strip()})
    return texts


def _of_all_variants(kind: str, info: dict[str, Any]) -> Iterator[tuple[int, str]]:
    """Index and text of what ``points_info.json`` says about points of a kind."""
    lists = [value for key, value in info.items() if key.startswith(kind) and isinstance(value, list)]
    for i, entry in ((i, entry) for listed in lists for i, entry in enumerate(listed)):
        said = {"description": entry} if isinstance(entry, str) else entry if isinstance(entry, dict) else {}
        text, ids = said.get("description"), said.get("id", i)
        for index in ids if isinstance(ids, list) else [ids]:
            if isinstance(index, int) and isinstance(text, str):
                yield index, text.strip()
