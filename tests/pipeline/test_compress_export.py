"""The last two stages on a small collection: videos, their record, and the datasets made of them."""

from __future__ import annotations

import json

import h5py
import numpy as np
import pytest

from tests.recordings import CAMERAS, FPS, collected, written
from vcage.compression.jod import JodMetric
from vcage.dataset.reader import EpisodeReader
from vcage.errors import DamagedFile, MissingStage
from vcage.files import RunFolder
from vcage.packing.settings import CompressionSettings
from vcage.pipeline import compress, export
from vcage.pipeline.settings import Settings
from vcage.pipeline.workbench import Workbench
from vcage.schema.compression import Compression
from vcage.schema.export import Export
from vcage.videos import decode

SETTINGS = Settings(seed=7, models="offline", workers=1)
FRAMES = 12


def compressed(run: RunFolder, **changes) -> Compression:
    return compress.execute(run, settings_with(**changes), Workbench("offline")).record


def settings_with(**changes) -> Settings:
    """One process, which need not import everything again, and what is asked for of the compression."""
    return Settings(seed=7, models="offline", workers=1, compression=CompressionSettings(**changes))


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> RunFolder:
    """Collected, compressed and exported."""
    run = collected(tmp_path_factory.mktemp("run"), frames=FRAMES)
    compressed(run)
    export.execute(run, SETTINGS, Workbench("offline"))
    return run


@pytest.fixture
def fresh(tmp_path) -> RunFolder:
    return collected(tmp_path / "run", frames=FRAMES)


def test_every_accepted_episode_has_a_video_per_camera_of_all_frames(run):
    record = Compression.read(run.compression)
    assert len(record.streams) == 2 * len(CAMERAS)
    for stream in record.streams:
        assert len(decode(run.root / stream.file)) == stream.frames == FRAMES
        assert (run.root / stream.file).stat().st_size == stream.bytes


def test_one_crf_per_camera_passes_on_the_keyframes_of_every_episode(run):
    record = Compression.read(run.compression)
    metric = JodMetric(record.encoding.display)
    for stream in record.streams:
        camera = next(camera for camera in record.cameras if camera.camera == stream.camera)
        frames = sorted({*stream.keyframes, *stream.guarded})
        with EpisodeReader(run.root / stream.episode) as reader:
            reference = reader.images(stream.camera)[frames]
        loss = metric.loss(decode(run.root / stream.file, frames), reference).max()
        assert stream.crf == camera.crf
        assert loss == pytest.approx(stream.loss_max)
        assert loss <= camera.loss_max < record.encoding.threshold


def test_the_record_tells_sizes_and_trials(run):
    record = Compression.read(run.compression)
    raw = sum(stream.raw_bytes for stream in record.streams)
    assert raw == 6 * FRAMES * 48 * 64 * 3
    assert record.reduction_raw == pytest.approx(1 - sum(s.bytes for s in record.streams) / raw, abs=1e-5)
    assert all(stream.evaluations for stream in record.streams)


def test_the_same_episodes_give_the_same_files(run, fresh):
    compressed(fresh)
    for path in sorted(fresh.compression.parent.iterdir()):
        assert path.read_bytes() == (run.compression.parent / path.name).read_bytes()


def test_where_nothing_passes_all_videos_of_the_camera_are_lossless(fresh):
    record = compressed(fresh, max_loss=1e-6)
    assert all(camera.lossless and camera.crf is None and camera.loss_max == 0 for camera in record.cameras)
    stream = record.streams[0]
    with EpisodeReader(fresh.root / stream.episode) as reader:
        assert np.array_equal(decode(fresh.root / stream.file), reader.images(stream.camera)[:])


def test_a_finished_compression_is_left_alone(run):
    assert not compress.execute(run, SETTINGS, Workbench("offline")).fresh


def test_no_accepted_episode_is_said(tmp_path):
    run = collected(tmp_path, count=0)
    with pytest.raises(MissingStage, match="no accepted episode"):
        compressed(run)


def test_a_damaged_picture_stops_the_stage_and_leaves_nothing(fresh):
    path = fresh.root / "episodes/episode_000001.hdf5"
    with h5py.File(path) as plain:
        chunk = plain["/observations/images/cam_high"].id.get_chunk_info(5)
    with open(path, "r+b") as handle:
        handle.seek(chunk.byte_offset)
        handle.write(bytes(chunk.size))
    with pytest.raises(DamagedFile, match="episode_000001"):
        compressed(fresh)
    assert not fresh.compression.parent.exists()


def test_both_formats_are_exported_with_all_frames(run):
    record = Export.read(run.export)
    assert [d.format for d in record.datasets] == ["lerobot-v2.1", "lerobot-v3.0"]
    for dataset in record.datasets:
        info = json.loads((run.root / dataset.path / "meta/info.json").read_text())
        assert info["total_frames"] == dataset.frames == 2 * FRAMES
        assert info["fps"] == FPS


def test_the_exported_features_say_how_the_videos_were_encoded(run):
    info = json.loads((run.export.parent / "lerobot-v3.0/meta/info.json").read_text())
    crfs = {camera.camera: camera.crf for camera in Compression.read(run.compression).cameras}
    for camera, crf in crfs.items():
        assert info["features"][f"observation.images.{camera}"]["info"]["video.crf"] == crf


def test_export_before_compression_names_the_missing_stage(fresh):
    with pytest.raises(MissingStage, match=r"compression\.json"):
        export.execute(fresh, SETTINGS, Workbench("offline"))


def test_export_of_an_episode_that_was_collected_later_asks_for_compression(fresh):
    compressed(fresh)
    collected(fresh.root, count=3, frames=FRAMES)
    written(fresh.root / "episodes/episode_000002.hdf5", FRAMES)
    with pytest.raises(MissingStage, match="episode_000002"):
        export.execute(fresh, SETTINGS, Workbench("offline"))
