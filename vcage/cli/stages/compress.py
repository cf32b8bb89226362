"""Compress the videos of a run's episodes, or anybody's recordings, as far as nobody sees it.

Searches the highest CRF whose loss stays under a threshold in JOD (ColorVideoVDP), through the real loop of encoding
and decoding, on keyframes; then looks at one in ten of the other frames.

With --run: reads episodes/ of a run; writes compress/*.mp4 and compress/compression.json.
With INPUT: an HDF5 file or a folder of them (this project's, RoboTwin's, ACT's, robomimic's), a LeRobot data set, or
a folder of pictures, which are only read. Writes a new folder: HDF5 with its videos beside it and everything else as
it was (`vcage decompress` puts the pictures back), a LeRobot data set, or videos; and compression.json. An interrupted
call goes on when started again.

A file of robomimic's stays one file, and each of its demonstrations is a recording: FILE.demo_0, FILE.demo_1, … and so
an episode of a LeRobot data set. One that is left out with --skip-damaged stays in the file as it was. Its frame rate
is the control_freq of env_args, where that is said; the last of every 7 numbers of a command is taken for a gripper's.

examples:
  vcage compress --run runs/stationery
  vcage compress --run runs/stationery --max-loss 0.05 --force
  vcage compress robotwin/ --inspect
  vcage compress robotwin/ --fps 16.67 --out small --dry-run
  vcage compress robotwin/ --fps 16.67 --out small
  vcage compress act/ --fps 50 --to lerobot-v3.0 --task "open the jar" --out jar
  vcage compress robomimic/lift.hdf5 --out lift
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

from vcage.base.errors import UsageError
from vcage.base.files import RunFolder
from vcage.cli.arguments import folder
from vcage.cli.compression_options import add_compression_options, compression_settings
from vcage.cli.output import Result
from vcage.cli.progress import progress
from vcage.cli.stages.common import add_common, execute_stage, number, positive
from vcage.datasets.packing.estimating import estimate, estimate_clips
from vcage.datasets.packing.inspecting import describe, inspect, totals
from vcage.datasets.packing.output import TARGETS, OutputSpec
from vcage.datasets.packing.pack import Order, pack
from vcage.stages.compress import clips_of, summary

OF_RECORDINGS = ("out", "to", "fps", "task", "robot", "cameras", "skip_damaged", "inspect")
"""Options that mean nothing with ``--run``."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage compress``."""
    parser.add_argument("input", nargs="?", type=folder, metavar="INPUT", help="recordings: a file or a folder")
    parser.add_argument("--run", type=folder, metavar="DIR", help="the run folder whose episodes are compressed")
    group = parser.add_argument_group("recordings")
    group.add_argument("--out", type=folder, metavar="DIR", help="the folder to write")
    group.add_argument("--to", choices=TARGETS, help="what to write (default: what the recordings are)")
    group.add_argument(
        "--fps", type=number(0.1, 1000), metavar="N", help="frames per second, where recordings do not say"
    )
    group.add_argument("--task", metavar="TEXT", help="for LeRobot: what the robot was told, where nothing says")
    group.add_argument("--robot", metavar="NAME", help="for LeRobot: the robot's type, where nothing says")
    group.add_argument(
        "--cameras",
        nargs="+",
        default=[],
        metavar="NAME",
        help="only these; in a LeRobot data set that stays one, others keep their videos (default: all)",
    )
    group.add_argument("--skip-damaged", action="store_true", help="leave out damaged recordings instead of refusing")
    group.add_argument("--inspect", action="store_true", help="say what is there, and write nothing")
    add_compression_options(parser)
    parser.add_argument(
        "--workers", type=positive, metavar="N", help="processes (default: as many as cores and memory allow)"
    )
    add_common(parser, run=False, models=False)


def execute(args: argparse.Namespace) -> Result:
    """Compress a run or recordings, or look at them."""
    args.compression = compression_settings(args)
    if (args.input is None) == (args.run is None):
        raise UsageError("give either INPUT or --run DIR", hint="see: vcage compress --help")
    if args.run is not None:
        for name in OF_RECORDINGS:
            if getattr(args, name):
                raise UsageError(f"--{name.replace('_', '-')} is for INPUT, not for --run")
        done = execute_stage("compress", args, args.run)
        return _with_estimate(done, args) if args.dry_run else done
    if args.inspect:
        return _inspect(args)
    return _estimate(args) if args.dry_run else _pack(args)


def _inspect(args: argparse.Namespace) -> Result:
    found = inspect(args.input)
    return Result(text=describe(found), summary=totals(found))


def _estimate(args: argparse.Namespace) -> Result:
    with progress("estimate") as show:
        return Result(summary=estimate(_order(args), workers=args.workers, progress=show))


def _with_estimate(preview: Result, args: argparse.Namespace) -> Result:
    clips, _ = clips_of(RunFolder(args.run))
    with progress("estimate") as show:
        told = estimate_clips(clips, args.compression, workers=args.workers, progress=show)
    return replace(preview, summary={**preview.summary, **told})


def _pack(args: argparse.Namespace) -> Result:
    with progress("compress") as show:
        done = pack(_order(args), workers=args.workers, force=args.force, progress=show)
    return Result(
        output=done.path,
        schema=done.record.SCHEMA,
        summary={"fresh": done.fresh, **summary(done.record), "reduction_stored": done.record.reduction_stored},
    )


def _order(args: argparse.Namespace) -> Order:
    out = args.out if args.out is not None else _beside(args.input)
    wanted = OutputSpec(args.to, args.fps, args.task, args.robot)
    return Order(args.input, out, args.compression, wanted, tuple(args.cameras), args.skip_damaged)


def _beside(path: Path) -> Path:
    """Where the output goes that has no name."""
    path = path.resolve()
    return path.with_name(f"{path.stem}-compressed")
