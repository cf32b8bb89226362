"""Edited files as new inputs: checked like what the stage makes itself, then used."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, NoReturn, TypeVar

from vcage.base.files import RunFolder, stage_of_file
from vcage.base.pictures import read_picture
from vcage.runs.context import StageContext
from vcage.runs.edits import Place, changes, edited_scripts, refuse, written_record
from vcage.schema.base import StageDocument

D = TypeVar("D", bound=StageDocument)


@dataclass(frozen=True)
class Edit(Generic[D]):
    """A stage's JSON that a person edited.

    Args:
        run: the run folder.
        path: of the JSON.
        was: the record as it was written.
        record: the record as it is now.
        keep: names of other files that were edited, which stay as they are.
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
        """Name those of some fields that were edited."""
        return [field for field in fields if getattr(self.was, field) != getattr(self.record, field)]

    def refuse(self, field: str, found: str, expected: str) -> NoReturn:
        """Refuse the edit; see :func:`vcage.runs.edits.refuse`."""
        refuse(self.path, field, found, expected)


@dataclass(frozen=True)
class Editable(Generic[D]):
    """The part of a stage's files that a person may edit; an edit of anything else is refused.

    Args:
        document: the stage's JSON.
        fields: those that may be edited, with all below them: ``episodes.*.reason``; ``episodes.#`` is their number.
        pictures: the files beside may be edited as well; else they are evidence.
        accept: check an edited record, and finish it as the stage finishes its own; raises InputFileError.
    """

    document: type[D]
    fields: Sequence[str] = ()
    pictures: bool = False
    accept: Callable[[Edit[D]], D] = lambda edit: edit.record

    def accepted(self, run: RunFolder, path: Path, files: Sequence[str], folder: Path, context: StageContext) -> D:
        """Return the record of a stage of which files were edited, with them among its ``edited``.

        Args:
            run: the run folder.
            path: the stage's JSON.
            files: names of the edited files.
            folder: a copy of the stage's folder, in which files may be replaced.
            context: what stages share.

        Raises:
            InputFileError: what was edited is not possible or not to be edited: names file, field and expectation.
        """
        was, record = written_record(path, self.document), self.document.read(path)
        for place, found, expected in changes(path):
            if not any(_covers(field.split("."), place) for field in ("edited", *self.fields)):
                field = ".".join(place).removesuffix(".#")
                refuse(path, field, found, f"{expected}, as it was written")
        beside = [name for name in files if name != path.name]
        for name in beside:
            self._require_picture(path.parent / name)
        keep = frozenset([*beside, *edited_scripts(path)])
        record = self.accept(Edit(run, path, was, record, keep, folder, context))
        return record.model_copy(update={"edited": sorted({*was.edited, *files})})

    def _require_picture(self, path: Path) -> None:
        if not self.pictures:
            refuse(path, "(whole file)", "changed by hand", f"what {stage_of_file(path)} recorded")
        read_picture(path)


def _covers(field: Sequence[str], place: Place) -> bool:
    return len(place) >= len(field) and all(one in ("*", part) for one, part in zip(field, place, strict=False))
