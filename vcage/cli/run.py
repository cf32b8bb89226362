"""``vcage run``: all stages, then the report."""

from __future__ import annotations

import contextlib
import logging
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from vcage.apps.report.page import report_is_current, write_report
from vcage.base.files import RunFolder
from vcage.base.progress import Progress
from vcage.cli.arguments import Command
from vcage.cli.going_on import not_dry, remembered
from vcage.cli.output import Result
from vcage.cli.process import stop_if_interrupted
from vcage.cli.progress import progress
from vcage.cli.stage import BeginCommand, about, context_of
from vcage.runs.by_products import note_seconds
from vcage.stages import chain, select_place
from vcage.stages.chain import STAGES

logger = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class Run(BeginCommand[chain.ChainOptions], Command):
    """Turn an instruction, or every sub-task of a scene, into a verified, compressed, training-ready data set.

    Runs select-place, inpaint-plan, match, optimize, search-subtasks, collect, verify, compress and export in one
    process, on the same files as the single commands, then the report. A run that was interrupted goes on when it is
    started again.

    examples:
      vcage run "Pack the marker pens and the eraser into the box" --out runs/pack-stationery --episodes 3
      vcage run "Put the blocks on the plate" --out runs/blocks --seed 4 --models offline
      vcage run "Put the blocks on the plate" --out runs/blocks-10 --episodes 10 --fps 25 --max-loss 0.05
      vcage run --goal "marker/red inside packaging_box" --episodes 1 --out runs/stated
      vcage run --scene office_desk --all-subtasks --out runs/office

    Goals (--goal, --start, --objects) are written as `vcage select-place --help` says.
    """

    def execute(self) -> Result:
        """Run the chain."""
        run, options = RunFolder(self.run), self.stage
        context = context_of(options, run, *STAGES)
        if self.dry_run:
            options.require_possible()
            select_place.job(run, options, context)
            return Result(output=run.root, summary={"would_run": list(STAGES)}, next=not_dry())
        with remembered(run, options):
            done = chain.run_chain(run, options, context, _stage_progress)
        page = run.report if report_is_current(run) else _report(run)
        facts = {
            name: {"fresh": done[name].fresh, **STAGES[name].summary(done[name].record)}
            for name in ("collect", "verify", "compress")
        }
        looked_again = {name: facts["verify"][name] for name in ("verified", "refused")}
        summary = facts["collect"] | looked_again | {"compress": facts["compress"]}
        facts_of = {name: about(stage) for name, stage in done.items()}
        more = {key: {name: one[key] for name, one in facts_of.items() if one.get(key)} for key in facts_of["collect"]}
        if done["collect"].short is not None:
            return Result(error=done["collect"].short, facts={"output": str(page), "summary": summary, **more})
        return Result(output=page, summary=summary, facts=more)


def _report(run: RunFolder) -> Path:
    start = time.perf_counter()
    page = write_report(run)
    note_seconds(run, "report", time.perf_counter() - start)
    return page


@contextlib.contextmanager
def _stage_progress(stage: str) -> Iterator[Progress]:
    stop_if_interrupted()
    logger.info("[%d/%d] %s", list(STAGES).index(stage) + 1, len(STAGES), stage)
    with progress(stage) as show:
        yield show
