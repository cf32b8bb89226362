"""Write report.html, one self-contained page about a run: pictures, sub-tasks, episodes, verdicts, sizes.

examples:
  vcage report --run runs/stationery
"""

from __future__ import annotations

import argparse

from vcage.base.files import RunFolder
from vcage.cli.arguments import folder
from vcage.cli.output import Result


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage report``."""
    parser.add_argument("--run", required=True, type=folder, metavar="DIR", help="the run folder")


def execute(args: argparse.Namespace) -> Result:
    """Write the page."""
    from vcage.apps.report.page import write_report

    return Result(output=write_report(RunFolder(args.run)))
