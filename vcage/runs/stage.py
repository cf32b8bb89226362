"""The frame of every stage: skip finished work, refuse stale work, write all files or none.

A finished stage is known by its provenance: producer, version, seed, options, content hashes of its inputs.
The same provenance again means nothing to do; another one means :class:`StaleStage` unless ``force`` is given,
so that nothing of an earlier run is lost by accident.
"""

from __future__ import annotations

import logging
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Generic, TypeVar

import numpy as np
from tyro.conf import arg

from vcage.base.errors import InputFileError, MissingStage, OutputFolderError, StaleStage, VcageError
from vcage.base.files import PRODUCERS, RunFolder, atomic_folder, sha256_file, stage_of_file
from vcage.base.keeper import Keeper
from vcage.base.leftovers import recover
from vcage.base.options import FOLDER, NATURAL, POSITIVE, UNSAID, Flag, between, choice
from vcage.models.registry import CHOICES, OFFLINE, Choice
from vcage.models.spending import Cap
from vcage.runs.context import StageContext
from vcage.runs.edits import edited_scripts, lost, seal
from vcage.schema.base import Provenance, StageDocument
from vcage.schema.exchange import Asked
from vcage.schema.scene import Scene

logger = logging.getLogger(__name__)

D = TypeVar("D", bound=StageDocument)

ASKS: dict[str, tuple[Asked, ...]] = {
    "select_place": ("reasoner",),
    "inpaint_plan": ("reasoner", "editor"),
    "search_subtasks": ("reasoner",),
    "collect": ("critic",),
    "verify": ("critic",),
}
"""Stage → the roles that it asks; the others ask nobody."""

MAX_VALUE_CHARACTERS = 40
"""Characters at most of an option's value that a message quotes."""


@dataclass(frozen=True, kw_only=True)
class StageOptions:
    """Options of every stage. The docstrings of the fields are the help of ``vcage STAGE``."""

    seed: Annotated[int | None, NATURAL, UNSAID] = None
    """of every random choice (default: the run's, or 0)"""
    force: Flag = False
    """make a finished stage again"""

    def context(self, run: RunFolder) -> StageContext:
        """Return the context of the stage, with the models that these options choose."""
        return StageContext(Choice(run=run.root))


PROVIDER = arg(metavar="WHO", help_behavior_hint="")
"""The metavar of options whose choices are spelled out at --models."""


@dataclass(frozen=True, kw_only=True)
class ModelOptions(StageOptions):
    """Options of a stage that asks models."""

    models: Annotated[str, choice(CHOICES), UNSAID] = "auto"
    """who answers (default: auto, that is the first provider with a key, else Ollama where it answers, else offline:
    rules without a network)"""
    reasoner: Annotated[str | None, choice(CHOICES), PROVIDER] = None
    """who selects, reads goals, plans and judges pairs, of the same choices"""
    editor: Annotated[str | None, choice(CHOICES), PROVIDER] = None
    """who draws the target picture"""
    critic: Annotated[str | None, choice(CHOICES), PROVIDER] = None
    """who verifies"""
    replay: Annotated[Path | None, FOLDER, UNSAID] = None
    """the run whose exchanges --models replay reads (default: this one)"""
    fallback: Annotated[str | None, choice((OFFLINE,)), UNSAID] = None
    """who plays a role whose endpoint does not serve its model (default: nobody, that is an error)"""
    review: Annotated[bool, UNSAID] = True
    """let the model that read the instruction check its goals, in plain words, with one question more"""
    votes: Annotated[int, POSITIVE] = 1
    """how often a critic that is a model is asked; more than half must say yes"""
    most_calls: Annotated[int, POSITIVE] = 2000
    """largest number of answers from online models in a run"""
    most_usd: Annotated[float | None, between(0, 1e6, "USD"), UNSAID] = None
    """largest cost of these, US dollars (default: no limit)"""

    def who(self, run: RunFolder) -> Choice:
        """Return the choice of who plays which role."""
        return Choice(
            self.models,
            self.reasoner,
            self.editor,
            self.critic,
            run=run.root,
            replayed=self.replay,
            anew=self.force,
            fallback=self.fallback,
            review=self.review,
            votes=self.votes,
            cap=Cap(self.most_calls, self.most_usd),
        )

    def context(self, run: RunFolder) -> StageContext:
        return StageContext(self.who(run))


@dataclass(frozen=True)
class StageResult(Generic[D]):
    """The result of a stage.

    Args:
        record: its JSON.
        path: of the JSON.
        fresh: True if it was made just now.
        grown: True if this call added to the work of an earlier one.
        short: the error to end with where the result is whole, but less than was asked for.
        notes: sentences for a person about this call.
    """

    record: D
    path: Path
    fresh: bool
    grown: bool = False
    short: VcageError | None = None
    notes: Sequence[str] = ()


@dataclass(frozen=True)
class Job:
    """The work of one stage.

    Args:
        run: the run folder.
        output: the JSON that the stage writes; its folder belongs to the stage alone.
        inputs: the files that it reads, all in the run folder.
        seed: of every random choice of the stage.
        options: those that change the result, JSON-serialisable.
        providers: model role → provider.
        stand_for: SHA-256 of inputs since stored in another way, with the same content → the earlier one.
    """

    run: RunFolder
    output: Path
    inputs: Sequence[Path] = ()
    seed: int = 0
    options: dict[str, Any] = field(default_factory=dict)
    providers: dict[str, str] = field(default_factory=dict)
    stand_for: Mapping[str, str] = field(default_factory=dict)

    @property
    def stage(self) -> str:
        return PRODUCERS[self.output.parent.name]

    def rng(self) -> np.random.Generator:
        """Return the stage's own random numbers, which depend on seed and stage alone."""
        return np.random.default_rng([self.seed, zlib.crc32(self.stage.encode())])

    def provenance(self) -> Provenance:
        """Return the provenance of the output.

        Raises:
            MissingStage: an input is missing; names the stage that writes it.
        """
        hashes = {}
        for path in self.inputs:
            if not path.is_file():
                stage = PRODUCERS.get(path.parent.name, "the stage before")
                raise MissingStage(
                    f"{self.stage} needs {path}, which does not exist",
                    hint=f"run {stage} first on the same run folder",
                    maker=stage_of_file(path),
                    details={"missing": str(path), "stage": stage},
                )
            digest = sha256_file(path)
            hashes[self.run.relative(path)] = self.stand_for.get(digest, digest)
        return Provenance(
            producer=self.stage, seed=self.seed, options=self.options, inputs=hashes, providers=self.providers
        )

    def finished(self, document: type[D], *, force: bool) -> StageResult[D] | None:
        """Return the result of an earlier call with the same provenance; None if there is none, or it lost a file.

        Raises:
            StaleStage: the stage is finished, but from other inputs or options, and ``force`` is not set.
            InputFileError: its output cannot be read, or lacks a file and making it again would lose episodes or an
                edit, and ``force`` is not set.
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
            error.maker = error.maker or self.stage
            raise
        edited = [*record.edited, *edited_scripts(self.output)]
        if gone := lost(self.output):
            if edited or self.stage == "collect":
                raise InputFileError(
                    f"{self.output.parent / gone[0]} is gone, which {self.stage} had written",
                    hint="put it back",
                    maker=self.stage,
                    details={"missing": gone, "edited": edited},
                )
            logger.warning("%s: made again, as %s is gone", self.stage, ", ".join(gone))
            return None
        if keeper.knows(record):
            return StageResult(record, self.output, fresh=False)
        changed = differences(record.provenance, keeper.made_from)
        named = (_with_values(one, record.provenance, keeper.made_from) for one in changed)
        raise StaleStage(
            f"{self.output} is finished, but was made with another {', '.join(named)}",
            hint=f"{_way_back(changed)}, or give another run folder",
            details={"changed": changed, "edited": edited},
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
        self.run.make()
        with atomic_folder(self.output.parent) as folder:
            path = folder / self.output.name
            record = seal(make(folder, provenance), path)
        return StageResult(record, self.output, fresh=True)

    def inside(self, name: str) -> str:
        """Return the path, relative to the run folder, of a file in the stage's folder."""
        return f"{self.output.parent.name}/{name}"


def differences(before: Provenance, now: Provenance) -> list[str]:
    """Name the differences of two provenances: 'seed', 'option episodes', 'input place/scene.json'…"""
    changed = [name for name in ("producer", "version", "seed") if getattr(before, name) != getattr(now, name)]
    for what, old, new in (
        ("option", before.options, now.options),
        ("input", before.inputs, now.inputs),
        ("provider of the", before.providers, now.providers),
    ):
        changed += [f"{what} {key}" for key in sorted(old.keys() | new.keys()) if old.get(key) != new.get(key)]
    return changed


def _with_values(difference: str, before: Provenance, now: Provenance) -> str:
    """One of the :func:`differences`, an input that is gone as such, a plain option with both values."""
    if (path := difference.removeprefix("input ")) != difference and path not in now.inputs:
        return f"{difference}, which is gone"
    values = [provenance.options.get(difference.removeprefix("option ")) for provenance in (before, now)]
    plain = all(isinstance(value, str | int | float) and len(str(value)) <= MAX_VALUE_CHARACTERS for value in values)
    return f"{difference} ({values[0]} before, {values[1]} now)" if plain else difference


def _way_back(changed: Sequence[str]) -> str:
    """The way back to what a finished stage was made from."""
    if all(difference.startswith("input ") for difference in changed):
        return "put back what changed"
    return "give the same options as before"


def stage_seed(run: RunFolder, seed: int | None) -> int:
    """Return the seed of a later stage: the requested one, or that of the run's first scene.

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
            maker="select_place",
            details={"missing": str(run.scene), "stage": "select_place"},
        )
    return Scene.read(scenes[0]).provenance.seed
