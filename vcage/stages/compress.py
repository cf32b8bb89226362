"""Stage 8: compress the accepted episodes' videos as far as nobody sees it (paper, section III-D)."""

from __future__ import annotations

import shutil
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from tyro.conf import OmitArgPrefixes, arg

from vcage.base.errors import MissingStage
from vcage.base.files import RunFolder
from vcage.base.options import POSITIVE, UNSAID
from vcage.base.progress import Progress, silent
from vcage.datasets.packing.clips import Clip
from vcage.datasets.packing.dataset_search import search_data_set
from vcage.datasets.packing.records import compression_record
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.recordings.opening import open_hdf5
from vcage.schema.base import Provenance
from vcage.schema.compression import Compression
from vcage.schema.episodes import Episode, Episodes
from vcage.stages.context import StageContext
from vcage.stages.stage import Job, StageOptions, StageResult, stage_seed

WORKING = "compress.working"
"""Folder of the run in which videos gather; an interrupted stage goes on there."""


def accepted_episodes(run: RunFolder) -> list[Episode]:
    """The accepted episodes that have a file; none when nothing was collected yet."""
    if not run.episodes.exists():
        return []
    return [e for e in Episodes.read(run.episodes).episodes if e.accepted and e.file is not None]


@dataclass(frozen=True, kw_only=True)
class Options(StageOptions):
    """How the videos are compressed."""

    compression: Annotated[CompressionSettings, OmitArgPrefixes, arg(name="encoding and judging")] = field(
        default_factory=CompressionSettings
    )
    """how videos are encoded and judged"""
    workers: Annotated[int | None, POSITIVE, UNSAID] = None
    """processes that compress (default: as many as cores and memory allow)"""


def job(run: RunFolder, options: Options, _context: StageContext) -> Job:
    """What the stage has to do."""
    return Job(
        run=run,
        output=run.compression,
        inputs=[run.episodes, *(run.root / str(e.file) for e in accepted_episodes(run))],
        seed=stage_seed(run, options.seed),
        options=options.compression.options(),
    )


def summary(record: Compression) -> dict[str, Any]:
    """A few facts for whoever ran the stage."""
    return {
        "crf": {camera.camera: camera.crf for camera in record.cameras},
        "lossless": [camera.camera for camera in record.cameras if camera.lossless],
        "loss_max": max(camera.loss_max for camera in record.cameras),
        "held_out_max": max((c.held_out_max for c in record.cameras if c.held_out_max is not None), default=None),
        "bytes": sum(stream.bytes for stream in record.streams),
        "reduction_raw": record.reduction_raw,
        "reduction_jpeg": record.reduction_jpeg,
    }


def execute(
    run: RunFolder, options: Options, context: StageContext, progress: Progress = silent
) -> StageResult[Compression]:
    """Write ``compress/``: an MP4 per episode and camera, and ``compression.json``.

    Raises:
        MissingStage, StaleStage: see :class:`vcage.stages.stage.Job`; also when no episode was accepted.
        DamagedFile, SchemaMismatch: an episode cannot be read.
        MissingDependency: ColorVideoVDP or the encoder is missing.
    """
    stage = job(run, options, context)

    def make(folder: Path, provenance: Provenance) -> Compression:
        clips, files = clips_of(run)
        videos = search_data_set(
            clips, options.compression, run.root / WORKING, workers=options.workers, progress=progress
        )
        streams = []
        for (name, _), video in videos.items():
            stream = video.stream
            shutil.copyfile(video.file, folder / stream.file)
            streams.append(stream.model_copy(update={"episode": files[name], "file": stage.inside(stream.file)}))
        return compression_record(provenance, options.compression, streams)

    result = stage.do(Compression, make, force=options.force)
    shutil.rmtree(run.root / WORKING, ignore_errors=True)  # not before the stage is whole: a search takes long
    return result


def clips_of(run: RunFolder) -> tuple[list[Clip], dict[str, str]]:
    """Every camera of every accepted episode, and name of the episode → its file, relative to the run folder.

    Raises:
        MissingStage: none was accepted.
        DamagedFile: an episode cannot be read.
    """
    files = {Path(str(episode.file)).stem: str(episode.file) for episode in accepted_episodes(run)}
    if not files:
        raise MissingStage(f"{run.episodes} holds no accepted episode", hint="collect more: run collect --episodes N")
    clips = []
    for name, file in files.items():
        recording = open_hdf5(run.root / file)
        clips += [Clip(name, recording, camera.name, float(recording.fps or 0)) for camera in recording.cameras]
    return clips, files
