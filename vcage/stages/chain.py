"""The stages in order, and the whole chain in one process."""

from __future__ import annotations

import importlib
from types import ModuleType

from vcage.base.files import RunFolder
from vcage.base.progress import Progress, silent
from vcage.stages.context import Workbench
from vcage.stages.settings import Settings
from vcage.stages.stage import PRODUCERS, StageResult
from vcage.stages.timings import timed

STAGES = tuple(PRODUCERS.values())
"""Names of the nine stages, in the order in which they run."""


def stage_module(name: str) -> ModuleType:
    """The module of a stage: ``job(run, settings, bench)`` and ``execute(run, settings, bench, progress)``."""
    return importlib.import_module(f"vcage.stages.{name}")


def run_stage(
    name: str, run: RunFolder, settings: Settings, bench: Workbench, progress: Progress = silent
) -> StageResult:
    """Run one stage and note how long it took; raises what the stage raises."""
    with timed(run, name):
        return stage_module(name).execute(run, settings, bench, progress)
