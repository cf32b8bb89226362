"""Stage 9: the accepted episodes as data sets that others read: LeRobot v2.1, v3.0 and v3.1, and RoboTwin's HDF5.

LeRobot gets the compressed videos as they are; another codec is encoded from the episodes' own pictures.
"""

from __future__ import annotations

import shutil
from collections.abc import Collection, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated, Any

from vcage.base.errors import MissingStage, UsageError
from vcage.base.files import RunFolder
from vcage.base.options import POSITIVE, UNSAID, choice, several
from vcage.base.progress import Progress, silent
from vcage.base.workers import cores
from vcage.datasets.lerobot.episode import LeRobotEpisode
from vcage.datasets.lerobot.features import encodings
from vcage.datasets.lerobot.formats import FORMATS, open_writer
from vcage.datasets.packing.dataset_search import search_data_set
from vcage.datasets.packing.output import OutputSpec
from vcage.datasets.packing.settings import AUTO, CRF, CompressionSettings
from vcage.datasets.packing.writing import lerobot_episode
from vcage.datasets.reader import EpisodeReader
from vcage.datasets.recordings.opening import open_hdf5
from vcage.datasets.robotwin import export_robotwin
from vcage.runs.accepted import accepted_episodes, decided_by, none_counts, withdraw
from vcage.runs.context import StageContext
from vcage.runs.edits import refuse
from vcage.runs.raw_pictures import originals, require_raw
from vcage.runs.stage import Job, StageOptions, StageResult, stage_seed
from vcage.schema.base import Provenance
from vcage.schema.compression import Compression
from vcage.schema.export import Export, ExportedDataset
from vcage.stages.compress import clips_of
from vcage.video.choices import LOSSLESS
from vcage.video.encoders import CODECS

ROBOTWIN = "robotwin"

EXPORTS = (*FORMATS, ROBOTWIN)
"""Formats that the stage writes."""

WORKING = "export.working"
"""Folder of the run in which videos of another codec gather; an interrupted stage goes on there."""


@dataclass(frozen=True)
class Footage:
    """The videos of a run's episodes.

    Args:
        files: (episode file, camera) → video.
        facts: camera → what ``info.json`` says of its encoding beyond the stream itself.
    """

    files: Mapping[tuple[str, str], Path]
    facts: Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True, kw_only=True)
class Options(StageOptions):
    """What is written."""

    formats: Annotated[tuple[str, ...], several("{" + ",".join(EXPORTS) + "} ...", choices=EXPORTS)] = tuple(FORMATS)
    """what to write"""
    codec: Annotated[str | None, choice(tuple(CODECS)), UNSAID] = None
    """of LeRobot's videos (default: as compressed)"""
    crf: Annotated[int | None, CRF, UNSAID] = None
    """of LeRobot's videos, instead of the one searched; or 'lossless'"""
    workers: Annotated[int | None, POSITIVE, UNSAID] = None
    """processes that encode (default: as cores and memory allow)"""


def job(run: RunFolder, options: Options, _context: StageContext) -> Job:
    """What the stage has to do."""
    videos = []
    if run.compression.exists():
        videos = [run.file(stream.file) for stream in Compression.read(run.compression).streams]
    episodes = [run.file(str(episode.file)) for episode in accepted_episodes(run)]
    return Job(
        run=run,
        output=run.export,
        inputs=[*decided_by(run), run.compression, *episodes, *videos],
        seed=stage_seed(run, options.seed),
        options={"formats": list(options.formats), "codec": options.codec, "crf": options.crf},
        stand_for=originals(run),
    )


def summary(record: Export) -> dict[str, Any]:
    """A few facts for whoever ran the stage."""
    return {dataset.format: dataset.model_dump(exclude={"format"}) for dataset in record.datasets}


def execute(
    run: RunFolder, options: Options, context: StageContext, progress: Progress = silent
) -> StageResult[Export]:
    """Write a folder for each format into ``export/``, and ``export/export.json``.

    Raises:
        MissingStage, StaleStage: see :class:`vcage.runs.stage.Job`; also when a video was not compressed yet, or no
            episode counts.
        DamagedFile, SchemaMismatch: an episode or a video cannot be read.
        UsageError: the codec asked for cannot stay under the loss that the compression allowed, or needs a CRF.
    """
    if none := none_counts(run):
        withdraw(run.export.parent)
        raise none
    stage = job(run, options, context)

    def make(folder: Path, provenance: Provenance) -> Export:
        versions = [name for name in options.formats if name in FORMATS]
        if versions:
            _write_lerobot(run, versions, folder, find_footage(run, options, progress), progress)
        if ROBOTWIN in options.formats:
            _write_robotwin(run, folder / ROBOTWIN, progress)
        datasets = [_describe(run, name, folder / name, stage.inside(name)) for name in options.formats]
        return Export(provenance=provenance, datasets=datasets)

    result = stage.do(Export, make, force=options.force)
    shutil.rmtree(run.root / WORKING, ignore_errors=True)  # not before the stage is whole: a search takes long
    return result


def take_over(run: RunFolder, folder: Path, edited: Collection[str], context: StageContext) -> Export:
    """Nothing: the record tells what was made, and there is nothing in it to decide.

    Raises:
        InputFileError: always.
    """
    refuse(run.export, "(any)", f"{', '.join(edited)} was changed by hand", "what export wrote there")


def find_footage(run: RunFolder, options: Options, progress: Progress = silent) -> Footage:
    """The compressed videos; where another codec or CRF is asked for, others that are made now.

    Raises:
        MissingStage: nothing was compressed yet; or the raw pictures that another encoding takes are gone.
        UsageError: the codec cannot stay under the loss that the compression allowed; or the compression had a CRF
            given, which tells nothing to another codec.
    """
    compression = Compression.read(run.compression)
    wanted = _other_encoding(CompressionSettings(**compression.provenance.options), options)
    if wanted is None:
        files = {(stream.episode, stream.camera): run.file(stream.file) for stream in compression.streams}
        return Footage(files, encodings(compression.streams, compression.encoding.preset))
    require_raw(run.file(str(episode.file)) for episode in accepted_episodes(run))
    clips, names = clips_of(run)
    videos = search_data_set(clips, wanted, run.root / WORKING, workers=options.workers, progress=progress)
    streams = [video.stream for video in videos.values()]
    files = {(names[name], camera): video.file for (name, camera), video in videos.items()}
    return Footage(files, encodings(streams, wanted.choices().settings().preset))


def _other_encoding(compressed: CompressionSettings, options: Options) -> CompressionSettings | None:
    """How to encode again, or None where the compressed videos are what is asked for."""
    codec, crf = options.codec or compressed.codec, options.crf
    if codec == compressed.codec:
        return None if crf in (None, compressed.crf) else replace(compressed, crf=crf)
    if crf is None:
        crf = _same_quality(compressed, codec)
    return replace(compressed, codec=codec, crf=crf, pixel_format=AUTO)


def _same_quality(compressed: CompressionSettings, codec: str) -> int | None:
    """The CRF at which another codec does what was asked of the compression; None for one to be searched."""
    if compressed.crf is None:
        return None
    if compressed.crf != LOSSLESS:
        raise UsageError(
            f"no loss was searched for: the videos have the given CRF {compressed.crf}, which {codec} counts otherwise",
            hint="give a CRF for it too: --crf N",
        )
    if not CODECS[codec].lossless_format:
        raise UsageError(
            f"the videos were compressed without loss, which {codec} cannot do",
            hint="give the CRF of a loss that may be: --crf N, or take another --codec",
        )
    return LOSSLESS


def lerobot_episodes(
    run: RunFolder, files: Sequence[str], footage: Footage, progress: Progress = silent
) -> Iterator[LeRobotEpisode]:
    """Episodes with their videos, one after the other.

    Args:
        run: their run.
        files: theirs, relative to the run folder.
        footage: videos of all of their cameras.
        progress: told of every episode.

    Raises:
        MissingStage: a camera of an episode has no video.
        DamagedFile: an episode cannot be read.
    """
    with ThreadPoolExecutor(cores()) as pool:  # nearly all of it is decoding, which threads do side by side
        for number, episode in enumerate(pool.map(partial(_lerobot_episode, run, footage), files)):
            progress(Path(files[number]).stem, number, len(files))
            yield episode


def _lerobot_episode(run: RunFolder, footage: Footage, file: str) -> LeRobotEpisode:
    recording = open_hdf5(run.file(file))
    cameras = [camera.name for camera in recording.cameras]
    missing = [camera for camera in cameras if (file, camera) not in footage.files]
    if missing:
        raise MissingStage(f"{file} has no compressed video of {', '.join(missing)}", maker="compress")
    return lerobot_episode(recording, {camera: footage.files[file, camera] for camera in cameras}, OutputSpec())


def _write_lerobot(run: RunFolder, versions: Sequence[str], folder: Path, footage: Footage, progress: Progress) -> None:
    files = [str(record.file) for record in accepted_episodes(run)]
    with ExitStack() as stack:
        writers = [stack.enter_context(open_writer(name, folder / name, footage.facts)) for name in versions]
        for episode in lerobot_episodes(run, files, footage, progress):
            for writer in writers:
                writer.add(episode)


def _write_robotwin(run: RunFolder, out: Path, progress: Progress) -> None:
    accepted = accepted_episodes(run)
    out.mkdir(parents=True)
    for number, record in enumerate(accepted):
        progress(f"episode{number}.hdf5", number, len(accepted))
        with EpisodeReader(run.file(str(record.file))) as reader:
            export_robotwin(reader, out / f"episode{number}.hdf5")


def _describe(run: RunFolder, name: str, path: Path, relative: str) -> ExportedDataset:
    accepted = accepted_episodes(run)
    return ExportedDataset(
        format=name,
        path=relative,
        episodes=len(accepted),
        frames=sum(record.frames for record in accepted),
        bytes=sum(file.stat().st_size for file in path.rglob("*") if file.is_file()),
    )
