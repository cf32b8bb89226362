"""What was changed by hand in a stage's folder: known by what the stage wrote, which :data:`SEAL` keeps beside it.

Pictures and JSON are for people and agents to edit. Each stage says in its ``take_over`` what must be true of
an edited file, and makes again what follows from it (:mod:`vcage.runs.running` calls it).
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterator, Mapping
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from vcage.base.errors import InputFileError
from vcage.base.files import maker_of, read_json, sha256_file, write_json
from vcage.base.inside import path_complaint
from vcage.schema.base import StageDocument
from vcage.schema.episodes import BY_HAND, Verdict

D = TypeVar("D", bound=StageDocument)

SEAL = ".written.json"
"""Beside the JSON of a stage: ``record``, which is that JSON as it was written, and ``files``, name → SHA-256 of the
others. It is not in the JSON itself, so that one that is put back from a copy is no older than the rest."""

SCRIPT = ".py"
"""Ends the names of scripts, which no stage reads: an edited one changes nothing, and is executed only when named."""

EDITABLE = (".json", ".jsonl", ".png", SCRIPT)
"""Kinds of files beside the JSON of a stage that are looked at. Videos and episodes are inputs of later stages."""

Place = tuple[str, ...]
"""Where in a JSON: ``("episodes", "0", "reason")``; in a pattern ``*`` stands for any one part."""


def seal(record: D, path: Path, by_hand: Mapping[str, str] | None = None) -> D:
    """Write the JSON of a stage, beside which the other files lie by now, and note what was written.

    Args:
        record: what goes into ``path``.
        path: its file.
        by_hand: name → SHA-256 as the stage wrote it, of files that remain edited.
    """
    record.write(path)
    files = {
        file.relative_to(path.parent).as_posix(): sha256_file(file)
        for file in sorted(path.parent.rglob("*"))
        if file.suffix in EDITABLE and file.name != SEAL and file != path and file.is_file()
    }
    sealed = {"record": record.model_dump(mode="json", by_alias=True), "files": files | dict(by_hand or {})}
    write_json(path.with_name(SEAL), sealed)
    return record


def edits(path: Path) -> list[str]:
    """Names of the files in a stage's folder that are not as the stage left them, but for its scripts; what is gone is
    not among them.

    Args:
        path: the stage's JSON.

    Raises:
        DamagedFile: it cannot be parsed.
        InputFileError: what was written is not known any more.
    """
    written = _written(path)
    changed = [] if read_json(path) == written["record"] else [path.name]
    return changed + [name for name in _changed_files(path, written) if not name.endswith(SCRIPT)]


def edited_scripts(path: Path) -> dict[str, str]:
    """Name → SHA-256 as the stage wrote it, of the scripts in its folder that a hand changed; raises as :func:`edits`.

    Args:
        path: the stage's JSON.
    """
    written = _written(path)
    return {name: written["files"][name] for name in _changed_files(path, written) if name.endswith(SCRIPT)}


def _changed_files(path: Path, written: dict[str, Any]) -> list[str]:
    others = {name: path.parent / name for name in written["files"]}
    return [name for name, file in others.items() if file.is_file() and sha256_file(file) != written["files"][name]]


def lost(path: Path) -> list[str]:
    """Names of the files that a stage wrote beside its JSON, not further below, and that are gone."""
    names = [name for name in _written(path)["files"] if "/" not in name]
    return [name for name in names if not (path.parent / name).is_file()]


def require_only(path: Path, *decided: Place) -> None:
    """That nothing else of a stage's JSON was changed by hand.

    Args:
        path: the JSON.
        decided: patterns of what a hand may say there.

    Raises:
        InputFileError: something else was; names it.
    """
    _refuse_changes(path, lambda place: place != ("edited",) and not any(_matches(place, one) for one in decided))


def require_same(path: Path, *fields: str) -> None:
    """That none of these fields of a stage's JSON was changed by hand; raises as :func:`require_only`."""
    _refuse_changes(path, lambda place: not place or place[0] in fields)


def _refuse_changes(path: Path, fixed: Callable[[Place], bool]) -> None:
    for place, found, expected in _changes(_written(path)["record"], read_json(path)):
        if fixed(place):
            refuse(path, ".".join(place) or "(whole file)", found, f"{expected}, as it was written")


def require_evidence(path: Path, edited: Collection[str]) -> None:
    """That no file beside a stage's JSON was changed by hand: what was recorded is evidence.

    Args:
        path: the JSON.
        edited: files that were changed.

    Raises:
        InputFileError: one was; names it.
    """
    for name in edited:
        if name != path.name:
            refuse(path.parent / name, "(whole file)", "changed by hand", f"what {maker_of(path)} recorded")


def written_record(path: Path, kind: type[D]) -> D:
    """The JSON of a stage as the stage wrote it."""
    return kind.parse(_written(path)["record"], path)


def by_hand(was: Verdict, now: Verdict) -> Verdict:
    """A verdict that may have been changed by hand, as what it is then."""
    if now == was:
        return was
    return now.model_copy(
        update={
            "provider": BY_HAND,
            "reason": reason_by_hand((was.accepted, was.reason), (now.accepted, now.reason)),
            "failure": None if now.accepted else now.failure,
        }
    )


def reason_by_hand(was: tuple[bool, str], now: tuple[bool, str]) -> str:
    """Why something is accepted or refused; one that says so of the contrary does not count."""
    return ("accepted by hand" if now[0] else "refused by hand") if was[0] != now[0] and was[1] == now[1] else now[1]


def refuse(path: Path, field: str, found: str, expected: str) -> NoReturn:
    """Say what is wrong with an edited file.

    Args:
        path: the file.
        field: where in it: ``objects.0.pose``.
        found: what is there.
        expected: what should be.

    Raises:
        InputFileError: with all of that.
    """
    raise InputFileError(
        f"{path}: field {field}: {found}; expected {expected}",
        hint="mend the field",
        maker=maker_of(path),
        details={"path": str(path), "field": field, "expected": expected},
    )


def _written(path: Path) -> dict[str, Any]:
    """What a seal says.

    Raises:
        InputFileError: it is gone, or no seal.
    """
    found = read_json(path.with_name(SEAL))
    if not isinstance(found, dict) or not all(isinstance(found.get(key), dict) for key in ("record", "files")):
        raise InputFileError(f"{path.with_name(SEAL)} does not say what was written", maker=maker_of(path))
    for name, digest in found["files"].items():
        if complaint := path_complaint(name) or (None if isinstance(digest, str) else "expected a SHA-256"):
            refuse(path.with_name(SEAL), f"files.{name[:80]}", complaint, "what the stage wrote")
    return found


def _changes(was: Any, now: Any, place: Place = ()) -> Iterator[tuple[Place, str, str]]:
    """Where two JSON values differ, as deep as can be said, with what is there and what was."""
    if isinstance(was, dict) and isinstance(now, dict):
        for key in dict.fromkeys([*was, *now]):
            if key not in now or key not in was:
                yield (*place, key), "nothing" if key not in now else _short(now[key]), _said(was, key)
            else:
                yield from _changes(was[key], now[key], (*place, key))
    elif isinstance(was, list) and isinstance(now, list) and len(was) == len(now):
        for number, (before, after) in enumerate(zip(was, now, strict=True)):
            yield from _changes(before, after, (*place, str(number)))
    elif isinstance(was, list) and isinstance(now, list):
        yield place, f"{len(now)} of them", str(len(was))
    elif was != now:
        yield place, _short(now), _short(was)


def _said(record: dict[str, Any], key: str) -> str:
    return _short(record[key]) if key in record else "nothing"


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 80 else f"{text[:77]}..."


def _matches(place: Place, pattern: Place) -> bool:
    return len(place) == len(pattern) and all(want in ("*", part) for part, want in zip(place, pattern, strict=True))
