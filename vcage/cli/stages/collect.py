"""Let the robot do the task, check every sub-task by looking, keep what is verified, record it.

Reads optimize/ and subtasks/. Writes episodes/*.hdf5, episodes/log.jsonl (every attempt) and episodes/rejected/.
Takes about 20 s per episode without a GPU; goes on where it stopped when run again.

examples:
  vcage collect --run runs/stationery --episodes 10
  vcage collect --run runs/stationery --episodes 10 --on-failure abort --force
"""

from __future__ import annotations

import argparse

from vcage.cli.output import Result
from vcage.cli.stages.common import add_common, execute_stage, natural, positive
from vcage.stages.settings import Settings


def add_arguments(parser: argparse.ArgumentParser, *, run: bool = True) -> None:
    """Declare the options of ``vcage collect``."""
    parser.add_argument(
        "--episodes",
        type=positive,
        default=Settings.episodes,
        help="accepted episodes to collect (default: %(default)s)",
    )
    parser.add_argument(
        "--on-failure",
        choices=["resample", "abort"],
        default=Settings.on_failure,
        help="after a failed sub-task: try it again from the verified state before it, or give the episode up",
    )
    parser.add_argument(
        "--retries",
        type=natural,
        default=Settings.retries,
        help="further attempts per sub-task (default: %(default)s)",
    )
    parser.add_argument(
        "--fps",
        type=int,
        choices=[5, 10, 25, 50],
        default=Settings.fps,
        help="frames per second of the recording (default: %(default)s)",
    )
    add_common(parser, run=run)


def execute(args: argparse.Namespace) -> Result:
    """Run the stage."""
    return execute_stage("collect", args, args.run)
