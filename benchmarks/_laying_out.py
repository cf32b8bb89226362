"""The stages before the sub-tasks, offline, for benchmarks that begin with a sentence or a scene."""

from __future__ import annotations

from vcage.base.files import RunFolder
from vcage.runs.context import StageContext
from vcage.stages import inpaint_plan, match, optimize, select_place


def lay_out(run: RunFolder, begun: select_place.Options, context: StageContext) -> None:
    """Write ``place/``, ``inpaint/``, ``match/`` and ``optimize/`` of a run.

    Args:
        run: the run folder.
        begun: the request, and the seed of all stages.
        context: the library and the offline models.

    Raises:
        VcageError: a stage refuses.
    """
    select_place.execute(run, begun, context)
    lay_out_placed(run, begun.seed, context)


def lay_out_placed(run: RunFolder, seed: int | None, context: StageContext) -> None:
    """Write what :func:`lay_out` writes after ``place/``, with one seed for the stages."""
    inpaint_plan.execute(run, inpaint_plan.Options(models="offline", seed=seed), context)
    match.execute(run, match.Options(models="offline", seed=seed), context)
    optimize.execute(run, optimize.Options(seed=seed), context)
