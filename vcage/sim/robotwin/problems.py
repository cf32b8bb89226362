"""Problems of a robot's files, gathered so that one error names all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from vcage.base.errors import SchemaMismatch, mismatch


@dataclass(frozen=True)
class Problem:
    """A field with which the robot cannot be made.

    Args:
        path: of the file.
        field: its name.
        text: the defect and the expectation.
        hint: the remedy.
    """

    path: Path
    field: str
    text: str
    hint: str = "fix the field"

    def __str__(self) -> str:
        return f"{self.path}: field {self.field}: {self.text}"


def require_none(problems: Sequence[Problem]) -> None:
    """Refuse a robot with problems.

    Raises:
        SchemaMismatch: there are problems; one error names all of them.
    """
    problems = list({str(problem): problem for problem in problems}.values())
    if len(problems) == 1:
        raise mismatch(problems[0].path, problems[0].field, problems[0].text, problems[0].hint)
    if problems:
        raise SchemaMismatch(
            f"{len(problems)} fields are wrong: {'; '.join(map(str, problems))}",
            hint="fix them",
            details={"path": str(problems[0].path), "fields": [problem.field for problem in problems]},
        )
