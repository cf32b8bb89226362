"""Fields of a plan's file that are wrong: all of them at once, each with what is expected."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from vcage.base.problems import Problem

EXPECTED = {
    "invalid_key": "keys that are text, in quotes where YAML takes them for something else",
    "int": "a whole number",
    "float": "a number",
    "finite": "a finite number",
    "string_type": "text, in quotes where YAML takes it for something else",
    "string_pattern": "small letters, digits, - and _, as in desk-2",
    "string_too_long": "at most {max_length} characters",
    "string_too_short": "text",
    "bool": "true or false",
    "tuple": "a list, as in [one, two]",
    "too_short": "a list with something in it",
    "dict": "keys with values, as in {{fps: 10}}",
    "model": "keys with values, as docs/campaigns.md shows",
    "literal": "{expected}",
    "greater_than_equal": "{ge} or more",
    "greater_than": "more than {gt}",
    "less_than_equal": "at most {le}",
    "less_than": "less than {lt}",
}
"""Beginning of the type of an error → what is expected, with limits of the error; the first that fits counts."""


def problems_of_fields(path: Path, data: Any, error: ValidationError, kind: type[BaseModel]) -> list[Problem]:
    """Name every field of a plan's file that is wrong.

    Args:
        path: of the file.
        data: its content.
        error: found in it.
        kind: the type of the whole.
    """
    found: dict[tuple[str | int, ...], list[str]] = {}
    values: dict[tuple[str | int, ...], Any] = {}
    for one in error.errors():
        place = _place(one["loc"], data, one["type"] == "missing")
        values[place] = one["input"]
        found.setdefault(place, []).append(_expectation(one["type"], one["msg"], one.get("ctx", {})))
    problems = []
    for place, expected in found.items():
        if any(other != place and other[: len(place)] == place for other in found):
            continue  # another form of a field that is wrong further inside
        problems.append(Problem(path, ".".join(map(str, place)), _sentence(place, values[place], expected, kind)))
    return problems


def _place(location: Sequence[str | int], data: Any, missing: bool) -> tuple[str | int, ...]:
    """The place of an error in the file, without the names of types that fields may have."""
    place: list[str | int] = []
    for part in location:
        if isinstance(data, dict) and (part in data or missing):
            data = data.get(part)
        elif isinstance(data, list) and isinstance(part, int):
            data = data[part]
        else:
            continue
        place.append(part)
    return tuple(place)


def _expectation(code: str, message: str, limits: Mapping[str, Any]) -> str:
    if code in ("missing", "extra_forbidden"):
        return code
    known = (text.format(**limits) for beginning, text in EXPECTED.items() if code.startswith(beginning))
    return next(known, message.removeprefix("Value error, expected "))


def _sentence(place: Sequence[str | int], value: Any, expected: Sequence[str], kind: type[BaseModel]) -> str:
    """The error of a field in words."""
    if expected[0] == "missing":
        return "missing"
    if expected[0] == "extra_forbidden":
        known = _keys_at(place, kind)
        near = difflib.get_close_matches(str(place[-1]), known, n=2)
        return f"unknown; did you mean {' or '.join(near)}?" if near else f"unknown; expected one of {', '.join(known)}"
    got = "nothing" if value is None else repr(value)
    return f"got {got[:80]}; expected {', or '.join(dict.fromkeys(expected))}"


def _keys_at(place: Sequence[str | int], kind: type[BaseModel]) -> list[str]:
    """The keys that may stand where an unknown one does."""
    for part in place[:-1]:
        if isinstance(part, str):
            kind = next(_models_in(kind.model_fields[part].annotation))
    return [field.alias or name for name, field in kind.model_fields.items()]


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for inner in getattr(annotation, "__args__", ()):
        yield from _models_in(inner)
