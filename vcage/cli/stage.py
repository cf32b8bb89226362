"""The commands of the nine stages: a stage's own options, a run folder, and how its result is reported."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Generic, TypeVar

from tyro.conf import OmitArgPrefixes, arg

from vcage.base.files import RunFolder
from vcage.base.options import FOLDER, Flag
from vcage.cli import arguments
from vcage.cli.going_on import following, not_dry, remembered
from vcage.cli.output import Result
from vcage.cli.progress import progress
from vcage.runs.context import StageContext
from vcage.runs.running import run_stage, stage_of
from vcage.runs.stage import ASKS, ModelOptions, StageOptions, StageResult

logger = logging.getLogger(__name__)

MOST_PICTURES = 12
"""A result with more pictures names their folders."""

StageO = TypeVar("StageO", bound=StageOptions)


@dataclass(frozen=True, kw_only=True)
class StageCommand(arguments.CommonOptions, Generic[StageO]):
    """Options of the command of a stage."""

    run: Annotated[Path, FOLDER]
    """the run folder"""
    stage: Annotated[StageO, OmitArgPrefixes, arg(name="")]
    dry_run: Flag = False
    """say what would be done, and do nothing"""


@dataclass(frozen=True, kw_only=True)
class BeginCommand(StageCommand[StageO]):
    """Options of a command that begins a run."""

    run: Annotated[Path, FOLDER, arg(name="out", aliases=("--run",))]
    """the run folder to begin"""


def options_of(name: str) -> type[StageCommand]:
    """Return the options of the command of a stage."""
    kind = BeginCommand if name == "select_place" else StageCommand
    stage = stage_of(name)
    return kind[stage.Options]


def context_of(options: StageOptions, run: RunFolder, *stages: str) -> StageContext:
    """Return the context of stages, and log who answers them where nobody was named."""
    roles = list(dict.fromkeys(role for stage in stages for role in ASKS.get(stage, ())))
    if isinstance(options, ModelOptions) and (chosen := options.who(run).announcement(roles)):
        logger.info("%s", chosen)
    return options.context(run)


def execute_stage(name: str, command: StageCommand) -> Result:
    """Run one stage on a run folder, or with ``--dry-run`` describe its work."""
    stage, run, options = stage_of(name), RunFolder(command.run), command.stage
    context = context_of(options, run, name)
    if command.dry_run:
        job = stage.job(run, options, context)
        would = "replace" if options.force and job.output.exists() else "write"
        summary = {"would": would, **job.provenance().model_dump()}
        return Result(output=job.output, summary=summary, next=not_dry())
    with remembered(run, options), progress(name) as show:
        done = run_stage(stage, run, options, context, show)
    if done.short is not None:
        facts = {"output": str(done.path), "summary": stage.summary(done.record), **about(done)}
        return Result(error=done.short, facts=facts, next=following(name, run))
    return Result(
        output=done.path,
        schema=done.record.SCHEMA,
        summary={"fresh": done.fresh, **stage.summary(done.record)},
        next=following(name, run),
        facts=about(done),
    )


def about(done: StageResult[Any]) -> dict[str, Any]:
    """Return who answered in a stage, by role, its pictures, its edited files, and notes."""
    found = sorted(done.path.parent.rglob("*.png"))
    shown = found if len(found) <= MOST_PICTURES else sorted({picture.parent for picture in found})
    return {
        "answered_by": done.record.provenance.providers,
        "pictures": [str(path) for path in shown],
        "edited": done.record.edited,
        **({"notes": list(done.notes)} if done.notes else {}),
    }
