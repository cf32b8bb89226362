"""The next command: after a stage, and after an error that a stage fixes."""

from __future__ import annotations

import contextlib
import shlex
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from vcage.base.commands import CALLED, vcage_command
from vcage.base.errors import MissingStage, NotJudged, StaleStage, VcageError
from vcage.base.files import PRODUCERS, RunFolder, write_json
from vcage.cli.arguments import options_of

if TYPE_CHECKING:
    from vcage.runs.stage import StageOptions

NOT_STORED = ("force", "script")
"""Options that every call gives anew: they throw files away, or execute one."""


def following(name: str, run: RunFolder) -> str:
    """Return the command to run after a stage."""
    stages = list(PRODUCERS.values())
    later = stages[stages.index(name) + 1 :]
    return stage_command(later[0], run) if later else vcage_command("report", "--run", run)


def stage_command(name: str, run: RunFolder, instead: Mapping[str, list[str]] | None = None) -> str:
    """Return the command of a stage, with the options last given on this run that it takes."""
    return vcage_command(name.replace("_", "-"), *words_of(name, run, instead))


def words_of(name: str, run: RunFolder, instead: Mapping[str, list[str]] | None = None) -> list[str]:
    """Return the words of :func:`stage_command` after the name; ``instead`` replaces options given before."""
    from vcage.runs.running import stage_of  # imported late: `vcage setup` works where no stage does

    takes = list(options_of(stage_of(name).Options()))
    given, before = dict(instead or {}), _last_options(run)
    given |= {o.key: before[o.key] for o in takes if o.key in before.keys() - given and o.is_said_by(before[o.key])}
    words = [word for option in takes for word in given.get(option.key, [])]
    return ["--out" if name == "select_place" else "--run", str(run), *words]


@contextlib.contextmanager
def remembered(run: RunFolder, options: StageOptions) -> Iterator[None]:
    """Store the options of a call made inside, for :func:`stage_command`, unless it fails.

    Between a stage that asks models and the next one there is a stage without ``--models``.
    """
    try:
        yield
    except MissingStage:  # it is called again after another stage
        _remember(run, options)
        raise
    _remember(run, options, instead=True)


def _remember(run: RunFolder, options: StageOptions, *, instead: bool = False) -> None:
    """Add options to those stored; with ``instead`` replace all options of the stage, given or not."""
    if not any((run.root / folder).is_dir() for folder in PRODUCERS):
        return  # it has not begun
    own = [option for option in options_of(options) if option.key not in NOT_STORED]
    others = {option.key for option in own} if instead else set()
    stored = {key: words for key, words in _last_options(run).items() if key not in others}
    write_json(run.options, stored | {option.key: option.words() for option in own if option.is_said})


def _last_options(run: RunFolder) -> dict[str, list[str]]:
    """Return option → the words that gave it last."""
    from vcage.runs.by_products import read_by_product

    given = read_by_product(run.options, list[str])
    return {key: words for key, words in given.items() if key not in NOT_STORED}


def not_dry() -> str:
    """Return the command of this process without ``--dry-run``."""
    return shlex.join(word for word in shlex.split(CALLED.get()) if word != "--dry-run")


@contextlib.contextmanager
def naming_stages(run: Path | None) -> Iterator[None]:
    """Give an error inside that a stage of the run fixes the command of that stage."""
    try:
        yield
    except VcageError as error:
        if isinstance(error, StaleStage) and not error.maker:
            called = CALLED.get()
            error.offer(f"replace it: {called if '--force' in called.split() else f'{called} --force'}")
        elif error.maker and not error.command and run is not None:
            _name_stage(error, RunFolder(run))
        raise


def _name_stage(error: VcageError, run: RunFolder) -> None:
    """Give an error the command of the stage that fixes it; a command that loses files is in the hint only."""
    if "more" in error.details:
        error.command = stage_command(error.maker, run, error.details["more"])
        return
    again = stage_command(error.maker, run)
    folder = next(folder for folder, stage in PRODUCERS.items() if stage == error.maker)
    has_task = bool({"instruction", "goals"} & _last_options(run).keys())
    if isinstance(error, StaleStage):
        error.command = again if isinstance(error, NotJudged) else f"{again} --force"
    elif (run.root / folder).is_dir():
        error.offer(f"make it again: {again} --force")
    elif has_task or error.maker != "select_place":
        error.command = again
