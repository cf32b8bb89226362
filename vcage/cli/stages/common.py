"""What all stage commands share: their common options, and how a stage's result is reported."""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path

from vcage.base.files import RunFolder
from vcage.cli.arguments import folder
from vcage.cli.output import Result
from vcage.cli.progress import progress
from vcage.models.registry import CHOICES
from vcage.stages.chain import STAGES, run_stage, stage_module
from vcage.stages.context import Workbench
from vcage.stages.settings import Settings

SCRIPTS = dict(zip(STAGES, (name.replace("_", "-") for name in STAGES), strict=True))
"""Stage → its command."""


MOST = 2**63 - 1
"""The largest whole number that the files can hold."""


def positive(text: str) -> int:
    """An integer above 0, for ``type=`` of an option."""
    value = _whole(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text} is not a positive number")
    return value


def natural(text: str) -> int:
    """An integer of 0 or more, for ``type=`` of an option."""
    value = _whole(text)
    if value < 0:
        raise argparse.ArgumentTypeError(f"{text} is negative")
    return value


def _whole(text: str) -> int:
    try:
        value = int(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number") from error
    if abs(value) > MOST:
        raise argparse.ArgumentTypeError(f"{text} is too large; at most {MOST}")
    return value


def number(lower: float, upper: float) -> Callable[[str], float]:
    """For ``type=`` of an option: a number between two bounds, which are allowed themselves."""

    def parse(text: str) -> float:
        try:
            value = float(text)
        except ValueError as error:
            raise argparse.ArgumentTypeError(f"{text!r} is not a number") from error
        if not lower <= value <= upper:
            raise argparse.ArgumentTypeError(f"{text} is not between {lower:g} and {upper:g}")
        return value

    return parse


def add_common(parser: argparse.ArgumentParser, *, run: bool = True, models: bool = True) -> None:
    """Options that mean the same in every stage."""
    if run:
        parser.add_argument("--run", required=True, type=folder, metavar="DIR", help="the run folder")
    parser.add_argument("--seed", type=natural, help="of every random choice (default: the run's, or 0)")
    if models:
        text = "which models answer (default: auto, that is gemini or openai with a key, else offline)"
        parser.add_argument("--models", choices=CHOICES, default=Settings.models, help=text)
    parser.add_argument("--force", action="store_true", help="make a finished stage again")
    parser.add_argument("--dry-run", action="store_true", help="say what would be done, and do nothing")


def settings_of(args: argparse.Namespace) -> Settings:
    """The settings among the parsed arguments; what the command does not offer keeps its default."""
    known = {field.name for field in fields(Settings)}
    return Settings(**{name: value for name, value in vars(args).items() if name in known})


def execute_stage(stage: str, args: argparse.Namespace, folder: Path) -> Result:
    """Run one stage on a run folder, or with ``--dry-run`` say what it would do."""
    run, settings = RunFolder(folder), settings_of(args)
    bench = Workbench(settings.models, settings.detector, settings.embedder)
    if args.dry_run:
        return _preview(stage, run, settings, bench)
    with progress(stage) as show:
        done = run_stage(stage, run, settings, bench, show)
    return Result(
        output=done.path,
        schema=done.record.SCHEMA,
        summary={"fresh": done.fresh, **stage_module(stage).summary(done.record)},
        next=following(stage, run),
    )


def _preview(stage: str, run: RunFolder, settings: Settings, bench: Workbench) -> Result:
    job = stage_module(stage).job(run, settings, bench)
    provenance = job.provenance()
    return Result(
        output=job.output,
        summary={"would": "replace" if settings.force and job.output.exists() else "write", **provenance.model_dump()},
    )


def following(stage: str, run: RunFolder) -> str:
    """The command that goes on after a stage."""
    index = STAGES.index(stage) + 1
    return f"{vcage_command()} {SCRIPTS[STAGES[index]] if index < len(STAGES) else 'report'} --run {run}"


def vcage_command() -> str:
    """How to call ``vcage`` from here: by name where it is on the PATH, else by the path of this environment's."""
    return "vcage" if shutil.which("vcage") else str(Path(sys.executable).with_name("vcage"))
