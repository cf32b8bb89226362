"""The tasks of others: a sentence, and the goals that their own check demands."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from vcage.scenes.stated_goals import StatedTask
from vcage.schema.asset import CatalogueEntry

SUITES = ("libero", "robotwin")

_NAME = re.compile(r"(?P<kind>[a-z_]+?)(?:/(?P<look>[a-z_]+?))?(?:_(?P<number>\d+))?")


@dataclass(frozen=True)
class Named:
    """The kinds that a name of a task may stand for.

    Args:
        kinds: of the library, the usual one first.
        look: words of its look; empty where nothing says it.
        number: among those alike.
    """

    kinds: tuple[str, ...]
    look: str = ""
    number: int = 1

    def fits(self, entry: CatalogueEntry) -> bool:
        """Check if an object, with no other look than its own, is of one of the kinds, and looks so."""
        (variant,) = entry.variants
        shown = {*variant.id.split("_"), *variant.colour.replace("-", " ").split()}
        return entry.name in self.kinds and {*self.look.split("_")} - {"", "and"} <= shown


@dataclass(frozen=True)
class Task:
    """One task of a suite.

    Args:
        suite: libero or robotwin.
        text: its sentence.
        goals: what must be true, in the grammar of ``--goal``, with names of its own; empty where no goal can state it.
        start: which of several is meant, in that of ``--start``.
        lacks: what no goal can state.
        names: of the goals → kinds of the library.
    """

    suite: str
    text: str
    goals: tuple[str, ...]
    start: tuple[str, ...]
    lacks: str
    names: Mapping[str, tuple[str, ...]]

    @property
    def id(self) -> str:
        """As in ``libero/open_the_microwave``; of LIBERO the name of the BDDL file without its scene."""
        return f"{self.suite}/{re.sub('[^a-z0-9]+', '_', self.text.lower())}"

    @functools.cached_property
    def parsed(self) -> StatedTask | None:
        """The goals and the start, with the names of the task; None where no goal can state it.

        Raises:
            UnknownName: a word of a goal is none of ours.
        """
        return StatedTask.of(self.goals, self.start, None)

    def named(self, name: str) -> Named:
        """The kinds of a name in the goals, without its part."""
        found = _NAME.fullmatch(name)
        assert found is not None, name
        kind, look, number = found["kind"], found["look"] or "", int(found["number"] or 1)
        return Named(self.names.get(kind, (kind,)), look, number)

    def options(self, catalogue: Iterable[CatalogueEntry]) -> dict[str, Any]:
        """Options of ``vcage run`` that state it without its sentence: names become ids of objects, parts are kept."""
        entries = {entry.name: entry for entry in catalogue}
        return {"goals": tuple(self._told(text, entries) for text in self.goals)} | {
            "starts": tuple(self._told(text, entries) for text in self.start)
        }

    def _told(self, text: str, entries: Mapping[str, CatalogueEntry]) -> str:
        return " ".join(self._id(word, entries) if _is_name(place, text) else word for place, word in _places(text))

    def _id(self, path: str, entries: Mapping[str, CatalogueEntry]) -> str:
        """The id of the first known kind, in the look that is said or in its first; what is unknown as it is."""
        name, part = split(path)
        named = self.named(name)
        kind = next((entries[kind] for kind in named.kinds if kind in entries), None)
        if kind is None:
            return "/".join(filter(None, [named.kinds[0], named.look, part]))
        looks = [v for v in kind.variants if named.fits(kind.model_copy(update={"variants": [v]}))]
        look = looks[0].id if looks else named.look
        stem = kind.name if len(kind.variants) == 1 and looks else f"{kind.name}_{look}"
        return f"{stem}{f'_{named.number}' * (named.number > 1)}{f'/{part}' if part else ''}"


def split(path: str) -> tuple[str, str | None]:
    """A name of the goals, and the part at its end: every part has its kind of part as its first word."""
    name, _, last = path.rpartition("/")
    is_part = last.split("_")[0] in ("drawer", "door", "knob", "button", "lever", "screen", "compartment")
    return (name, last) if is_part else (path, None)


def _places(text: str) -> list[tuple[int, str]]:
    words = text.split()
    return list(enumerate(words, -1 if words[0] == "then" else 0))


def _is_name(place: int, text: str) -> bool:
    last = text.split()[-1]
    return place == 0 or (place == 2 and last not in ("table", "left", "right"))


def tasks(suite: str) -> list[Task]:
    """All tasks of a suite."""
    told = _told(suite)
    several = {name: tuple(kinds) for name, kinds in told["names"].items()}
    fields = {text: found for part in ("whole", "others", "tasks") for text, found in told.get(part, {}).items()}
    return [_task(suite, text, found, several) for text, found in fields.items()]


def whole() -> list[Task]:
    """Those of LIBERO that need nothing but what the library had first."""
    told = _told("libero")
    return [task for task in tasks("libero") if task.text in told["whole"]]


@functools.lru_cache
def _told(suite: str) -> dict[str, Any]:
    return yaml.safe_load(Path(__file__).with_name(f"{suite}.yml").read_text(encoding="utf-8"))


def _task(suite: str, text: str, fields: Any, names: Mapping[str, tuple[str, ...]]) -> Task:
    found: dict[str, Any] = {"goals": fields} if isinstance(fields, list) else fields
    goals, start = tuple(found.get("goals", ())), tuple(found.get("start", ()))
    return Task(suite, text, goals, start, found.get("lacks", ""), names)
