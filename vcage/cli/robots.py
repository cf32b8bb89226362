"""``vcage robots …``: what can be done with robots."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

from vcage.base.commands import vcage_command
from vcage.base.options import FOLDER, UNSAID, Flag, value
from vcage.cli.arguments import Command
from vcage.cli.output import Result


@dataclass(frozen=True, kw_only=True)
class ListRobots(Command):
    """List the robots: ours, and the imported ones.

    examples:
      vcage robots list
    """

    def execute(self) -> Result:
        """List.

        Raises:
            InputFileError: a robot's file is damaged.
        """
        from vcage.schema.robot import DEFAULT_ROBOT
        from vcage.sim.robots import available, load_robot

        robots = [load_robot(name) for name in available("robots")]
        named = [robot.name + " (default)" * (robot.name == DEFAULT_ROBOT) for robot in robots]
        lines = [f"{name}: {', '.join(r.arms)}. {r.description}" for name, r in zip(named, robots, strict=True)]
        return Result(summary={"robots": [robot.name for robot in robots]}, text="\n".join(lines))


def _metres(text: str) -> float:
    try:
        metres = float(text)
    except ValueError:
        metres = math.nan
    if not 0 < metres < 10:
        raise ValueError(f"{text!r} is not a distance; expected metres above 0")
    return metres


@dataclass(frozen=True, kw_only=True)
class ImportRobot(Command):
    """Import a robot of RoboTwin: an embodiment's folder with config.yml and its URDF, as it is downloaded.

    The record goes to the user's data folder; the meshes stay in the embodiment's folder. What the config does not say
    is measured on the URDF, and what cannot be measured is assumed, with a warning for each.

    examples:
      vcage robots import robotwin ~/RoboTwin/assets/embodiments/franka-panda --distance 0.6
      vcage robots import robotwin ~/RoboTwin/assets/embodiments/aloha-agilex
    """

    source: Annotated[Literal["robotwin"], Positional]
    """whose format it is"""
    folder: Annotated[Path, FOLDER, Positional, arg(metavar="DIR")]
    """folder of the embodiment, with config.yml"""
    distance: Annotated[float | None, value(_metres, "METRES"), UNSAID] = None
    """between the bases of two single arms (default: 0.6)"""
    force: Flag = False
    """replace the robot that was imported before"""

    def execute(self) -> Result:
        """Import.

        Raises:
            UsageError: the name is taken, or a distance is given for a robot with both arms on one body.
            InputFileError: a file is missing or damaged, or a field is invalid.
        """
        from vcage.sim.robotwin.importing import import_robot

        robot = import_robot(self.folder, self.distance, force=self.force)
        lines = [f"{robot.name}: imported", *(f"  warning: {warning}" for warning in robot.warnings)]
        return Result(
            output=robot.path,
            schema="vcage.robot/1",
            summary={"robot": robot.name, "warnings": len(robot.warnings)},
            next=vcage_command("robots", "list"),
            text="\n".join(lines),
        )
