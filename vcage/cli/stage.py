"""The commands of the nine stages: a stage's own options, a run folder, and how its result is reported."""

from __future__ import annotations

import shutil
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Generic, TypeVar

from tyro.conf import OmitArgPrefixes, arg

from vcage.base.files import RunFolder
from vcage.base.options import FOLDER, Flag
from vcage.cli import arguments
from vcage.cli.output import Result
from vcage.cli.progress import progress
from vcage.stages.running import run_stage, stage_of
from vcage.stages.stage import PRODUCERS, StageOptions, StageResult

MOST_PICTURES = 12
"""Of more pictures than these a result names the folders."""

StageO = TypeVar("StageO", bound=StageOptions)


@dataclass(frozen=True, kw_only=True)
class StageCommand(arguments.CommonOptions, Generic[StageO]):
    """What the command of a stage takes."""

    run: Annotated[Path, FOLDER]
    """the run folder"""
    stage: Annotated[StageO, OmitArgPrefixes, arg(name="")]
    dry_run: Flag = False
    """say what would be done, and do nothing"""


@dataclass(frozen=True, kw_only=True)
class BeginCommand(StageCommand[StageO]):
    """What a command takes that begins a run."""

    run: Annotated[Path, FOLDER, arg(name="out", aliases=("--run",))]
    """the run folder to begin"""


def options_of(name: str) -> type[StageCommand]:
    """What the command of a stage takes."""
    kind = BeginCommand if name == "select_place" else StageCommand
    stage = stage_of(name)
    return kind[stage.Options]


def execute_stage(name: str, command: StageCommand) -> Result:
    """Run one stage on a run folder, or with ``--dry-run`` say what it would do."""
    stage, run, options = stage_of(name), RunFolder(command.run), command.stage
    context = options.context()
    if command.dry_run:
        job = stage.job(run, options, context)
        would = "replace" if options.force and job.output.exists() else "write"
        return Result(output=job.output, summary={"would": would, **job.provenance().model_dump()})
    with progress(name) as show:
        done = run_stage(stage, run, options, context, show)
    if done.short is not None:
        facts = {"output": str(done.path), "summary": stage.summary(done.record), **about(done)}
        return Result(error=done.short, facts=facts)
    return Result(
        output=done.path,
        schema=done.record.SCHEMA,
        summary={"fresh": done.fresh, **stage.summary(done.record)},
        next=following(name, run),
        facts=about(done),
    )


def about(done: StageResult[Any]) -> dict[str, Any]:
    """Who answered in a stage, by role; where its pictures are; and what was edited by hand of its files."""
    found = sorted(done.path.parent.rglob("*.png"))
    shown = found if len(found) <= MOST_PICTURES else sorted({picture.parent for picture in found})
    return {
        "answered_by": done.record.provenance.providers,
        "pictures": [str(path) for path in shown],
        "edited": done.record.edited,
    }


def following(name: str, run: RunFolder) -> str:
    """The command that goes on after a stage."""
    stages = list(PRODUCERS.values())
    later = stages[stages.index(name) + 1 :]
    return f"{vcage_command()} {later[0].replace('_', '-') if later else 'report'} --run {run}"


def vcage_command() -> str:
    """How to call ``vcage`` from here: by name where it is on the PATH, else by the path of this environment's."""
    return "vcage" if shutil.which("vcage") else str(Path(sys.executable).with_name("vcage"))
