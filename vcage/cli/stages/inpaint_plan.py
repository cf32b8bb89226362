"""Plan the layout in words and relations, and draw it as a target picture.

Reads place/. Writes inpaint/plan.json and inpaint/target.png.

examples:
  vcage inpaint-plan --run runs/stationery
  vcage inpaint-plan --run runs/stationery --models gemini --force
"""

from __future__ import annotations

import argparse

from vcage.cli.output import Result
from vcage.cli.stages.common import add_common, execute_stage


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage inpaint-plan``."""
    add_common(parser)


def execute(args: argparse.Namespace) -> Result:
    """Run the stage."""
    return execute_stage("inpaint_plan", args, args.run)
