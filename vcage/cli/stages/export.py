"""Write the accepted episodes as data sets: LeRobot v2.1 (read by openpi) and v3.0, and RoboTwin's HDF5.

LeRobot's get the compressed videos as they are; --codec or --crf encodes others from the episodes' own pictures.
Reads episodes/ and compress/. Writes export/<format>/ and export/export.json. With --append-to the episodes are also
added to data sets that grow from run to run; an episode is added once.

examples:
  vcage export --run runs/stationery
  vcage export --run runs/stationery --formats lerobot-v3.0 robotwin
  vcage export --run runs/stationery --codec h264 --force
  vcage export --run runs/blocks --append-to datasets/all
"""

from __future__ import annotations

import argparse
from pathlib import Path

from vcage.base.errors import UsageError
from vcage.base.files import RunFolder
from vcage.cli.arguments import folder
from vcage.cli.compression_options import crf_option
from vcage.cli.output import Result
from vcage.cli.progress import progress
from vcage.cli.stages.common import add_common, execute_stage, positive
from vcage.datasets.lerobot.formats import FORMATS
from vcage.stages.settings import EXPORTS, ExportSettings
from vcage.video.encoders import CODECS

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
        "--crf",
        type=crf_option,
        metavar="N",
        help="of LeRobot's videos, instead of the one searched; or 'lossless'",
    )
    parser.add_argument(
        "--append-to",
        type=folder,
        metavar="DIR",
        help="also add the episodes to DIR/<format>, for each of LeRobot's among --formats",
    )
    parser.add_argument(
        "--workers", type=positive, metavar="N", help="processes that encode (default: as cores and memory allow)"
    )
    add_common(parser, models=False)


def execute(args: argparse.Namespace) -> Result:
    """Run the stage, and add its episodes to other data sets if asked to."""
    args.export = ExportSettings(tuple(dict.fromkeys(args.formats)), args.codec, args.crf)
    run, growing = RunFolder(args.run), args.append_to and args.append_to.expanduser()
    _require_sense(args.export, run, growing)
    result = execute_stage("export", args, args.run)
    if growing is None or args.dry_run:
        return result
    from vcage.stages.appending import append_to

    with progress("append") as show:
        sets = append_to(growing, run, show)
    appended = {name: str(path) for name, path in sets.items()}
    return Result(result.output, {**result.summary, "appended": appended}, result.schema, result.next)


def _require_sense(export: ExportSettings, run: RunFolder, growing: Path | None) -> None:
    """Raise UsageError where options are of no use together, before any work is done."""
    of_lerobot = {"--append-to": growing, "--codec": export.codec, "--crf": export.crf}
    given = [option for option, value in of_lerobot.items() if value is not None]
    if given and not set(export.formats) & set(FORMATS):
        raise UsageError(
            f"{' and '.join(given)} concern LeRobot's data sets alone",
            hint=f"add one of them: --formats {' '.join(FORMATS)}",
        )
    if growing is not None and growing.resolve().is_relative_to(run.root):
        raise UsageError(
            f"{growing} lies in the run folder, which one run makes and replaces", hint="give a folder outside of it"
        )
