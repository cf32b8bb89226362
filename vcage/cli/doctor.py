"""``vcage doctor``; the checks are in :mod:`vcage.cli.checks`."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from vcage.base.errors import ConfigurationError
from vcage.base.options import Flag
from vcage.cli import checks
from vcage.cli.arguments import Command
from vcage.cli.output import Result


@dataclass(frozen=True, kw_only=True)
class Doctor(Command):
    """Say what this machine has for vcage, and for each thing missing the one command that mends it.

    Draws a real picture with the Vulkan driver, which takes some seconds. Keys are shown by name only.

    examples:
      vcage doctor
      vcage doctor --json | tail -n 1
    """

    json: Flag = False
    """no table, only the JSON line"""

    def execute(self) -> Result:
        """Look at everything; the result is a failure when something required is missing."""
        found = [check() for check in checks.ALL]
        text = "" if self.json else table(found)
        record = {"checks": [dataclasses.asdict(finding) for finding in found]}
        missing = [finding for finding in found if not finding.ok and finding.required]
        if not missing:
            return Result(summary=record, schema="vcage.doctor/1", text=text)
        error = ConfigurationError(
            f"missing or unfit: {', '.join(finding.name for finding in missing)}",
            hint=f"run: {missing[0].mend}",
            details=record,
        )
        return Result(text=text, error=error)


def table(found: list[checks.Finding]) -> str:
    """The findings, one a line, each followed by what mends it."""
    width = max(len(finding.name) for finding in found)
    lines = []
    for finding in found:
        mark = "ok" if finding.ok else "MISSING" if finding.required else "-"
        lines.append(f"{mark:<8}{finding.name:<{width}}  {finding.found}")
        if finding.mend:
            lines.append(f"{'':<8}{'':<{width}}  → {finding.mend}")
    return "\n".join(lines)
