"""Edited files as new inputs: found, checked like what the stage makes itself, then used.

:data:`SEAL` beside the JSON of a stage keeps what the stage wrote, so that later changes are found.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, NoReturn, TypeVar

from vcage.base.errors import InputFileError
from vcage.base.files import RunFolder, read_json, sha256_file, stage_of_file, write_json
from vcage.base.inside import path_complaint
from vcage.base.pictures import read_picture
from vcage.runs.context import StageContext
from vcage.schema.base import StageDocument

D = TypeVar("D", bound=StageDocument)

SEAL = ".written.json"
"""Beside the JSON of a stage: ``record``, which is that JSON as it was written, and ``files``, name → SHA-256 of the
others. It is not in the JSON itself, so that one that is put back from a copy is no older than the rest."""

SCRIPT = ".py"
"""Ends the names of scripts, which no stage reads: an edited one changes nothing, and is executed only when named."""

SEALED = (".json", ".jsonl", ".png", SCRIPT)
"""Kinds of files beside the JSON of a stage that are hashed. Videos and episodes are inputs of later stages."""

Place = tuple[str, ...]
"""Where in a JSON: ``("episodes", "0", "reason")``; ``("episodes", "#")`` is the length of a list."""


def seal(record: D, path: Path, scripts: Mapping[str, str] | None = None) -> D:
    """Write the JSON of a stage, after the other files beside it, and record the output.

    Args:
        record: what goes into ``path``.
        path: its file.
        scripts: name → SHA-256 as the stage wrote it, of scripts that stay edited.
    """
    record.write(path)
    files = {
        file.relative_to(path.parent).as_posix(): sha256_file(file)
        for file in sorted(path.parent.rglob("*"))
        if file.suffix in SEALED and file.name != SEAL and file != path and file.is_file()
    }
    sealed = {"record": record.model_dump(mode="json", by_alias=True), "files": files | dict(scripts or {})}
    write_json(path.with_name(SEAL), sealed)
    return record


def edits(path: Path) -> list[str]:
    """Name the edited files in a stage's folder, without scripts and files that are gone.

    Args:
        path: the stage's JSON.

    Raises:
        DamagedFile: it cannot be parsed.
        InputFileError: the seal is gone or damaged.
    """
    changed = [] if read_json(path) == _written(path)["record"] else [path.name]
    return changed + [name for name in _changed_files(path) if not name.endswith(SCRIPT)]


def edited_scripts(path: Path) -> dict[str, str]:
    """Map each edited script in a stage's folder to its SHA-256 as the stage wrote it; raises as :func:`edits`.

    Args:
        path: the stage's JSON.
    """
    return {name: digest for name, digest in _changed_files(path).items() if name.endswith(SCRIPT)}


def lost(path: Path) -> list[str]:
    """Name the missing files of a stage beside its JSON, not further below."""
    return [name for name in _written(path)["files"] if "/" not in name and not (path.parent / name).is_file()]


def changes(path: Path) -> Iterator[tuple[Place, str, str]]:
    """Yield where a stage's JSON differs from what was written: the place, what is there, and what was.

    A list of another length yields one change, of its length.
    """
    was, now = dict(_leaves(_written(path)["record"])), dict(_leaves(read_json(path)))
    changed = [place for place in was | now if was.get(place, ...) != now.get(place, ...)]
    resized = {place[:-1] for place in changed if place[-1:] == ("#",)}
    for place in changed:
        own = place[:-1] if place[-1:] == ("#",) else place
        if not any(own[:depth] in resized for depth in range(len(own))):
            yield place, _in_words(now.get(place, ...)), _in_words(was.get(place, ...))


Complaint = tuple[str, str, str]
"""A field, what is there, and what was expected."""


def require_none(path: Path, complaints: Iterable[Complaint]) -> None:
    """Refuse a file with a complaint; see :func:`refuse`."""
    for complaint in complaints:
        refuse(path, *complaint)


def refuse(path: Path, field: str, found: str, expected: str) -> NoReturn:
    """Report the fault of an edited file.

    Args:
        path: the file.
        field: where in it: ``objects.0.pose``.
        found: the present value.
        expected: what should be.

    Raises:
        InputFileError: with all of that.
    """
    raise InputFileError(
        f"{path}: field {field}: {found}; expected {expected}",
        hint="fix the field",
        maker=stage_of_file(path),
        details={"path": str(path), "field": field, "expected": expected},
    )


def _changed_files(path: Path) -> dict[str, str]:
    files = {path.parent / name: (name, digest) for name, digest in _written(path)["files"].items()}
    return dict(known for file, known in files.items() if file.is_file() and sha256_file(file) != known[1])


def _written(path: Path) -> dict[str, Any]:
    """Return the content of a seal.

    Raises:
        InputFileError: it is gone, or no seal.
    """
    found = read_json(path.with_name(SEAL))
    if not isinstance(found, dict) or not all(isinstance(found.get(key), dict) for key in ("record", "files")):
        raise InputFileError(f"{path.with_name(SEAL)} does not record the stage's output", maker=stage_of_file(path))
    for name, digest in found["files"].items():
        if complaint := path_complaint(name) or (None if isinstance(digest, str) else "expected a SHA-256"):
            refuse(path.with_name(SEAL), f"files.{name[:80]}", complaint, "what the stage wrote")
    return found


def _leaves(value: Any, place: Place = ()) -> Iterator[tuple[Place, Any]]:
    """Yield every value of a JSON by its place, and of each list also its range of indices."""
    if isinstance(value, dict) and value:
        for key, inner in value.items():
            yield from _leaves(inner, (*place, key))
    elif isinstance(value, list):
        yield (*place, "#"), range(len(value))
        for number, inner in enumerate(value):
            yield from _leaves(inner, (*place, str(number)))
    else:
        yield place, value


def _in_words(value: Any) -> str:
    if value is ...:
        return "nothing"
    if isinstance(value, range):
        return f"{len(value)} of them"
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 80 else f"{text[:77]}..."


# --- what may be edited -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Edit(Generic[D]):
    """A stage's JSON that a person edited.

    Args:
        run: the run folder.
        path: of the JSON.
        was: the record as it was written.
        record: the record as it is now.
        keep: names of other edited files, which stay unchanged.
        folder: a copy of the stage's folder, which takes its place.
        context: what stages share.
    """

    run: RunFolder
    path: Path
    was: D
    record: D
    keep: frozenset[str]
    folder: Path
    context: StageContext

    def changes(self, *fields: str) -> list[str]:
        """Name the edited ones of some fields."""
        return [field for field in fields if getattr(self.was, field) != getattr(self.record, field)]


@dataclass(frozen=True)
class Editable(Generic[D]):
    """The part of a stage's files that a person may edit; an edit of anything else is refused.

    Args:
        document: the stage's JSON.
        fields: the editable ones, with all below them: ``episodes.*.reason``; ``episodes.#`` is their number.
        pictures: the files beside may be edited as well; else they are evidence.
        accept: check an edited record, and finish it as the stage finishes its own; raises InputFileError.
    """

    document: type[D]
    fields: Sequence[str] = ()
    pictures: bool = False
    accept: Callable[[Edit[D]], D] = lambda edit: edit.record

    def accepted(self, run: RunFolder, path: Path, files: Sequence[str], folder: Path, context: StageContext) -> D:
        """Return the record of a stage with edited files, listed in its ``edited``.

        Args:
            run: the run folder.
            path: the stage's JSON.
            files: names of the edited files.
            folder: a copy of the stage's folder, in which files may be replaced.
            context: what stages share.

        Raises:
            InputFileError: an edit is impossible or not allowed: names file, field and expectation.
        """
        was, record = self.document.parse(_written(path)["record"], path), self.document.read(path)
        allowed = [field.split(".") for field in ("edited", *self.fields)] if self.fields or self.pictures else []
        for place, found, expected in changes(path):
            if not any(_covers(field, place) for field in allowed):
                field = ".".join(place).removesuffix(".#")
                refuse(path, field, found, f"{expected}, as it was written")
        beside = [name for name in files if name != path.name]
        for name in beside:
            if not self.pictures:
                refuse(path.parent / name, "(whole file)", "changed by hand", f"what {stage_of_file(path)} recorded")
            read_picture(path.parent / name)
        keep = frozenset([*beside, *edited_scripts(path)])
        record = self.accept(Edit(run, path, was, record, keep, folder, context))
        return record.model_copy(update={"edited": sorted({*was.edited, *files})})


def _covers(field: Sequence[str], place: Place) -> bool:
    return len(place) >= len(field) and all(one in ("*", part) for one, part in zip(field, place, strict=False))
