"""Write the accepted episodes as LeRobot data sets, v2.1 (read by openpi) and v3.0.

Reads episodes/ and compress/. Writes export/lerobot-v2.1/ and export/lerobot-v3.0/.

examples:
  vcage export --run runs/stationery
"""

from __future__ import annotations

import argparse

from vcage.cli.output import Result
from vcage.cli.stages.common import add_common, execute_stage


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage export``."""
    add_common(parser, models=False)


def execute(args: argparse.Namespace) -> Result:
    """Run the stage."""
    return execute_stage("export", args, args.run)
