"""CRFs that a run takes over from another one, whose episodes are alike: it checks them, and saves the search."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

from vcage.base.errors import UsageError
from vcage.base.files import RunFolder
from vcage.datasets.packing.agreement import Bound, agreed_by
from vcage.datasets.packing.settings import CompressionSettings
from vcage.schema.compression import Compression, TakenCrf, VideoStream
from vcage.video.choices import LOSSLESS


def crfs_of(other: Path, settings: CompressionSettings) -> dict[str, Bound]:
    """Return camera → the agreement of another run's episodes; without cameras that are lossless there.

    Args:
        other: the folder of that run.
        settings: of this run.

    Raises:
        UsageError: these settings leave nothing to take over, or the other run was compressed with others.
        MissingStage: the other run was not compressed.
        DamagedFile, SchemaMismatch: its record cannot be read.
    """
    if not settings.agrees:
        raise UsageError(
            "--crf-of needs a CRF that a camera's episodes share and that is searched",
            hint="leave it out, or leave out --crf and --scope",
        )
    record = Compression.read(RunFolder(other).compression)
    found, ours = record.provenance.options, settings.options()
    if differing := [name for name in sorted(found.keys() & ours.keys()) if found[name] != ours[name]]:
        differ = ", ".join(f"{name} {found[name]}, not {ours[name]}" for name in differing)
        raise UsageError(
            f"{other} was compressed with other options: {differ}", hint="give the same options, or leave out --crf-of"
        )
    return {camera: bound for camera, bound in agreed_by(record.streams).items() if bound.crf != LOSSLESS}


def begun_at(
    run: RunFolder, other: Path | None, settings: CompressionSettings, before: Compression | None, own: Iterable[str]
) -> dict[str, TakenCrf]:
    """Return camera → the CRF that its first videos in a run begin, or began, at; without those that were searched.

    Args:
        run: the run.
        other: the folder of the run that it takes over; None for none.
        settings: of the run.
        before: its compression before episodes joined it; None at first.
        own: cameras that have videos already, by which later ones go.

    Raises:
        UsageError, InputFileError: see :func:`crfs_of`.
    """
    found = {one.camera: one for one in before.taken_crfs if one.camera in own} if before else {}
    if other is None:
        return found
    name = _seen_from(run, other)
    bounds = {camera: bound for camera, bound in crfs_of(other, settings).items() if camera not in own}
    return found | {
        camera: TakenCrf(camera=camera, run=name, passed=True, **asdict(bound)) for camera, bound in bounds.items()
    }


def began_at(record: Compression, run: RunFolder, other: Path) -> bool:
    """True if a finished compression of a run began at the CRFs of the other run."""
    return any(one.run == _seen_from(run, other) for one in record.taken_crfs)


def _seen_from(run: RunFolder, other: Path) -> str:
    """The folder of another run, seen from a run's."""
    return Path(os.path.relpath(RunFolder(other).root, run.root)).as_posix()


def bound_of(taken: TakenCrf) -> Bound:
    """Return the agreement at which the search of a camera begins."""
    return Bound(taken.pixel_format, taken.gop, taken.crf)


def judged(begun: Iterable[TakenCrf], streams: Iterable[VideoStream]) -> list[TakenCrf]:
    """Return the record of the CRFs taken over, judged by the videos; without cameras that have none."""
    videos = list(streams)
    found = []
    for one in sorted(begun, key=lambda one: one.camera):
        if own := [stream for stream in videos if stream.camera == one.camera]:
            found.append(one.model_copy(update={"passed": all(map(bound_of(one).kept_by, own))}))
    return found
