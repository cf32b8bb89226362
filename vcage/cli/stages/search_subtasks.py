"""Search for sub-tasks that are sensible and proven feasible, and chain them for the instruction.

Reads optimize/scene.json. Writes subtasks/subtasks.json (kept and refused) and one script per kept sub-task.

examples:
  vcage search-subtasks --run runs/stationery
  python runs/stationery/subtasks/marker_black-into-packaging_box.py --episodes 2 --out runs/one
"""

from __future__ import annotations

import argparse

from vcage.cli.output import Result
from vcage.cli.stages.common import add_common, execute_stage


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage search-subtasks``."""
    add_common(parser)


def execute(args: argparse.Namespace) -> Result:
    """Run the stage."""
    return execute_stage("search_subtasks", args, args.run)
