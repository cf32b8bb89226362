"""Stage 8: compress the accepted episodes' videos as far as nobody sees it (paper, section III-D)."""

from __future__ import annotations

import shutil
from collections.abc import Collection
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Annotated, Any

from tyro.conf import OmitArgPrefixes, arg

from vcage.base.files import RunFolder, sha256_file
from vcage.base.options import POSITIVE, UNSAID, Flag
from vcage.base.progress import Progress, silent
from vcage.datasets.packing.agreement import agreed_by
from vcage.datasets.packing.clips import Clip
from vcage.datasets.packing.dataset_search import search_data_set
from vcage.datasets.packing.records import compression_record
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.recordings.opening import open_hdf5
from vcage.runs.accepted import accepted_episodes, decided_by, none_counts, withdraw
from vcage.runs.context import StageContext
from vcage.runs.edits import refuse
from vcage.runs.raw_pictures import holds_links, originals, packed_hash, refer_to_videos, require_raw
from vcage.runs.stage import Job, StageOptions, StageResult, differences, stage_seed
from vcage.schema.base import Provenance
from vcage.schema.compression import Compression, SetAside, VideoStream

WORKING = "compress.working"
"""Folder of the run in which videos gather; an interrupted stage goes on there."""


@dataclass(frozen=True, kw_only=True)
class Options(StageOptions):
    """How the videos are compressed."""

    compression: Annotated[CompressionSettings, OmitArgPrefixes, arg(name="encoding and judging")] = field(
        default_factory=CompressionSettings
    )
    """how videos are encoded and judged"""
    workers: Annotated[int | None, POSITIVE, UNSAID] = None
    """processes that compress (default: as many as cores and memory allow)"""
    keep_raw: Flag = False
    """leave raw pictures in the episodes' files, which else refer to the videos once these are verified"""


def job(run: RunFolder, options: Options, _context: StageContext) -> Job:
    """What the stage has to do."""
    return Job(
        run=run,
        output=run.compression,
        inputs=[*decided_by(run), *(run.file(str(e.file)) for e in accepted_episodes(run))],
        seed=stage_seed(run, options.seed),
        options=options.compression.options(),
        stand_for=originals(run),
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

    Unless raw pictures are to be kept, the episodes' files refer to the videos from then on, which lie beside them too.

    Raises:
        MissingStage, StaleStage: see :class:`vcage.runs.stage.Job`; also when no episode counts, and all are set
            aside then, or the raw pictures that it takes are gone.
        DamagedFile, SchemaMismatch: an episode cannot be read.
        MissingDependency: ColorVideoVDP or the encoder is missing.
    """
    stage = job(run, options, context)
    working, none = run.root / WORKING, none_counts(run)
    if none and not _made_so(run, stage.options):
        raise none

    def make(folder: Path, provenance: Provenance) -> Compression:
        aside = _set_aside(run, provenance)
        if none:
            return compression_record(provenance, options.compression, [], set_aside=aside)
        earlier = _earlier(run, provenance)
        clips, files = clips_of(run)
        videos = search_data_set(
            clips,
            options.compression,
            working,
            agreed=agreed_by(earlier),
            workers=options.workers,
            progress=progress,
        )
        found = [(video.file, files[name], video.stream) for (name, _), video in videos.items()]
        found += [(run.file(s.episode).with_name(Path(s.file).name), s.episode, s) for s in earlier]
        streams = []
        for video, episode, stream in sorted(found, key=lambda one: (one[1], one[2].camera)):
            file = Path(stream.file).name
            shutil.copyfile(video, folder / file)
            streams.append(stream.model_copy(update={"episode": episode, "file": stage.inside(file)}))
        packed = {
            file: packed_hash(run, [s for s in streams if s.episode == file], working)
            for file in dict.fromkeys(s.episode for s in streams)
        }
        return compression_record(provenance, options.compression, streams, packed=packed, set_aside=aside)

    result = stage.do(Compression, make, force=options.force or none is not None)
    if none:
        withdraw(run.export.parent)
        raise none
    if not options.keep_raw:
        refer_to_videos(run, result.record, working)
    shutil.rmtree(working, ignore_errors=True)  # not before the stage is whole: a search takes long
    return result


def take_over(run: RunFolder, folder: Path, edited: Collection[str], context: StageContext) -> Compression:
    """Nothing: the record tells what was made, and there is nothing in it to decide.

    Raises:
        InputFileError: always.
    """
    refuse(run.compression, "(any)", f"{', '.join(edited)} was changed by hand", "what compress wrote there")


def clips_of(run: RunFolder) -> tuple[list[Clip], dict[str, str]]:
    """Every camera of every accepted episode with raw pictures, and name of the episode → its file, relative to the run
    folder.

    Raises:
        DamagedFile: an episode cannot be read.
    """
    files = {Path(str(episode.file)).stem: str(episode.file) for episode in accepted_episodes(run)}
    clips = []
    for name, file in files.items():
        if not holds_links(run.file(file)):
            recording = open_hdf5(run.file(file))
            clips += [Clip(name, recording, camera.name, float(recording.fps or 0)) for camera in recording.cameras]
    return clips, files


def _earlier(run: RunFolder, provenance: Provenance) -> list[VideoStream]:
    """The videos of episodes that have no raw pictures any more, which stay as they are while others come or go.

    Raises:
        MissingStage: they would have to be made again, for it is not other episodes that are asked for.
    """
    gone = {str(e.file): run.file(str(e.file)) for e in accepted_episodes(run) if holds_links(run.file(str(e.file)))}
    if not gone:
        return []
    record = Compression.read(run.compression) if run.compression.exists() else None
    known = [*record.streams, *chain(*(one.streams for one in record.set_aside.values()))] if record else []
    streams = [stream for stream in known if stream.episode in gone]
    changed = differences(record.provenance, provenance) if record else []
    others = changed and all(what.startswith("input ") for what in changed)
    if not others or {stream.episode for stream in streams} != gone.keys():
        require_raw(gone.values())
    return streams


def _made_so(run: RunFolder, options: dict[str, Any]) -> bool:
    """Whether there is a compression with these options."""
    return run.compression.exists() and Compression.read(run.compression).provenance.options == options


def _set_aside(run: RunFolder, provenance: Provenance) -> dict[str, SetAside]:
    """What was compressed in this way and counts no more; without raw pictures, it takes its videos to count again."""
    if not _made_so(run, provenance.options):
        return {}
    record = Compression.read(run.compression)
    known = dict(record.set_aside)
    for file, packed in record.packed.items():
        streams = [stream for stream in record.streams if stream.episode == file]
        known[file] = SetAside(original=record.provenance.inputs[file], packed=packed, streams=streams)
    left = known.keys() - {str(episode.file) for episode in accepted_episodes(run)}
    there = [file for file in sorted(left) if run.file(file).is_file()]
    return {file: known[file] for file in there if sha256_file(run.file(file)) == known[file].packed}
