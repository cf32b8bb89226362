"""Stage 9: the accepted episodes as LeRobot datasets, v3.0 and v2.1, with the compressed videos as they are."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from vcage.dataset.lerobot import FORMATS, open_writer
from vcage.dataset.lerobot_episode import LeRobotEpisode
from vcage.dataset.lerobot_writer import LeRobotWriter
from vcage.dataset.recordings.hdf5_layouts import open_hdf5
from vcage.errors import MissingStage
from vcage.files import RunFolder
from vcage.packing.targets import Wanted, encodings, lerobot_episode
from vcage.pipeline.compress import accepted_episodes
from vcage.pipeline.settings import Settings
from vcage.pipeline.stage import Job, StageResult, stage_seed
from vcage.pipeline.workbench import Workbench
from vcage.progress import Progress, silent
from vcage.schema.base import Provenance
from vcage.schema.compression import Compression
from vcage.schema.export import Export, ExportedDataset


def job(run: RunFolder, settings: Settings, _bench: Workbench) -> Job:
    """What the stage has to do."""
    videos = []
    if run.compression.exists():
        videos = [run.root / stream.file for stream in Compression.read(run.compression).streams]
    episodes = [run.root / str(episode.file) for episode in accepted_episodes(run)]
    return Job(
        run=run,
        output=run.export,
        inputs=[run.episodes, run.compression, *episodes, *videos],
        seed=stage_seed(run, settings.seed),
    )


def summary(record: Export) -> dict[str, Any]:
    """A few facts for whoever ran the stage."""
    return {dataset.format: dataset.model_dump(exclude={"format"}) for dataset in record.datasets}


def execute(run: RunFolder, settings: Settings, bench: Workbench, progress: Progress = silent) -> StageResult[Export]:
    """Write ``export/lerobot-v2.1``, ``export/lerobot-v3.0`` and ``export/export.json``.

    Raises:
        MissingStage, StaleStage: see :class:`vcage.pipeline.stage.Job`; also when a video was not compressed yet.
        DamagedFile, SchemaMismatch: an episode or a video cannot be read.
    """
    stage = job(run, settings, bench)

    def make(folder: Path, provenance: Provenance) -> Export:
        compression = Compression.read(run.compression)
        facts = _encodings(compression)
        with ExitStack() as stack:
            writers = {name: stack.enter_context(open_writer(name, folder / name, facts)) for name in FORMATS}
            for episode in _episodes(run, compression, progress):
                for writer in writers.values():
                    writer.add(episode)
        datasets = [_describe(name, folder / name, stage.inside(name), writer) for name, writer in writers.items()]
        return Export(provenance=provenance, datasets=datasets)

    return stage.do(Export, make, force=settings.force)


def _episodes(run: RunFolder, compression: Compression, progress: Progress) -> Iterator[LeRobotEpisode]:
    videos = {(stream.episode, stream.camera): run.root / stream.file for stream in compression.streams}
    accepted = accepted_episodes(run)
    for number, record in enumerate(accepted):
        file = str(record.file)
        progress(Path(file).stem, number, len(accepted))
        recording = open_hdf5(run.root / file)
        cameras = [camera.name for camera in recording.cameras]
        missing = [camera for camera in cameras if (file, camera) not in videos]
        if missing:
            raise MissingStage(
                f"{file} has no compressed video of {', '.join(missing)}", hint="run compress with --force first"
            )
        yield lerobot_episode(recording, {camera: videos[file, camera] for camera in cameras}, Wanted())


def _encodings(compression: Compression) -> dict[str, dict[str, Any]]:
    """Camera → what ``info.json`` says of its encoding beyond the stream itself."""
    shared = {"video.preset": compression.encoding.preset}
    return {camera: {**facts, **shared} for camera, facts in encodings(compression.streams).items()}


def _describe(name: str, path: Path, relative: str, writer: LeRobotWriter) -> ExportedDataset:
    return ExportedDataset(
        format=name,
        path=relative,
        episodes=writer.episodes,
        frames=writer.frames,
        bytes=sum(file.stat().st_size for file in path.rglob("*") if file.is_file()),
    )
