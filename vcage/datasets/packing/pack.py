"""Compress somebody's recordings: found, looked at, searched, and written as a whole."""

from __future__ import annotations

import logging
import os
import shutil
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from itertools import chain
from pathlib import Path
from typing import TypeVar

from vcage.base.errors import DamagedFile, FolderInUse, InputFileError, OutputFolderError, StaleStage
from vcage.base.files import RunFolder, atomic_folder
from vcage.base.folders import holds_nothing
from vcage.base.hold import held
from vcage.base.keeper import Keeper
from vcage.base.partial import recover
from vcage.base.progress import Progress, silent
from vcage.base.text import listed
from vcage.datasets.packing.clips import Clip
from vcage.datasets.packing.dataset_search import require_tools, search_data_set
from vcage.datasets.packing.frames import FRAMES, write_frames
from vcage.datasets.packing.output import (
    OutputSpec,
    keeps_version,
    left_out,
    other_streams,
    output_notes,
    require_alike,
    resolve_output,
)
from vcage.datasets.packing.records import compression_record
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.packing.sources import Sources, find_sources, require_apart
from vcage.datasets.packing.writing import Compressed, write_output
from vcage.datasets.recordings.colours import AUTO, colour_orders
from vcage.schema.base import Provenance
from vcage.schema.compression import Compression

logger = logging.getLogger(__name__)

T = TypeVar("T")

FOLDER = "."
"""Stands in notes for what was given, where it holds more than is read."""

RECORD = "compression.json"
WORKING = ".compressing"
"""Ends the name of the folder beside the output in which videos gather; the work is taken up there."""


@dataclass(frozen=True)
class Order:
    """What is to be done.

    Example:
        >>> Order(Path("robotwin"), Path("small"), CompressionSettings(), OutputSpec(fps=16.67))

    Args:
        root: the recordings: a file or a folder; only read.
        out: the folder to write.
        settings: how videos are encoded and judged.
        wanted: what is to be written; none suits it to the recordings.
        cameras: names of those to be kept; none for all.
        skip_damaged: leave out damaged recordings instead of refusing all.
        colours: see :func:`vcage.datasets.recordings.opening.open_all`.
    """

    root: Path
    out: Path
    settings: CompressionSettings
    wanted: OutputSpec
    cameras: tuple[str, ...] = ()
    skip_damaged: bool = False
    colours: str = AUTO


@dataclass(frozen=True)
class Prepared:
    """An order that can be carried out, as far as that is seen without decoding.

    Args:
        order: the order.
        sources: its recordings.
        output: what is written of them.
    """

    order: Order
    sources: Sources
    output: OutputSpec

    def without_damaged(self, work: Callable[[list[Clip]], T]) -> tuple[Sources, T]:
        """What some work makes of the clips of the sources, and the sources that these are of.

        Sources that only decoding shows to be damaged are left out if the order allows it, and the work is done again.

        Raises:
            DamagedFile: the order does not allow it, or none is left.
            UsageError: what is left cannot be written as is wanted.
        """
        sources = self.sources
        while True:
            try:
                return sources, work(self.clips(sources))
            except DamagedFile as error:
                if not self.order.skip_damaged or "recording" not in error.details:
                    more = "; or go on without it: --skip-damaged" if len(sources.sources) > 1 else ""
                    raise DamagedFile(error.message, hint=error.hint + more, details=error.details) from error
                sources = sources.without(error.details["recording"], error.message)
                resolve_output(self.output, sources.sources)

    def clips(self, sources: Sources) -> list[Clip]:
        """Those of the sources that are written."""
        return sources.clips(self.order.cameras, self.output.fps, commanded=self.output.lerobot)

    def provenance(self) -> Provenance:
        """Of what is made: the options, and the recordings as they are."""
        chosen = {"cameras": list(self.order.cameras), "colours": self.order.colours}
        options = {**self.order.settings.options(), **asdict(self.output), **chosen}
        return Provenance(producer="compress", seed=0, options=options, inputs=self.sources.hashes())


@dataclass(frozen=True)
class Packed:
    """What was written, where its record lies, and whether it was made just now."""

    record: Compression
    path: Path
    fresh: bool


def prepare(order: Order) -> Prepared:
    """Look at all that an order asks for, before any work.

    Raises:
        InputFileError: there is nothing to compress, or it is damaged.
        UsageError: the recordings cannot be written so, or an option is missing.
        OutputFolderError: the output lies in the input, or the other way round.
        UnknownName, MissingDependency: there is no such camera or display, or this machine lacks a tool.
    """
    require_apart(order.root, order.out)
    require_tools(order.settings)
    sources = find_sources(order.root, order.settings, skip_damaged=order.skip_damaged, colours=order.colours)
    if order.wanted.lerobot and not keeps_version(sources.sources, order.wanted):
        sources = sources.without_failed(skip_damaged=order.skip_damaged)
    sources, output = _resolved(order, sources)
    prepared = Prepared(order, sources, output)
    require_alike(prepared.clips(sources), output)
    return prepared


def _resolved(order: Order, sources: Sources) -> tuple[Sources, OutputSpec]:
    """The sources, without damaged ones if the order allows that, and what is written of them."""
    while True:
        try:
            return sources, resolve_output(order.wanted, sources.sources)
        except DamagedFile as error:
            if not order.skip_damaged:
                raise
            sources = sources.without(error.details["recording"], error.message)


def pack(order: Order, *, workers: int | None = None, force: bool = False, progress: Progress = silent) -> Packed:
    """Compress recordings into a new folder, which appears whole or not at all.

    Videos gather in a folder beside it. When the work is interrupted they stay there, and the same call goes on.

    Example:
        >>> pack(Order(Path("robotwin"), Path("small"), CompressionSettings(max_loss=0.05))).record.reduction_stored

    Args:
        order: what is to be done.
        workers: processes at most; None takes as many as there are cores and memory for.
        force: replace an output of other settings or inputs.
        progress: told of every step.

    Raises:
        InputFileError, UsageError, UnknownName, MissingDependency: see :func:`prepare`.
        StaleStage: the output is there, made from other recordings or with other settings, and ``force`` is not set.
        FolderInUse: another process writes it.
        OutputFolderError: the output is in the way, lies in the input, or cannot be written.
        DiskFull: see :mod:`vcage.base.files`; what is finished is kept beside the output.
    """
    out = order.out.expanduser().resolve()
    work = prepare(order)
    provenance = work.provenance()
    working = out.with_name(out.name + WORKING)
    recover(out)
    done = _finished(out, provenance, force=force)
    if done is not None:
        _clear(working)
        return done
    RunFolder(working).make()
    with held(working):
        sources, videos = work.without_damaged(
            lambda clips: search_data_set(clips, order.settings, working / "videos", workers=workers, progress=progress)
        )
        notes = notes_of(sources, work.output)
        streams = [video.stream for video in videos.values()]
        record = compression_record(
            provenance,
            order.settings,
            streams,
            notes,
            colour_orders(source.recording.colours for source in sources.sources),
            other_streams(sources.sources, work.output),
            left_out=left_out(sources.sources, work.output),
            failed=sources.failed or sources.failures(),
        )
        whole = working / "whole"
        shutil.rmtree(whole, ignore_errors=True)
        write_output(Compressed(sources.sources, videos, record.encoding.preset), work.output, whole, progress)
        write_frames(whole / FRAMES, [source.recording for source in sources.sources])
        record.write(whole / RECORD)
        _move(whole, out)
        shutil.rmtree(working)
    _tell(notes)
    _tell_omitted(record, kept=not sources.failed)
    return Packed(record, out / RECORD, fresh=True)


def _move(whole: Path, out: Path) -> None:
    """Give what a folder holds its place in the output, which appears with all of it."""
    with atomic_folder(out) as folder:
        for child in whole.iterdir():
            os.replace(child, folder / child.name)


def _clear(working: Path) -> None:
    """Remove what a call left that was ended after the output appeared, unless another one works there."""
    if working.exists():
        with suppress(FolderInUse), held(working):
            shutil.rmtree(working)


def _finished(out: Path, provenance: Provenance, *, force: bool) -> Packed | None:
    """The output of an earlier call with the same provenance, or None when there is work to do."""
    if not out.exists() or holds_nothing(out):
        return None
    if not out.is_dir():
        raise OutputFolderError(f"{out} is a file", hint="give another --out")
    keeper = Keeper(out / RECORD, Compression, provenance)
    try:
        record = keeper.found()
    except InputFileError as error:
        if force and (out / RECORD).exists():
            return None
        raise OutputFolderError(f"{out} is in the way: {error.message}", hint="give another --out") from error
    if keeper.knows(record):
        logger.info("compress: finished before, nothing to do")
        return Packed(record, out / RECORD, fresh=False)
    if force:
        return None
    raise StaleStage(
        f"{out} is finished, but was made from other recordings or with other options",
        hint="add --force to replace it, or give another --out",
    )


def notes_of(sources: Sources, output: OutputSpec) -> dict[str, list[str]]:
    """Recording → what a user must know of it, those that were left out as damaged too, and what lies beside them."""
    told = output_notes(sources.sources, output)
    notes = {source.name: [*source.notes, *told[source.name]] for source in sources.sources}
    for name, cameras in sources.missing_cameras().items():
        notes[name].append(f"it lacks {', '.join(cameras)}, which others have")
    notes |= {name: [f"left out: {text}"] for name, text in sources.damaged.items()}
    passed = [f"{name} is not read: {what}" for name, what in sources.passed_over.items()]
    return notes | ({FOLDER: passed} if passed else {})


def _tell(notes: Mapping[str, Sequence[str]]) -> None:
    """Say each note once, and of how many recordings it holds."""
    own = [texts for name, texts in notes.items() if name != FOLDER]
    for text, count in Counter(chain.from_iterable(own)).items():
        logger.warning("%s%s", text, f" ({count} of {len(own)} recordings)" if len(own) > 1 else "")
    for text in notes.get(FOLDER, ()):
        logger.warning("%s", text)


def _tell_omitted(record: Compression, *, kept: bool) -> None:
    """Name once what a LeRobot data set does not hold, and which demonstrations failed."""
    if record.left_out:
        logger.warning("not in the data set, with the reasons in %s: %s", RECORD, listed(record.left_out))
    if record.failed:
        what = "stay as they are" if kept else "are left out"
        logger.warning("failed demonstrations %s (%d): %s", what, len(record.failed), listed(record.failed))
