"""The last two stages on a small collection: videos, their record, and the datasets made of them."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pyarrow.parquet as pq
import pytest

from tests.recordings import CAMERAS, FPS, collected, episode, wordings_of
from vcage.base.errors import DamagedFile, DiskFull, MissingStage, UsageError
from vcage.base.files import RunFolder
from vcage.base.videos import decode
from vcage.datasets.lerobot.formats import USUAL
from vcage.datasets.packing import clips
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.reader import EpisodeReader
from vcage.datasets.recordings.opening import open_recordings
from vcage.runs import footage
from vcage.runs.context import StageContext
from vcage.runs.footage import WORKING
from vcage.schema.compression import Compression
from vcage.schema.export import Export
from vcage.stages import compress, export
from vcage.video.choices import LOSSLESS
from vcage.video.jod import JodMetric

FRAMES = 12
QUICK = {"effort": "fast", "pixel_format": "yuv444p10le"}


def options_with(**changes: Any) -> compress.Options:
    """One process, which need not import everything again, what is asked for of the compression, and raw pictures to
    compare with."""
    return compress.Options(seed=7, workers=1, keep_raw=True, compression=CompressionSettings(**{**QUICK, **changes}))


OPTIONS = options_with()


def compressed(run: RunFolder, **changes: Any) -> Compression:
    return compress.execute(run, options_with(**changes), StageContext("offline")).record


def exported(run: RunFolder, **changes: Any) -> Export:
    return export.execute(run, export.Options(seed=7, workers=1, **changes), StageContext("offline")).record


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> RunFolder:
    """Collected, compressed and exported."""
    run = collected(tmp_path_factory.mktemp("run"), frames=FRAMES)
    compressed(run)
    exported(run)
    return run


@pytest.fixture(scope="module")
def searched(tmp_path_factory) -> RunFolder:
    """A short episode, collected and compressed."""
    run = collected(tmp_path_factory.mktemp("searched"), count=1, frames=6)
    compressed(run)
    return run


@pytest.fixture
def short(searched, tmp_path) -> RunFolder:
    """A copy of that, to be exported."""
    return RunFolder(shutil.copytree(searched.root, tmp_path / "short"))


@pytest.fixture
def fresh(tmp_path) -> RunFolder:
    return collected(tmp_path / "run", count=1, frames=6)


def full(path: Path, *_: object) -> None:
    raise DiskFull(f"no space left to write {path}")


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


@pytest.mark.slow
def test_the_same_episodes_give_the_same_files(searched, fresh):
    compressed(fresh)
    for path in sorted(fresh.compression.parent.iterdir()):
        assert path.read_bytes() == (searched.compression.parent / path.name).read_bytes()


def test_a_search_is_not_lost_where_the_disk_is_full_at_the_very_end(fresh, monkeypatch):
    with monkeypatch.context() as patched, pytest.raises(DiskFull):
        patched.setattr(Compression, "write", full)
        compressed(fresh, crf=20)
    monkeypatch.setattr(clips, "search_clip", lambda *_: pytest.fail("searched again"))
    assert len(compressed(fresh, crf=20).streams) == len(CAMERAS)
    assert not (fresh.root / compress.WORKING).exists()


def test_where_nothing_passes_all_videos_of_the_camera_are_lossless(fresh):
    record = compressed(fresh, max_loss=1e-6, pixel_format="yuv420p")
    assert all(camera.lossless and camera.crf is None and camera.loss_max == 0 for camera in record.cameras)
    stream = record.streams[0]
    with EpisodeReader(fresh.root / stream.episode) as reader:
        assert np.array_equal(decode(fresh.root / stream.file), reader.images(stream.camera)[:])


def test_a_finished_compression_is_left_alone(run):
    assert not compress.execute(run, OPTIONS, StageContext("offline")).fresh


def test_a_run_without_accepted_episodes_is_reported(tmp_path):
    run = collected(tmp_path, count=0)
    with pytest.raises(MissingStage, match="no accepted episode"):
        compressed(run)


def test_a_damaged_picture_stops_the_stage_and_leaves_nothing(fresh):
    path = fresh.root / "episodes/episode_000000.hdf5"
    with h5py.File(path) as plain:
        chunk = plain["/observations/images/cam_high"].id.get_chunk_info(5)
    with open(path, "r+b") as handle:
        handle.seek(chunk.byte_offset)
        handle.write(bytes(chunk.size))
    with pytest.raises(DamagedFile, match="episode_000000"):
        compressed(fresh, crf=20)
    assert not fresh.compression.parent.exists()


def test_all_of_lerobots_formats_are_exported_with_all_frames(run):
    record = Export.read(run.export)
    assert [d.format for d in record.datasets] == ["lerobot-v2.1", "lerobot-v3.0", "lerobot-v3.1"]
    for dataset in record.datasets:
        info = json.loads((run.root / dataset.path / "meta/info.json").read_text())
        assert info["total_frames"] == dataset.frames == 2 * FRAMES
        assert info["fps"] == FPS


def test_a_trainer_finds_the_sub_tasks_in_words_and_all_their_wordings(run):
    (table,) = (run.export.parent / "lerobot-v3.1/data").rglob("*.parquet")
    for rows in pq.read_table(table)["language_persistent"].to_pylist():
        assert [row["content"] for row in rows if row["style"] == "subtask"] == ["lift block", "place block"]
    expected = [wordings_of("lift-block"), wordings_of("place-block")]
    for version in ("lerobot-v3.0", "lerobot-v3.1"):
        subtasks = pq.read_table(run.export.parent / version / "meta/subtasks.parquet")
        assert subtasks["wordings"].to_pylist() == expected


def test_the_exported_features_say_how_the_videos_were_encoded(run):
    info = json.loads((run.export.parent / "lerobot-v3.0/meta/info.json").read_text())
    crfs = {camera.camera: camera.crf for camera in Compression.read(run.compression).cameras}
    for camera, crf in crfs.items():
        assert info["features"][f"observation.images.{camera}"]["info"]["video.crf"] == crf


def test_export_before_compression_names_the_missing_stage(fresh):
    with pytest.raises(MissingStage, match=r"compression\.json"):
        exported(fresh)


def test_export_of_a_later_episode_asks_for_compression(short):
    collected(short.root, count=2, frames=6)
    with pytest.raises(MissingStage, match="episode_000001"):
        exported(short)


def video_info(run: RunFolder, version: str = "lerobot-v3.0") -> dict:
    info = json.loads((run.export.parent / version / "meta/info.json").read_text())
    return info["features"]["observation.images.cam_high"]["info"]


def test_the_videos_are_copied_as_they_were_compressed(run):
    stream = next(s for s in Compression.read(run.compression).streams if s.camera == "cam_high")
    copy = run.export.parent / "lerobot-v2.1/videos/chunk-000/observation.images.cam_high/episode_000000.mp4"
    assert copy.read_bytes() == (run.root / stream.file).read_bytes()


@pytest.mark.slow
def test_another_codec_is_searched_at_the_same_loss_from_the_pictures_themselves(short):
    exported(short, formats=("lerobot-v3.0",), codec="h264")
    assert video_info(short)["video.codec"] == "h264"
    path = next((short.export.parent / "lerobot-v3.0/videos/observation.images.cam_high").rglob("*.mp4"))
    with EpisodeReader(short.root / "episodes/episode_000000.hdf5") as reader:
        reference = reader.images("cam_high")[:]
    assert JodMetric().loss(decode(path), reference).mean() < 0.1  # not every frame is scored
    assert not (short.root / WORKING).exists()


def test_a_given_crf_is_encoded_without_a_search(short):
    exported(short, formats=("lerobot-v2.1",), codec="av1", crf=30)
    info = video_info(short, "lerobot-v2.1")
    assert (info["video.codec"], info["video.crf"]) == ("av1", 30)


@pytest.mark.slow
def test_other_videos_are_not_lost_where_the_disk_is_full_at_the_very_end(short, monkeypatch):
    with monkeypatch.context() as patched, pytest.raises(DiskFull):
        patched.setattr(Export, "write", full)
        exported(short, codec="h264", crf=30)
    monkeypatch.setattr(clips, "search_clip", lambda *_: pytest.fail("encoded again"))
    exported(short, codec="h264", crf=30)
    assert not (short.root / WORKING).exists()


@pytest.mark.slow
def test_a_codec_that_cannot_stay_under_the_loss_is_refused_with_the_ways_out(fresh):
    compressed(fresh, max_loss=0.001)
    with pytest.raises(UsageError, match="no av1 video stays under") as caught:
        exported(fresh, codec="av1")
    assert "--crf" in caught.value.hint
    assert not fresh.export.parent.exists()


def test_a_lossless_run_stays_lossless_in_another_codec(fresh):
    compressed(fresh, crf=LOSSLESS)
    exported(fresh, formats=("lerobot-v3.0",), codec="h264")
    assert video_info(fresh)["video.lossless"]
    path = next((fresh.export.parent / "lerobot-v3.0/videos/observation.images.cam_high").rglob("*.mp4"))
    with EpisodeReader(fresh.root / "episodes/episode_000000.hdf5") as reader:
        assert np.array_equal(decode(path), reader.images("cam_high")[:])


@pytest.mark.parametrize(
    ("crf", "codec", "complaint"), [(LOSSLESS, "av1", "without loss"), (20, "h264", "given CRF 20, which h264")]
)
def test_a_codec_that_cannot_use_the_given_crf_asks_for_its_own(fresh, crf, codec, complaint):
    compressed(fresh, crf=crf)
    with pytest.raises(UsageError, match=complaint) as caught:
        exported(fresh, codec=codec)
    assert "--crf N" in caught.value.hint


def test_the_card_of_another_encoding_tells_its_own_losses(short):
    exported(short, formats=("lerobot-v3.0",), codec="h264", crf=30)
    card = (short.root / "export/lerobot-v3.0/README.md").read_text()
    assert "h264" in card and "CRF was given" in card
    assert "| `cam_high` | 30 |" in card


def test_every_lerobot_data_set_has_a_card(run):
    for name in USUAL:
        card = (run.root / f"export/{name}/README.md").read_text()
        assert "2 episodes of dual_panda" in card and "## Compression" in card and "## Selection" in card


def test_robotwin_files_hold_the_episodes_in_the_layout_of_its_readers(run, tmp_path):
    copy = RunFolder(shutil.copytree(run.root, tmp_path / "run", ignore=shutil.ignore_patterns("export")))
    record = exported(copy, formats=("robotwin",))
    recordings = open_recordings(copy.root / record.datasets[0].path)
    assert [recording.LAYOUT for recording in recordings] == ["robotwin", "robotwin"]
    with EpisodeReader(copy.root / "episodes/episode_000000.hdf5") as reader:
        assert np.allclose(recordings[0].motion.values[:-1], reader.episode.action[:-1])
        error = recordings[0].pictures("head_camera").astype(int) - reader.images("cam_high")[:]
    assert np.abs(error).mean() < 10  # JPEG of noise


def test_videos_that_no_data_set_takes_are_not_made(short, monkeypatch):
    monkeypatch.setattr(footage, "search_data_set", lambda *_, **__: pytest.fail("encoded"))
    assert [dataset.format for dataset in exported(short, formats=("robotwin",), codec="h264").datasets] == ["robotwin"]


def test_still_frames_are_dropped_from_states_and_from_robotwins_files(tmp_path):
    resting = episode(FRAMES).action
    resting[4:8] = resting[4]
    reached = np.concatenate([resting[:1], resting[:-1]])
    run = collected(tmp_path / "run", count=1, frames=FRAMES, action=resting, qpos=reached)
    formats = ("lerobot-v3.0", "robotwin")
    kept = exported(run, formats=formats, no_videos=True, still_frames="drop").datasets
    frames = [0, 1, 2, 3, 4, 6, 8, 9, 10, 11]  # a sub-task begins at 6
    assert [one.frames for one in kept] == [len(frames)] * 2
    states, robotwin = (open_recordings(run.root / one.path)[0] for one in kept)
    assert np.array_equal(states.state, reached[frames].astype(np.float32))
    assert np.array_equal(states.motion.values, resting[[0, 1, 2, 3, 5, 7, 8, 9, 10, 11]].astype(np.float32))
    rows = pq.read_table(run.file(kept[0].path) / "data/chunk-000/file-000.parquet").to_pydict()
    assert rows["subtask_index"] == [0] * 5 + [1] * 5
    assert np.allclose(rows["timestamp"], np.arange(len(frames)) / FPS)
    assert np.array_equal(robotwin.state, reached[frames])
    assert robotwin.pictures("head_camera").shape[0] == len(frames)
    assert [one.frames for one in exported(run, formats=formats, no_videos=True, force=True).datasets] == [FRAMES] * 2
