"""Problems of files, gathered so that one error names all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from vcage.base.errors import SchemaMismatch, mismatch


@dataclass(frozen=True)
class Problem:
    """A wrong field of a file.

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
    """Refuse files with problems.

    Raises:
        SchemaMismatch: there are problems; one error names all of them.
    """
    problems = list({str(problem): problem for problem in problems}.values())
    if len(problems) == 1:
        raise mismatch(problems[0].path, problems[0].field, problems[0].text, problems[0].hint)
    if problems:
        only = f"{problems[0].path}: " if len({problem.path for problem in problems}) == 1 else ""  # named once
        hints = [f" ({problem.hint})" if problem.hint != Problem.hint else "" for problem in problems]
        said = [f"{problem}{hint}".removeprefix(only) for problem, hint in zip(problems, hints, strict=True)]
        raise SchemaMismatch(
            f"{only}{len(problems)} fields are wrong: {'; '.join(said)}",
            hint="fix them",
            details={"path": str(problems[0].path), "fields": [problem.field for problem in problems]},
        )
