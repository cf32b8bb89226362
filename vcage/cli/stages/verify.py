"""Judge by looking whether sub-tasks were done: finished episodes again, or one pair of pictures.

Reads episodes/. Writes verify/verdicts.json; with --before and --after only answers.

examples:
  vcage verify --run runs/stationery --models gemini --force
  vcage verify --run runs/stationery --subtask marker_black-into-packaging_box --before a.png --after b.png
"""

from __future__ import annotations

import argparse
from pathlib import Path

from vcage.base.errors import UsageError
from vcage.base.files import RunFolder
from vcage.cli.output import Result
from vcage.cli.stages.common import add_common, execute_stage


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage verify``."""
    parser.add_argument("--subtask", metavar="ID", help="with --before and --after: the sub-task that is judged")
    parser.add_argument("--before", type=Path, metavar="PNG", help="top view before, from the run's camera")
    parser.add_argument("--after", type=Path, metavar="PNG", help="top view after")
    add_common(parser)


def execute(args: argparse.Namespace) -> Result:
    """Run the stage, or judge one pair.

    Raises:
        UsageError: only some of --subtask, --before, --after are given.
    """
    pair = (args.subtask, args.before, args.after)
    if not any(pair):
        return execute_stage("verify", args, args.run)
    if not all(pair):
        raise UsageError("--subtask, --before and --after belong together", hint="give all three, or none")
    from vcage.stages.context import Workbench
    from vcage.stages.verify import judge_pair

    answer = judge_pair(RunFolder(args.run), Workbench(args.models), *pair)
    return Result(schema=answer.SCHEMA, summary=answer.model_dump(mode="json", by_alias=True))
