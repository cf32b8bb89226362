"""Choose the objects for an instruction, and place them on the table without collision.

Writes place/scene.json (objects, poses, camera), source.png, background.png and segmentation.png.

examples:
  vcage select-place "Pack the marker pens and the eraser into the box" --out runs/stationery
  vcage select-place "Put the blocks on the plate" --out runs/blocks --seed 7 --force
"""

from __future__ import annotations

import argparse

from vcage.cli.arguments import folder
from vcage.cli.output import Result
from vcage.cli.stages.common import add_common, execute_stage
from vcage.stages.settings import Settings


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage select-place``."""
    add_own_arguments(parser)
    add_common(parser, run=False)


def add_own_arguments(parser: argparse.ArgumentParser) -> None:
    """What begins a run: the instruction, its folder, the scene."""
    parser.add_argument("instruction", help="the task in plain language, in quotes")
    parser.add_argument("--out", "--run", required=True, type=folder, metavar="DIR", help="the run folder to begin")
    parser.add_argument(
        "--scene", dest="template", default=Settings.template, help="the scene template (default: %(default)s)"
    )


def execute(args: argparse.Namespace) -> Result:
    """Run the stage."""
    return execute_stage("select_place", args, args.out)
