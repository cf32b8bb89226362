"""Words of RoboTwin: names of objects, made unique, and texts about them and their points, in either spelling."""

from __future__ import annotations

import re
from collections.abc import Container, Iterator, Sequence
from pathlib import Path
from typing import Any

from vcage.base.errors import mismatch
from vcage.base.files import resource
from vcage.objects.importers import Imported

PREFIX = "rt_"
"""Begins the name of every object from RoboTwin: many of its kinds we have too."""

LONGEST_STEM, LONGEST = 70, 80
"""Characters of an object's name before, and with, the variant that is added to it."""

NUMBERED = re.compile(r"([0-9]+)[_-](.*)")
"""A folder's number and name."""


def identifier(folder: Path) -> str:
    """Our name for the object of a folder: ``003_plate`` becomes ``rt_plate``, ``005_杯子`` becomes ``rt_005``."""
    number, name = _split(folder)
    plain = re.sub(r"[^a-z0-9_-]", "_", name.lower()) if _is_latin(name) else number or "object"
    return (PREFIX + plain)[:LONGEST_STEM]


def called(folder: Path) -> str:
    """Name the object of a folder for sentences; one without a Latin letter in its name is 'object 005'."""
    number, name = _split(folder)
    text = name if _is_latin(name) else f"object {number}"
    return " ".join(re.split(r"[_\-\s]+", text)).strip().lower()


def plural(name: str) -> str:
    """The regular English plural."""
    if re.search(r"(s|x|z|ch|sh)$", name):
        return f"{name}es"
    return f"{name[:-1]}ies" if re.search(r"[^aeiou]y$", name) else f"{name}s"


def unique(name: str, taken: Container[str]) -> str:
    """The name, at most :data:`LONGEST` characters of it, with a number where it is taken."""
    found, number = name[:LONGEST], 2
    while found in taken:
        suffix = f"_{number}"
        found, number = name[: LONGEST - len(suffix)] + suffix, number + 1
    return found


def _split(folder: Path) -> tuple[str, str]:
    """Number and name of a folder; the number is empty where there is none."""
    match = NUMBERED.fullmatch(folder.resolve().name)
    return (match.group(1), match.group(2)) if match else ("", folder.resolve().name)


def _is_latin(name: str) -> bool:
    """True if a name has a letter or digit that an identifier may have."""
    return re.search(r"[a-z0-9]", name.lower()) is not None


class TakenNames:
    """Names in use, and the objects that use them.

    Args:
        into: where imported objects lie.
        done: what this import has made so far.
        force: whether objects from earlier imports may be replaced.
    """

    def __init__(self, into: Path, done: Sequence[Imported], force: bool):
        earlier = {path.parent.name: path.parent for path in into.glob("*/asset.json")}
        own = {path.parent.name: path.parent for path in resource("assets", "objects").glob("*/asset.json")}
        new = {entry.name: entry.folder for entry in done if entry.error is None}
        self._taken = {**({} if force else earlier), **own, **new}

    def claim(self, name: str, source: Path) -> None:
        """Refuse a name that is taken.

        Raises:
            SchemaMismatch: names both.
        """
        if name in self._taken:
            text = f"{name!r} is the name of {self._taken[name]} already; expected another"
            hint = f"rename the folder {source}, or replace what was imported before: --force"
            raise mismatch(source, "name", text, hint, first=str(self._taken[name]))


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
    """Index and text of the descriptions of points of a kind in ``points_info.json``."""
    lists = [value for key, value in info.items() if key.startswith(kind) and isinstance(value, list)]
    for i, entry in ((i, entry) for listed in lists for i, entry in enumerate(listed)):
        said = {"description": entry} if isinstance(entry, str) else entry if isinstance(entry, dict) else {}
        text, ids = said.get("description"), said.get("id", i)
        for index in ids if isinstance(ids, list) else [ids]:
            if isinstance(index, int) and isinstance(text, str):
                yield index, text.strip()
