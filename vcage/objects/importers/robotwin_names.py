"""Unique names for imported objects of RoboTwin, made from the names of their folders."""

from __future__ import annotations

import re
from collections.abc import Container, Sequence
from pathlib import Path

from vcage.base.errors import SchemaMismatch
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
            raise SchemaMismatch(
                f"{source}: field name: {name!r} is the name of {self._taken[name]} already; expected another",
                hint=f"rename the folder {source}, or replace what was imported before: --force",
                details={"path": str(source), "field": "name", "first": str(self._taken[name])},
            )
