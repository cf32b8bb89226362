"""Runs of the policy benchmark that get more episodes."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any

from benchmarks._policy.collected import _renewed
from vcage.base.errors import StaleStage
from vcage.base.files import RunFolder
from vcage.runs.context import StageContext
from vcage.runs.stage import StageOptions


def test_a_stage_that_was_of_fewer_episodes_is_carried_out_again(tmp_path: Path) -> None:
    forced = []

    def execute(_run: RunFolder, options: StageOptions, *_more: Any) -> None:
        forced.append(options.force)
        if not options.force:
            raise StaleStage("made with another input")

    stage = ModuleType("export")
    stage.execute = execute  # type: ignore[attr-defined]
    _renewed(stage, RunFolder(tmp_path), StageOptions(), StageContext("offline"), "export")
    assert forced == [False, True]
