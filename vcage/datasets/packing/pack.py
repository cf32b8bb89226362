"""Compression of any recordings: find, check, search, and write the whole."""

from __future__ import annotations

import logging
import os
import shutil
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from itertools import chain
from pathlib import Path
from typing import Any, TypeVar

from vcage.base.errors import DamagedFile, FolderInUse, InputFileError, OutputFolderError, StaleStage
from vcage.base.files import RunFolder, atomic_folder
from vcage.base.folders import is_empty_folder, real_path
from vcage.base.hold import held
from vcage.base.keeper import Keeper
from vcage.base.leftovers import recover
from vcage.base.progress import Progress, silent
from vcage.base.text import listed
from vcage.datasets.packing.clips import Clip
from vcage.datasets.packing.dataset_search import require_tools, search_data_set
from vcage.datasets.packing.inspecting import FRAMES, write_frames
from vcage.datasets.packing.output import (
    OutputSpec,
    keeps_version,
    left_out,
    other_streams,
    output_notes,
    require_alike,
    resolve_output,
)
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.packing.sources import Sources, find_sources, require_apart
from vcage.datasets.packing.writing import Compressed, compression_record, write_output
from vcage.datasets.recordings.colours import AUTO, colour_orders
from vcage.schema.base import Provenance
from vcage.schema.compression import Compression

logger = logging.getLogger(__name__)

T = TypeVar("T")

FOLDER = "."
"""Key of the notes on files of the input that are not read."""

RECORD = "compression.json"
WORKING = ".compressing"
"""Ends the name of the folder beside the output in which videos gather; the work is taken up there."""


@dataclass(frozen=True)
class Order:
    """A request to compress recordings.

    Example:
        >>> Order(Path("robotwin"), Path("small"), CompressionSettings())

    Args:
        root: the recordings: a file or a folder; only read.
        out: the folder to write.
        settings: of the encoding and its judge.
        wanted: the output.
        cameras: names of those to be kept; empty for all.
        skip_damaged: leave out damaged recordings instead of refusing all.
        colours: see :func:`vcage.datasets.recordings.opening.open_all`.
    """

    root: Path
    out: Path
    settings: CompressionSettings
    wanted: OutputSpec = field(default_factory=OutputSpec)
    cameras: tuple[str, ...] = ()
    skip_damaged: bool = False
    colours: str = AUTO


@dataclass(frozen=True)
class Prepared:
    """An order that can be executed, as far as is known without decoding.

    Args:
        order: the order.
        sources: its recordings.
        output: the kind of output.
    """

    order: Order
    sources: Sources
    output: OutputSpec

    def without_damaged(self, work: Callable[[Prepared], T]) -> tuple[Prepared, T]:
        """Do some work on the recordings, and return the result and the recordings that it took.

        Recordings found damaged during the work are left out if the order allows it, and the work is repeated.

        Raises:
            DamagedFile: the order does not allow it, or none is left.
            UsageError: the other recordings cannot be written as requested.
        """
        prepared = self
        while True:
            try:
                prepared = replace(prepared, output=resolve_output(self.order.wanted, prepared.sources.sources))
                return prepared, work(prepared)
            except DamagedFile as error:
                sources = prepared.sources
                if not self.order.skip_damaged or "recording" not in error.details:
                    more = "; or go on without it: --skip-damaged" if len(sources.sources) > 1 else ""
                    raise DamagedFile(error.message, hint=error.hint + more, details=error.details) from error
                prepared = replace(prepared, sources=sources.without(error.details["recording"], error.message))

    def clips(self) -> list[Clip]:
        """Return the clips of the recordings that are written."""
        return self.sources.clips(self.order.cameras, self.output.fps, commanded=self.output.lerobot)

    def provenance(self) -> Provenance:
        """Return options and hashes of the recordings."""
        chosen = {"cameras": list(self.order.cameras), "colours": self.order.colours}
        options = {**self.order.settings.options(), **asdict(self.output), **chosen}
        return Provenance(producer="compress", seed=0, options=options, inputs=self.sources.hashes())

    def facts(self) -> dict[str, Any]:
        """Return the fields of :class:`Compression` on the recordings."""
        sources = self.sources.sources
        return {
            "notes": self.notes(),
            "colours": colour_orders(source.recording.colours for source in sources),
            "other_streams": other_streams(sources, self.output),
            "left_out": left_out(sources, self.output),
            "failed": self.sources.failures(),
        }

    def notes(self) -> dict[str, list[str]]:
        """Return recording → notes for the user; also on recordings left out as damaged, and files beside them."""
        sources, written = self.sources, output_notes(self.sources.sources, self.output)
        notes = {source.name: [*source.notes, *written[source.name]] for source in sources.sources}
        for name, cameras in sources.missing_cameras().items():
            notes[name].append(f"it lacks {', '.join(cameras)}, which others have")
        notes |= {name: [f"left out: {text}"] for name, text in sources.damaged.items()}
        notes[FOLDER] = [f"{name} is not read: {what}" for name, what in sources.passed_over.items()]
        return {name: texts for name, texts in notes.items() if texts}


@dataclass(frozen=True)
class Packed:
    """The written record, its path, and if it was made just now."""

    record: Compression
    path: Path
    fresh: bool


def prepare(order: Order) -> Prepared:
    """Check an order before any work.

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
    prepared, clips = Prepared(order, sources, order.wanted).without_damaged(Prepared.clips)
    require_alike(clips, prepared.output)
    return prepared


def pack(order: Order, *, workers: int | None = None, force: bool = False, progress: Progress = silent) -> Packed:
    """Compress recordings into a new folder, which appears whole or not at all.

    Videos gather in a folder beside it. After an interruption they stay there, and the same call resumes.

    Example:
        >>> pack(Order(Path("robotwin"), Path("small"), CompressionSettings(max_loss=0.05))).record.reduction_stored

    Args:
        order: of the work.
        workers: largest number of processes; None for as many as cores and memory allow.
        force: replace an output of other settings or inputs.
        progress: called for every step.

    Raises:
        InputFileError, UsageError, UnknownName, MissingDependency: see :func:`prepare`.
        StaleStage: the output is there, made from other recordings or with other settings, and ``force`` is not set.
        FolderInUse: another process writes it.
        OutputFolderError: the output is in the way, lies in the input, or cannot be written.
        DiskFull: see :mod:`vcage.base.files`; finished work is kept beside the output.
    """
    out = real_path(order.out)
    prepared = prepare(order)
    provenance = prepared.provenance()
    working = out.with_name(out.name + WORKING)
    recover(out)
    done = _finished(out, provenance, force=force)
    if done is not None:
        _clear(working)
        return done
    RunFolder(working).make()
    with held(working):
        written, videos = prepared.without_damaged(
            lambda left: search_data_set(
                left.clips(), order.settings, working / "videos", workers=workers, progress=progress
            )
        )
        streams = [video.stream for video in videos.values()]
        record = compression_record(provenance, order.settings, streams, **written.facts())
        whole = working / "whole"
        shutil.rmtree(whole, ignore_errors=True)
        sources = written.sources.sources
        write_output(Compressed(sources, videos, record.encoding.preset), written.output, whole, progress)
        write_frames(whole / FRAMES, [source.recording for source in sources])
        record.write(whole / RECORD)
        _move(whole, out)
        shutil.rmtree(working)
    _log_notes(record, kept=not written.sources.failed)
    return Packed(record, out / RECORD, fresh=True)


def _move(whole: Path, out: Path) -> None:
    """Move the content of a folder to the output, which appears with all of it."""
    with atomic_folder(out) as folder:
        for child in whole.iterdir():
            os.replace(child, folder / child.name)


def _clear(working: Path) -> None:
    """Remove the leftovers of a call that ended after the output appeared, unless another one works there."""
    if working.exists():
        with suppress(FolderInUse), held(working):
            shutil.rmtree(working)


def _finished(out: Path, provenance: Provenance, *, force: bool) -> Packed | None:
    """Return the output of an earlier call with the same provenance, or None when there is work to do."""
    if not out.exists() or is_empty_folder(out):
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


def _log_notes(record: Compression, *, kept: bool) -> None:
    """Log each note once, with its number of recordings, and the omissions of a LeRobot data set."""
    own = [texts for name, texts in record.notes.items() if name != FOLDER]
    for text, count in Counter(chain.from_iterable(own)).items():
        logger.warning("%s%s", text, f" ({count} of {len(own)} recordings)" if len(own) > 1 else "")
    for text in record.notes.get(FOLDER, ()):
        logger.warning("%s", text)
    if record.left_out:
        logger.warning("not in the data set, with the reasons in %s: %s", RECORD, listed(record.left_out))
    if record.failed:
        what = "stay as they are" if kept else "are left out"
        logger.warning("failed demonstrations %s (%d): %s", what, len(record.failed), listed(record.failed))
