"""A sentence run whole, from its words to the verification, and what came of it."""

from __future__ import annotations

import hashlib
import logging
import shutil
import tempfile
import time
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar, Literal

from benchmarks._sentences.sources import Sentence, slug
from vcage.base.errors import VcageError
from vcage.base.files import RunFolder
from vcage.base.time_limit import TimeLimitReached, time_limit
from vcage.episodes.store import read_log
from vcage.runs.context import StageContext
from vcage.runs.running import run_stage
from vcage.schema.base import Document, Record
from vcage.schema.episodes import Accept, Attempt, Episodes
from vcage.schema.subtasks import Subtasks
from vcage.stages.chain import STAGES, ChainOptions
from vcage.tasks.setting import OnFailure

logger = logging.getLogger(__name__)

THROUGH = list(STAGES)[: list(STAGES).index("verify") + 1]
"""The stages of a run: the others judge nothing, and take longest."""

BUG = 1
"""Exit code of a command that ends with an error of our own."""

GIVEN_UP = 124
"""Exit code of a run that took too long, as of the command ``timeout``."""


class Tried(Record):
    """One attempt at a sub-task.

    ``true`` and ``accepted`` are none where the robot gave up before anyone looked.
    """

    template: str
    subtask: str
    step: int
    attempt: int
    true: bool | None
    accepted: bool | None
    stage: str
    reason: str
    truth: str

    @classmethod
    def of(cls, attempt: Attempt, template: str) -> Tried:
        """The attempt of a log, at a sub-task of a template."""
        verdict, truth = attempt.verdict, attempt.truth
        return cls(
            **attempt.model_dump(include={"subtask", "step", "attempt", "stage"}),
            template=template,
            true=truth.success if truth else None,
            accepted=verdict.accepted if verdict else None,
            reason=verdict.reason if verdict else attempt.reason,
            truth=truth.reason if truth else "",
        )

    @property
    def false_accepted(self) -> bool:
        """The critic said yes of what is not so."""
        return self.accepted is True and not self.true

    @property
    def false_refused(self) -> bool:
        """The critic said no of what is so."""
        return self.true is True and not self.accepted


def counts(tried: Sequence[Tried]) -> dict[str, int]:
    """Count attempts: those that are true, those that the critic accepted, and those in which it was wrong."""
    return {
        "attempts": len(tried),
        "true": sum(t.true is True for t in tried),
        "accepted": sum(t.accepted is True for t in tried),
        "false_accepted": sum(t.false_accepted for t in tried),
        "false_refused": sum(t.false_refused for t in tried),
    }


class Ran(Document):
    """The outcome of a sentence that was run whole.

    ``first`` is of the first episode: none where it was not played, else what the simulator's state says at its end,
    and ``first_verified`` tells if the critic said yes to every sub-task of it too.
    """

    SCHEMA: ClassVar[str] = "vcage.benchmarks.sentence/2"

    sentence: str
    source: str
    seed: int
    exit_code: int
    reason: str
    templates: list[str]
    tried: list[Tried]
    wrong_episode: str
    first: bool | None = None
    first_verified: bool = False
    seconds: float


@dataclass(frozen=True)
class Whole:
    """A sentence to be run.

    Args:
        sentence: the instruction.
        seed: of all choices.
        robot: by name; the scene's where not given.
        keep: folder below which the run folder stays, and in which a finished one is not run again.
        fps: frames per second, one of those of ``collect``.
        randomise, layout, accept, on_failure: as of ``collect``.
        goals, starts: told in place of the sentence, as of ``select-place``.
        longest_s: wall seconds after which it is given up; without it, never.
    """

    sentence: Sentence
    seed: int = 0
    robot: str | None = None
    keep: Path | None = None
    fps: Literal[5, 10, 25, 50] = ChainOptions.fps
    randomise: str = ChainOptions.randomise
    layout: Literal["varied", "fixed"] = ChainOptions.layout
    accept: Accept = ChainOptions.accept
    on_failure: OnFailure = ChainOptions.on_failure
    goals: tuple[str, ...] = ()
    starts: tuple[str, ...] = ()
    longest_s: float | None = None

    @property
    def name(self) -> str:
        """Of its folder: of the sentence, and of all that changes what comes of it."""
        what = repr((self.sentence.text, self.seed, self.options))
        return f"{slug(self.sentence.text)}-{self.seed}-{hashlib.sha256(what.encode()).hexdigest()[:8]}"

    @property
    def options(self) -> ChainOptions:
        """Those of ``vcage run SENTENCE --episodes 1 --models offline``, in one process."""
        return ChainOptions(
            instruction=None if self.goals else self.sentence.text,
            goals=self.goals,
            starts=self.starts,
            seed=self.seed,
            robot=self.robot,
            models="offline",
            episodes=1,
            fps=self.fps,
            randomise=self.randomise,
            layout=self.layout,
            accept=self.accept,
            on_failure=self.on_failure,
            workers=1,
        )


def ran(task: Whole) -> Ran:
    """Run a sentence, unless that was done and kept."""
    if task.keep is None:
        with tempfile.TemporaryDirectory() as folder:
            return _run(task, Path(folder) / "run")
    folder = task.keep / task.name
    told = folder / "sentence.json"
    if told.exists():
        return Ran.read(told)
    shutil.rmtree(folder, ignore_errors=True)  # begun, and not finished
    found = _run(task, folder / "run")
    found.write(told)
    return found


@lru_cache(maxsize=1)
def _context() -> StageContext:
    return StageContext("offline")


def _run(task: Whole, folder: Path) -> Ran:
    run, start = RunFolder(folder), time.perf_counter()
    try:
        with nullcontext() if task.longest_s is None else time_limit(task.longest_s):
            code, reason = _through_verify(task.options, run)
    except TimeLimitReached:
        code, reason = GIVEN_UP, f"given up after {task.longest_s:.0f} s"
    seconds = round(time.perf_counter() - start, 2)
    told = {"sentence": task.sentence.text, "source": task.sentence.source, "seed": task.seed}
    return Ran(**told, exit_code=code, reason=reason, seconds=seconds, **_found(run))


def _through_verify(options: ChainOptions, run: RunFolder) -> tuple[int, str]:
    """The exit code that the command would have, and the reason; nothing where all is well."""
    try:
        done = {name: run_stage(STAGES[name], run, options, _context()) for name in THROUGH}
    except VcageError as error:
        return error.exit_code, error.message
    except Exception as error:  # what the command would call a bug
        logger.exception("%s", options.instruction)
        return BUG, f"{type(error).__name__}: {error}"
    if short := done["collect"].short:
        return short.exit_code, short.message
    refused = list(done["verify"].record.refused.values())
    return 0, f"refused by verify: {refused[0]}" if refused else ""


def _found(run: RunFolder) -> dict[str, Any]:
    """Templates of the chain, all attempts, and why an accepted episode is none, as far as the run came."""
    if not run.subtasks.exists():
        return {"templates": [], "tried": [], "wrong_episode": ""}
    subtasks = Subtasks.read(run.subtasks)
    kept: dict[str, str] = {subtask.id: subtask.template for subtask in subtasks.kept}
    templates = list(dict.fromkeys(kept[name] for chain in subtasks.chains for name in chain.subtasks))
    if not run.episodes.exists():
        return {"templates": templates, "tried": [], "wrong_episode": ""}
    tried = [Tried.of(attempt, kept[attempt.subtask]) for attempt in read_log(run.episodes.parent)]
    return {"templates": templates, "tried": tried, "wrong_episode": _wrong_episode(run), **_first(run)}


def _first(run: RunFolder) -> dict[str, bool]:
    """How the first episode ended."""
    first = min(Episodes.read(run.episodes).episodes, key=lambda episode: episode.index)
    success = first.goals_hold is not None and first.goals_hold.success
    return {"first": success, "first_verified": success and all(verdict.accepted for verdict in first.verdicts)}


def _wrong_episode(run: RunFolder) -> str:
    """Why the first accepted episode at whose end not all goals hold is none; empty where there is none such."""
    accepted = [e for e in Episodes.read(run.episodes).episodes if e.accepted]
    wrong = (e.goals_hold.reason for e in accepted if e.goals_hold and not e.goals_hold.success)
    return next(wrong, "")
