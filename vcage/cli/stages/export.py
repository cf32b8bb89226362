"""Write the accepted episodes as data sets: LeRobot v2.1 (read by openpi) and v3.0, and RoboTwin's HDF5.

LeRobot's get the compressed videos as they are; --codec or --crf encodes others from the episodes' own pictures.
Reads episodes/ and compress/. Writes export/<format>/ and export/export.json. With --append-to the episodes are also
added to data sets that grow from run to run; a run is added once.

examples:
  vcage export --run runs/stationery
  vcage export --run runs/stationery --formats lerobot-v3.0 robotwin
  vcage export --run runs/stationery --codec h264 --force
  vcage export --run runs/blocks --append-to datasets/all
"""

from __future__ import annotations

import argparse

from vcage.cli.arguments import folder
from vcage.cli.compression_options import crf_option
from vcage.cli.output import Result
from vcage.cli.progress import progress
from vcage.cli.stages.common import add_common, execute_stage, positive, settings_of
from vcage.compression.encoders import CODECS
from vcage.errors import UsageError
from vcage.files import RunFolder
from vcage.pipeline.settings import EXPORTS, ExportSettings

DEFAULTS = ExportSettings()


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage export``."""
    parser.add_argument(
        "--formats",
        nargs="+",
        choices=EXPORTS,
        default=list(DEFAULTS.formats),
        help=f"what to write (default: {' '.join(DEFAULTS.formats)})",
    )
    parser.add_argument("--codec", choices=tuple(CODECS), help="of LeRobot's videos (default: as compressed)")
    parser.add_argument(
        "--crf", type=crf_option, metavar="N", help="this CRF instead of the one searched; or 'lossless'"
    )
    parser.add_argument(
        "--append-to", type=folder, metavar="DIR", help="also add the episodes to DIR/lerobot-v2.1 and DIR/lerobot-v3.0"
    )
    parser.add_argument(
        "--workers", type=positive, metavar="N", help="processes that encode (default: as cores and memory allow)"
    )
    add_common(parser, models=False)


def execute(args: argparse.Namespace) -> Result:
    """Run the stage, and add its episodes to other data sets if asked to."""
    args.export = ExportSettings(tuple(dict.fromkeys(args.formats)), args.codec, args.crf)
    if args.append_to is not None and args.append_to.resolve().is_relative_to(args.run.resolve()):
        raise UsageError(
            f"{args.append_to} lies in the run folder, which one run makes and replaces",
            hint="give a folder outside of it",
        )
    result = execute_stage("export", args, args.run)
    if args.append_to is None or args.dry_run:
        return result
    from vcage.pipeline.appending import append_to

    with progress("append") as show:
        sets = append_to(args.append_to, RunFolder(args.run), settings_of(args), show)
    appended = {name: str(path) for name, path in sets.items()}
    return Result(result.output, {**result.summary, "appended": appended}, result.schema, result.next)
