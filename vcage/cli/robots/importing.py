"""Import a robot of RoboTwin: an embodiment's folder with config.yml and its URDF, as it is downloaded.

The record goes to the user's data folder; the meshes stay in the embodiment's folder. What the config does not say is
measured on the URDF, and what cannot be measured is assumed, with a warning for each.

examples:
  vcage robots import robotwin ~/RoboTwin/assets/embodiments/franka-panda --distance 0.6
  vcage robots import robotwin ~/RoboTwin/assets/embodiments/aloha-agilex
"""

from __future__ import annotations

import argparse
import math

from vcage.cli.arguments import folder
from vcage.cli.output import Result


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage robots import``."""
    parser.add_argument("source", choices=["robotwin"], help="whose format it is")
    parser.add_argument("folder", type=folder, metavar="DIR", help="folder of the embodiment, with config.yml")
    parser.add_argument(
        "--distance", type=_metres, metavar="METRES", help="between the bases of two single arms (default: 0.6)"
    )
    parser.add_argument("--force", action="store_true", help="replace the robot that was imported before")


def _metres(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 < value < 10:
        raise argparse.ArgumentTypeError(f"{text!r} is no distance; expected metres above 0")
    return value


def execute(args: argparse.Namespace) -> Result:
    """Import.

    Raises:
        UsageError: the name is taken, or a distance is given for a robot with both arms on one body.
        InputFileError: a file is missing or damaged, or a field is not what it should be.
    """
    from vcage.sim.robotwin.importing import import_robot

    robot = import_robot(args.folder, args.distance, force=args.force)
    lines = [f"{robot.name}: imported", *(f"  warning: {warning}" for warning in robot.warnings)]
    return Result(
        output=robot.path,
        schema="vcage.robot/1",
        summary={"robot": robot.name, "warnings": len(robot.warnings)},
        next="vcage robots list",
        text="\n".join(lines),
    )
