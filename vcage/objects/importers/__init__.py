"""Objects of other projects become objects of ours: one folder each, with annotation and models."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from vcage.base.errors import VcageError


@dataclass(frozen=True)
class Imported:
    """Outcome of the import of one object.

    Args:
        name: of the object in our library.
        folder: where its annotation lies; where it would lie when it was refused.
        warnings: omissions and assumptions, each naming file and field.
        error: why it was refused; None when it was imported.
    """

    name: str
    folder: Path
    warnings: list[str] = field(default_factory=list)
    error: VcageError | None = None
