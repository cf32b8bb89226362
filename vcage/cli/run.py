"""Turn an instruction into a verified, compressed, training-ready data set: all stages, then the report.

Runs select-place, inpaint-plan, match, optimize, search-subtasks, collect, verify, compress and export in one
process, on the same files as the single commands. A run that was interrupted goes on when started again.

examples:
  vcage run "Pack the marker pens and the eraser into the box" --out runs/pack-stationery --episodes 3
  vcage run "Put the blocks on the plate" --out runs/blocks --seed 4 --models offline
  vcage run "Put the blocks on the plate" --out runs/blocks-10 --episodes 10 --fps 25 --max-loss 0.05
"""

from __future__ import annotations

import argparse
import logging
from dataclasses import replace

from vcage.apps.report.page import write_report
from vcage.base.errors import StaleStage
from vcage.base.files import RunFolder
from vcage.cli.compression_options import add_compression_options, compression_settings
from vcage.cli.output import Result, stop_if_interrupted
from vcage.cli.progress import progress
from vcage.cli.stages import collect, match, select_place
from vcage.cli.stages.common import settings_of
from vcage.stages.chain import STAGES, run_stage, stage_module
from vcage.stages.context import Workbench
from vcage.stages.settings import Settings
from vcage.stages.stage import StageResult
from vcage.stages.timings import timed

logger = logging.getLogger(__name__)

OF_THE_EPISODES = STAGES[STAGES.index("collect") + 1 :]
"""Stages whose files can be had again from the episodes."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``vcage run``: those of the stages that have some of their own."""
    select_place.add_own_arguments(parser)
    match.add_own_arguments(parser)
    collect.add_arguments(parser, run=False)
    add_compression_options(parser)


def execute(args: argparse.Namespace) -> Result:
    """Run the chain."""
    args.compression = compression_settings(args)
    run, settings = RunFolder(args.out), settings_of(args)
    bench = Workbench(settings.models, settings.detector, settings.embedder)
    if args.dry_run:
        stage_module(STAGES[0]).job(run, settings, bench)
        return Result(output=run.root, summary={"would_run": list(STAGES)})
    facts = {}
    for number, stage in enumerate(STAGES, start=1):
        stop_if_interrupted()
        logger.info("[%d/%d] %s", number, len(STAGES), stage)
        done = _run_stage(stage, run, settings, bench)
        facts[stage] = {"fresh": done.fresh, **stage_module(stage).summary(done.record)}
    with timed(run, "report"):
        page = write_report(run)
    return Result(output=page, summary=facts["collect"] | {"compress": facts["compress"]}, next=f"open {page}")


def _run_stage(stage: str, run: RunFolder, settings: Settings, bench: Workbench) -> StageResult:
    """Run a stage; what was made from fewer episodes than there are now is made again without being asked."""
    with progress(stage) as show:
        try:
            return run_stage(stage, run, settings, bench, show)
        except StaleStage as error:
            if stage not in OF_THE_EPISODES or not all(what.startswith("input ") for what in error.details["changed"]):
                raise
            logger.info("%s: made again, as the episodes are others than before", stage)
            return run_stage(stage, run, replace(settings, force=True), bench, show)
