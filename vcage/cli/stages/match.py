"""Find each object again in the target picture: position and rotation in the world.

Reads place/ and inpaint/. Writes match/matches.json and match/overlay.png.

examples:
  vcage match --run runs/stationery
  vcage match --run runs/stationery --threshold 0.7 --force
"""

from __future__ import annotations

import argparse

from vcage.cli.output import Result
from vcage.cli.stages.common import add_common, execute_stage, number
from vcage.pipeline.settings import Settings


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage match``."""
    parser.add_argument(
        "--threshold",
        type=number(0, 1),
        default=Settings.threshold,
        metavar="τ",
        help="smallest cosine similarity of a match (default: %(default)s)",
    )
    add_common(parser)


def execute(args: argparse.Namespace) -> Result:
    """Run the stage."""
    return execute_stage("match", args, args.run)
