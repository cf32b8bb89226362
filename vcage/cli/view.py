"""Look at an episode in the viewer Rerun: pictures, 3D scene, joints, and what was verified, on one timeline.

EPISODE is an HDF5 file of a run, a run folder, or a recording of others: RoboTwin, ACT, robomimic, LeRobot, a folder of
pictures.
Needs an extra: pip install 'vcage[view]'.

examples:
  vcage view runs/stationery/episodes/episode_000000.hdf5
  vcage view runs/stationery --episode 1 --save look.rrd
  vcage view ~/data/some_lerobot_set --episode 12
"""

from __future__ import annotations

import argparse
from pathlib import Path

from vcage.cli.arguments import folder
from vcage.cli.output import Result
from vcage.cli.progress import progress
from vcage.cli.stages.common import natural, number


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage view``."""
    parser.add_argument("path", type=folder, metavar="EPISODE", help="a file, or a folder that holds episodes")
    parser.add_argument(
        "--episode", type=natural, metavar="N", help="which one, where there are several (default: the first)"
    )
    parser.add_argument("--save", type=Path, metavar="FILE.rrd", help="write a file for the viewer, and do not open it")
    parser.add_argument(
        "--pictures",
        choices=("stored", "compressed", "none"),
        default="stored",
        help="those of the episode as JPEG; the videos of compress, which with --save a viewer from 0.25 on shows "
        "where there is ffmpeg; or none (default: %(default)s)",
    )
    parser.add_argument(
        "--fps",
        type=number(0.01, 10000),
        metavar="N",
        help="frames per second of a recording that does not say; without, it is shown by frames",
    )


def execute(args: argparse.Namespace) -> Result:
    """Show it, or write the file."""
    from vcage.apps.viewer.show import view

    with progress("view") as show:
        shown = view(args.path, number=args.episode, save=args.save, footage=args.pictures, fps=args.fps, progress=show)
    contents = shown.contents
    summary = {
        "episode": shown.number,
        "of": shown.of,
        "frames": contents.frames,
        "cameras": list(contents.cameras),
        "subtasks": contents.segments,
    }
    return Result(output=args.save, summary=summary, next=f"rerun {args.save}" if args.save else "")
