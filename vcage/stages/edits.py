"""What was changed by hand in a stage's folder: known by the hashes that its JSON keeps of what the stage wrote.

Pictures, scripts and JSON are for people and agents to edit. Each stage says in its ``take_over`` what must be true of
an edited file, and makes again what follows from it (:mod:`vcage.stages.running` calls it).
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from vcage.base.errors import InputFileError
from vcage.base.files import read_json, sha256_file
from vcage.schema.base import StageDocument

D = TypeVar("D", bound=StageDocument)

EDITABLE = (".json", ".png", ".py")
"""Kinds of files beside the JSON of a stage that are looked at. Videos and episodes are inputs of later stages."""


def sealed(record: D, path: Path, edited: list[str] | None = None) -> D:
    """The record with the hashes of what its stage wrote.

    Args:
        record: what goes into ``path``.
        path: its file, beside which the others lie by now.
        edited: which of them were changed by hand.
    """
    record = record.model_copy(update={"written": {}, "edited": edited or []})
    own = {path.name: _content(record.model_dump(mode="json", by_alias=True))}
    others = {
        file.name: sha256_file(file)
        for file in sorted(path.parent.glob("*"))
        if file.suffix in EDITABLE and file != path and file.is_file()
    }
    return record.model_copy(update={"written": own | others})


def edits(path: Path) -> list[str]:
    """Names of the files in a stage's folder that are not as the stage left them; what is gone is not among them.

    Args:
        path: the stage's JSON.

    Raises:
        DamagedFile: it cannot be parsed.
    """
    data = read_json(path)
    written = data.get("written") if isinstance(data, dict) else None
    if not isinstance(written, dict):
        return [path.name]
    changed = [path.name] if written.get(path.name) != _content(data) else []
    others = {name: path.parent / name for name in written if name != path.name}
    return changed + [name for name, file in others.items() if file.is_file() and sha256_file(file) != written[name]]


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
        hint="mend the field, or run the file's stage with --force",
        details={"path": str(path), "field": field, "expected": expected},
    )


def _content(data: dict[str, Any]) -> str:
    """SHA-256 of a document but for its hashes, however it is laid out."""
    kept = {key: value for key, value in data.items() if key != "written"}
    return hashlib.sha256(json.dumps(kept, sort_keys=True).encode()).hexdigest()
