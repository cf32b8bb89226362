"""The entry of a generated sub-task script run directly: its own scene, its own run folder."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

from tyro.conf import arg

from vcage.base.commands import CALLED, joined
from vcage.base.options import FOLDER
from vcage.cli.arguments import parse, words
from vcage.cli.going_on import naming_stages
from vcage.cli.output import Result, run_cli
from vcage.cli.process import end_process
from vcage.cli.progress import set_up
from vcage.cli.stage import StageCommand, execute_stage
from vcage.cli.streams import stray_output_on_stderr
from vcage.runs.running import at_work
from vcage.stages import collect


@dataclass(frozen=True, kw_only=True)
class ScriptCommand(StageCommand[collect.Options]):
    """Options of a script."""

    run: Annotated[Path, FOLDER, arg(name="out")]
    """the run folder"""


def run_script(path: str, argv: list[str] | None = None) -> int:
    """Collect episodes of one sub-task script into a run folder of its own; returns the exit code."""
    code = run_cli(_run, Path(path).resolve(), sys.argv[1:] if argv is None else argv)
    return end_process(code) if argv is None else code


def _run(path: Path, arguments: Sequence[str]) -> Result | None:
    from vcage.base.files import RunFolder
    from vcage.episodes.scripts import prepare_run
    from vcage.tasks.synthesis import load_script

    text = f"{load_script(path).values['TEXT']}\n\n{(collect.__doc__ or '').splitlines()[0]}"
    program = [sys.executable, str(path)]
    command = parse(ScriptCommand, arguments, prog=path.name, text=text, about=joined([*program, "--help"]))
    if command is None:
        return None
    CALLED.set(joined([*program, *words(command)]))
    set_up(command.verbose, command.progress)
    run = RunFolder(command.run)
    with stray_output_on_stderr(), naming_stages(None):  # its run has no stages before
        with at_work(run):
            prepare_run(run, path, seed=command.stage.seed or 0, force=command.stage.force)
        return execute_stage("collect", replace(command, stage=replace(command.stage, script=(path,))))
