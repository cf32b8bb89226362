"""``vcage report``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from vcage.base.files import RunFolder
from vcage.base.options import FOLDER
from vcage.cli.arguments import Command
from vcage.cli.output import Result


@dataclass(frozen=True, kw_only=True)
class Report(Command):
    """Write report.html, one self-contained page about a run: pictures, sub-tasks, episodes, verdicts, sizes.

    examples:
      vcage report --run runs/stationery
    """

    run: Annotated[Path, FOLDER]
    """the run folder"""

    def execute(self) -> Result:
        """Write the page."""
        from vcage.apps.report.page import write_report

        return Result(output=write_report(RunFolder(self.run)))
