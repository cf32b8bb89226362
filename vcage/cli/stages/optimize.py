"""Find the nearest layout without collisions, rebuild it in the simulator and let it settle.

Reads place/, inpaint/ and match/. Writes optimize/scene.json and optimize/layout.png.

examples:
  vcage optimize --run runs/stationery
  vcage optimize --run runs/stationery --margin 0.05 --force
"""

from __future__ import annotations

import argparse

from vcage.cli.output import Result
from vcage.cli.stages.common import add_common, execute_stage, natural, number
from vcage.pipeline.settings import Settings


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage optimize``."""
    parser.add_argument(
        "--margin",
        type=number(0, 0.5),
        default=Settings.margin,
        metavar="δ",
        help="gap between two objects, metres (default: %(default)s)",
    )
    parser.add_argument(
        "--restarts",
        type=natural,
        default=Settings.restarts,
        help="random restarts of the optimiser (default: %(default)s)",
    )
    add_common(parser, models=False)


def execute(args: argparse.Namespace) -> Result:
    """Run the stage."""
    return execute_stage("optimize", args, args.run)
