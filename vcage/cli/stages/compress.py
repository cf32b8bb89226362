"""Compress the videos of the accepted episodes as far as nobody sees it.

Searches, per camera, the highest CRF of HEVC whose loss stays under a threshold in JOD (ColorVideoVDP).
Reads episodes/. Writes compress/*.mp4 and compress/compression.json.

examples:
  vcage compress --run runs/stationery
  vcage compress --run runs/stationery --max-loss 0.05 --force
"""

from __future__ import annotations

import argparse

from vcage.cli.output import Result
from vcage.cli.stages.common import add_common, execute_stage, number
from vcage.pipeline.settings import Settings


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage compress``."""
    parser.add_argument(
        "--max-loss",
        type=number(0, 10),
        default=Settings.max_loss,
        metavar="JOD",
        help="largest loss of a keyframe (default: %(default)s)",
    )
    add_common(parser, models=False)


def execute(args: argparse.Namespace) -> Result:
    """Run the stage."""
    return execute_stage("compress", args, args.run)
