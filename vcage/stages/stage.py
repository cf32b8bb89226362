"""What every stage does around its work: skip what is finished, refuse what is stale, write all or nothing.

A finished stage is known by its provenance: producer, version, seed, options, content hashes of its inputs.
The same provenance again means nothing to do; another one means :class:`StaleStage` unless ``force`` is given,
so that nothing of an earlier run is lost by accident.
"""

from __future__ import annotations

import contextlib
import logging
import time
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Generic, Protocol, TypeVar

import numpy as np

from vcage.base.errors import InputFileError, MissingStage, OutputFolderError, StaleStage
from vcage.base.files import RunFolder, atomic_folder, read_json, recover, sha256_file, write_json
from vcage.base.keeper import Keeper
from vcage.base.options import NATURAL, UNSAID, Flag, choice
from vcage.base.progress import Progress, silent
from vcage.models.registry import CHOICES
from vcage.schema.base import Provenance, StageDocument
from vcage.schema.scene import Scene
from vcage.stages.context import StageContext

logger = logging.getLogger(__name__)

D = TypeVar("D", bound=StageDocument)

PRODUCERS = {
    "place": "select_place",
    "inpaint": "inpaint_plan",
    "match": "match",
    "optimize": "optimize",
    "subtasks": "search_subtasks",
    "episodes": "collect",
    "verify": "verify",
    "compress": "compress",
    "export": "export",
}
"""Folder of the run → the stage that writes it, in the order of the chain."""


@dataclass(frozen=True, kw_only=True)
class StageOptions:
    """Options of every stage. The docstrings of the fields are the help of ``vcage STAGE``."""

    seed: Annotated[int | None, NATURAL, UNSAID] = None
    """of every random choice (default: the run's, or 0)"""
    force: Flag = False
    """make a finished stage again"""

    def context(self) -> StageContext:
        """What the stage needs beyond its files, with the models that these options choose."""
        return StageContext()


@dataclass(frozen=True, kw_only=True)
class ModelOptions(StageOptions):
    """Options of a stage that asks models."""

    models: Annotated[str, choice(CHOICES), UNSAID] = "auto"
    """which models answer (default: auto, that is gemini or openai with a key, else offline)"""

    def context(self) -> StageContext:
        return StageContext(self.models)


@dataclass(frozen=True)
class StageResult(Generic[D]):
    """A stage's record, where it lies, and whether it was made just now."""

    record: D
    path: Path
    fresh: bool


@dataclass(frozen=True)
class Job:
    """One stage to be done.

    Args:
        run: the run folder.
        output: the JSON that the stage writes; its folder belongs to the stage alone.
        inputs: the files that it reads, all in the run folder.
        seed: of every random choice of the stage.
        options: what changes its result, JSON-serialisable.
        providers: model role → provider.
    """

    run: RunFolder
    output: Path
    inputs: Sequence[Path] = ()
    seed: int = 0
    options: dict[str, Any] = field(default_factory=dict)
    providers: dict[str, str] = field(default_factory=dict)

    @property
    def stage(self) -> str:
        return PRODUCERS[self.output.parent.name]

    def rng(self) -> np.random.Generator:
        """The stage's own stream of random numbers, a function of seed and stage alone."""
        return np.random.default_rng([self.seed, zlib.crc32(self.stage.encode())])

    def provenance(self) -> Provenance:
        """What the output will say of its origin.

        Raises:
            MissingStage: an input is not there; names the stage that writes it.
        """
        hashes = {}
        for path in self.inputs:
            if not path.is_file():
                stage = PRODUCERS.get(path.parent.name, "the stage before")
                raise MissingStage(
                    f"{self.stage} needs {path}, which does not exist",
                    hint=f"run {stage} first on the same run folder",
                    details={"missing": str(path), "stage": stage},
                )
            hashes[self.run.relative(path)] = sha256_file(path)
        return Provenance(
            producer=self.stage, seed=self.seed, options=self.options, inputs=hashes, providers=self.providers
        )

    def finished(self, document: type[D], *, force: bool) -> StageResult[D] | None:
        """The result of an earlier run with the same provenance, or None when there is work to do.

        Raises:
            StaleStage: the stage is finished, but from other inputs or options, and ``force`` is not set.
            InputFileError: what it left cannot be read, and ``force`` is not set.
            OutputFolderError: its folder holds files, but no stage made it, and ``force`` is not set.
        """
        recover(self.output.parent)
        if force:
            return None
        keeper = Keeper(self.output, document, self.provenance())
        try:
            record = keeper.found()
        except MissingStage:
            self._refuse_foreign_files()
            return None
        except InputFileError as error:
            error.hint = "run the same command with --force to make it again"
            raise
        if keeper.knows(record):
            return StageResult(record, self.output, fresh=False)
        changed = differences(record.provenance, keeper.made_from)
        raise StaleStage(
            f"{self.output} is finished, but was made with another {', '.join(changed)}",
            hint="add --force to replace it, or give another run folder",
            details={"changed": changed},
        )

    def _refuse_foreign_files(self) -> None:
        folder = self.output.parent
        if not folder.exists() or (folder.is_dir() and not any(folder.iterdir())):
            return
        raise OutputFolderError(
            f"{folder} is in the way: {self.stage} would replace it, and did not make it",
            hint="give another run folder, move it away, or add --force to replace it",
        )

    def do(self, document: type[D], make: Callable[[Path, Provenance], D], *, force: bool = False) -> StageResult[D]:
        """Run ``make(folder, provenance)`` unless the stage is finished; its folder appears whole or not at all."""
        provenance = self.provenance()
        done = self.finished(document, force=force)
        if done is not None:
            logger.info("%s: finished before, nothing to do", self.stage)
            return done
        begun = self.run.root.exists()
        self.run.make()
        try:
            with atomic_folder(self.output.parent) as folder:
                record = make(folder, provenance)
                record.write(folder / self.output.name)
        finally:
            if not begun:
                with contextlib.suppress(OSError):  # not empty: the stage is done
                    self.run.root.rmdir()
        return StageResult(record, self.output, fresh=True)

    def inside(self, name: str) -> str:
        """The path, relative to the run folder, that a file of the stage's folder will have."""
        return f"{self.output.parent.name}/{name}"


class Stage(Protocol):
    """What a module of a stage offers."""

    __name__: str

    @property
    def Options(self) -> type[Any]: ...

    def job(self, run: RunFolder, options: Any, context: StageContext, /) -> Job:
        """What the stage has to do."""
        ...

    def execute(self, run: RunFolder, options: Any, context: StageContext, progress: Progress, /) -> StageResult[Any]:
        """Do it, unless it is done."""
        ...

    def summary(self, record: Any, /) -> dict[str, Any]:
        """A few facts for whoever ran the stage."""
        ...


def differences(before: Provenance, now: Provenance) -> list[str]:
    """What differs between two provenances, in words: 'seed', 'option episodes', 'input place/scene.json'…"""
    changed = [name for name in ("producer", "version", "seed") if getattr(before, name) != getattr(now, name)]
    for what, old, new in (
        ("option", before.options, now.options),
        ("input", before.inputs, now.inputs),
        ("provider of the", before.providers, now.providers),
    ):
        changed += [f"{what} {key}" for key in sorted(old.keys() | new.keys()) if old.get(key) != new.get(key)]
    return changed


def stage_seed(run: RunFolder, seed: int | None) -> int:
    """The seed of a later stage: the one asked for, or that of the run's first scene.

    That is ``place/scene.json``, or ``optimize/scene.json`` where a single sub-task began the run.

    Raises:
        MissingStage: the run has not begun.
        DamagedFile, SchemaMismatch: the scene is unreadable.
    """
    if seed is not None:
        return seed
    scenes = [path for path in (run.scene, run.layout) if path.exists()]
    if not scenes:
        raise MissingStage(
            f"{run} holds no run: {run.scene} does not exist",
            hint="run select_place first, or check the folder",
            details={"missing": str(run.scene), "stage": "select_place"},
        )
    return Scene.read(scenes[0]).provenance.seed


# --- how long stages took: apart from their own files, which are the same for the same seed ---------------


@contextlib.contextmanager
def timed(run: RunFolder, stage: str) -> Iterator[None]:
    """Note the wall time of the block in ``timings.json``, beside those of the other stages.

    Nothing is noted when the block fails or takes less than a tenth of a second (the stage was finished before).
    """
    start = time.perf_counter()
    yield
    seconds = time.perf_counter() - start
    if seconds > 0.1 and run.root.is_dir():
        recover(run.timings)
        write_json(run.timings, {**read_timings(run), stage: round(seconds, 2)})


def read_timings(run: RunFolder) -> dict[str, float]:
    """Seconds by stage; empty when nothing was timed or the file is damaged (it is a by-product)."""
    try:
        timings = read_json(run.timings)
    except InputFileError:
        return {}
    return timings if isinstance(timings, dict) else {}


def run_stage(
    stage: Stage,
    run: RunFolder,
    options: StageOptions | None = None,
    context: StageContext | None = None,
    progress: Progress = silent,
) -> StageResult[Any]:
    """Run one stage, unless it is finished, and note how long it took.

    Example:
        >>> from vcage.stages import match
        >>> run_stage(match, RunFolder("runs/blocks"), match.Options(threshold=0.7, force=True))

    Args:
        stage: a module of :mod:`vcage.stages`.
        run: the run folder, with what the stages before it wrote.
        options: the stage's ``Options``; None for the defaults.
        context: what stages share; None for what the options choose.
        progress: told of every step.

    Raises:
        VcageError: what the stage raises.
    """
    options = options or stage.Options()
    name = stage.__name__.rpartition(".")[2]
    with timed(run, name):
        return stage.execute(run, options, context or options.context(), progress)
