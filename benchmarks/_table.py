"""The figures of a benchmark as plain text: what is printed as JSON, in aligned columns for people."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

GAP = "  "
"""Between two columns."""


def lines(figures: Mapping[str, Any]) -> Iterator[str]:
    """The figures of a benchmark: its ``rows`` as a table, then everything else as one line each.

    Args:
        figures: what ``run`` returned; without ``rows`` it is one row itself. Lists of records, and records by name,
            are tables too; what else is in it becomes lines of their own.
    """
    rows = figures.get("rows", [figures])
    yield from table(rows)
    others = {} if "rows" not in figures else {name: value for name, value in figures.items() if name != "rows"}
    tables = {name: records for name, value in others.items() if (records := _records(name, value))}
    for name, records in tables.items():
        yield from ("", f"{name}:", *table(records))
    rest = dict(_flat({name: value for name, value in others.items() if name not in tables}))
    width = max(map(len, rest), default=0)
    yield from (f"{name:<{width}}{GAP}{cell(value)}" for name, value in rest.items())


def table(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Rows as lines, after a heading whose words stand above each other; columns in the order of their first row."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    headings = [name.split("_") for name in names]
    height = max(map(len, headings), default=0)
    columns = [
        [*[""] * (height - len(words)), *words, *(cell(row.get(name)) for row in rows)]
        for name, words in zip(names, headings, strict=True)
    ]
    widths = [max(map(len, column)) for column in columns]
    is_text = [any(isinstance(row.get(name), str) for row in rows) for name in names]
    for entries in zip(*columns, strict=True):
        aligned = (e.ljust(w) if t else e.rjust(w) for e, w, t in zip(entries, widths, is_text, strict=True))
        yield GAP.join(aligned).rstrip()


def cell(value: object) -> str:
    """A value as people read it; ``-`` for what there is none of."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _records(name: str, value: object) -> list[Mapping[str, Any]]:
    """The rows of a list of records, or of records by name; none of anything else."""
    if isinstance(value, Mapping) and value and all(isinstance(row, Mapping) for row in value.values()):
        return [{name.removeprefix("by_"): key, **row} for key, row in value.items()]
    if isinstance(value, list) and all(isinstance(row, Mapping) for row in value):
        return value
    return []


def _flat(record: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in record.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", value
