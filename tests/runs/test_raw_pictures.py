"""Raw pictures of compressed episodes."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from tests.recordings import CAMERAS, collected
from vcage.base.errors import DamagedFile, MissingStage, StaleStage
from vcage.base.files import RunFolder, read_json, sha256_file, write_json
from vcage.base.videos import decode
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.reader import EpisodeReader
from vcage.runs import raw_pictures
from vcage.runs.accepted import accepted_episodes
from vcage.runs.context import StageContext
from vcage.runs.raw_pictures import holds_links
from vcage.schema.compression import Compression
from vcage.schema.episodes import Episodes
from vcage.stages import compress, export

FRAMES = 6


def options(**changes: Any) -> compress.Options:
    settings = {"crf": changes.pop("crf", 20), "effort": "fast", "keyframes": 2}
    return compress.Options(seed=7, workers=1, compression=CompressionSettings(**settings), **changes)


def compressed(run: RunFolder, **changes: Any) -> Compression:
    return compress.execute(run, options(**changes), StageContext("offline")).record


def files_of(run: RunFolder) -> list[Path]:
    return [run.root / str(episode.file) for episode in accepted_episodes(run)]


@pytest.fixture(scope="module")
def collection(tmp_path_factory) -> RunFolder:
    return collected(tmp_path_factory.mktemp("run"), count=2, frames=FRAMES)


@pytest.fixture
def run(collection, tmp_path) -> RunFolder:
    return RunFolder(shutil.copytree(collection.root, tmp_path / "run"))


@pytest.fixture(scope="module")
def whole(collection, tmp_path_factory) -> RunFolder:
    """Compressed without a break."""
    run = RunFolder(shutil.copytree(collection.root, tmp_path_factory.mktemp("whole") / "run"))
    compressed(run)
    return run


@pytest.fixture
def done(whole, tmp_path) -> RunFolder:
    """A copy of it."""
    return RunFolder(shutil.copytree(whole.root, tmp_path / "done"))


def test_an_episode_refers_to_its_videos_and_is_read_as_before(run):
    with EpisodeReader(files_of(run)[0]) as reader:
        raw, before = reader.images("cam_high")[:], reader.episode
    sizes = sum(file.stat().st_size for file in files_of(run))
    record = compressed(run)
    assert all(holds_links(file) for file in files_of(run))
    assert sum(file.stat().st_size for file in files_of(run)) < sizes
    video = decode(run.root / next(s.file for s in record.streams if s.camera == "cam_high"))
    with EpisodeReader(files_of(run)[0]) as reader:
        images = reader.images("cam_high")
        assert images.shape == raw.shape
        assert np.array_equal(images[:], video)
        assert np.array_equal(images[-1], video[-1])
        assert np.array_equal(images[[1, 4]], video[[1, 4]])
        assert all(np.array_equal(one, other) for one, other in zip(images, video, strict=True))
        assert np.array_equal(reader.episode.qpos, before.qpos) and reader.episode.meta == before.meta


def test_raw_pictures_stay_on_request(run):
    before = [file.read_bytes() for file in files_of(run)]
    compressed(run, keep_raw=True)
    assert [file.read_bytes() for file in files_of(run)] == before
    assert not list(files_of(run)[0].parent.glob("*.mp4"))


@pytest.mark.slow
def test_kept_raw_pictures_may_be_dropped_later(run):
    record = compressed(run, keep_raw=True)
    assert compressed(run) == record
    assert all(holds_links(file) for file in files_of(run))


def test_a_compression_whose_raw_pictures_are_gone_is_finished(done):
    again = compress.execute(done, options(), StageContext("offline"))
    assert not again.fresh


@pytest.mark.slow
def test_an_export_with_raw_pictures_stays_up_to_date_without_them(run):
    compressed(run, keep_raw=True)
    first = export.execute(run, export.Options(seed=7, formats=("lerobot-v3.0", "robotwin")), StageContext("offline"))
    compressed(run)
    again = export.execute(run, export.Options(seed=7, formats=("lerobot-v3.0", "robotwin")), StageContext("offline"))
    assert first.fresh and not again.fresh


@pytest.mark.slow
def test_without_raw_pictures_all_formats_are_exported(done):
    chosen = export.Options(seed=7, formats=export.EXPORTS)
    record = export.execute(done, chosen, StageContext("offline")).record
    frames = {dataset.format: dataset.frames for dataset in record.datasets}
    assert frames.pop("robotwin-1.0") == 2 * (FRAMES - 1)
    assert set(frames.values()) == {2 * FRAMES} and len(frames) == len(export.EXPORTS) - 1


@pytest.mark.parametrize("changes", [{"force": True}, {"force": True, "crf": 30}])
def test_to_compress_again_without_raw_pictures_is_refused_with_the_way_out(done, changes):
    with pytest.raises(MissingStage, match="no raw pictures any more") as refused:
        compressed(done, **changes)
    assert refused.value.maker == "collect" and "--keep-raw" in refused.value.hint
    assert done.compression.is_file()


def test_another_codec_without_raw_pictures_is_refused(done):
    with pytest.raises(MissingStage, match="no raw pictures any more"):
        export.execute(done, export.Options(seed=7, codec="h264", crf=30), StageContext("offline"))


@pytest.mark.parametrize("spoilt", [lambda content: content[:-200], lambda content: content[:-200] + bytes(200)])
def test_a_damaged_video_leaves_the_episode_its_pictures(run, spoilt):
    record = compressed(run, keep_raw=True)
    video = run.root / record.streams[0].file
    video.write_bytes(spoilt(video.read_bytes()))
    with pytest.raises(DamagedFile):
        compressed(run)
    assert not holds_links(files_of(run)[0])


@pytest.mark.parametrize("calls", [0, len(CAMERAS), len(CAMERAS) + 1], ids=["a video", "an episode", "the next"])
def test_a_stage_interrupted_while_replacing_files_resumes_and_ends_the_same(run, whole, monkeypatch, calls):
    made, replace = [], os.replace

    def ending(source: Path, target: Path) -> None:
        if Path(target).parent == run.episodes.parent:
            if len(made) == calls:
                raise KeyboardInterrupt
            made.append(target)
        replace(source, target)

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(os, "replace", ending)
        compressed(run)
    for file in files_of(run):
        with EpisodeReader(file) as reader:
            assert len(reader.images("cam_high")[:]) == FRAMES
    compressed(run)
    for path in sorted(whole.episodes.parent.rglob("*")):
        assert path.is_dir() or path.read_bytes() == (run.episodes.parent / path.name).read_bytes()


@pytest.mark.slow
def test_episodes_that_join_later_leave_the_videos_of_the_first_as_they_are(collection, run):
    episodes = Episodes.read(run.episodes)
    episodes.model_copy(update={"episodes": episodes.episodes[:1]}).write(run.episodes)
    first = compressed(run)
    shutil.copyfile(collection.episodes, run.episodes)
    with pytest.raises(StaleStage):
        compressed(run)
    both = compressed(run, force=True)
    assert [s.model_copy() for s in both.streams if s.episode == first.streams[0].episode] == first.streams
    assert len(both.streams) == 2 * len(CAMERAS)
    assert all(holds_links(file) for file in files_of(run))
    assert all((run.root / stream.file).stat().st_size == stream.bytes for stream in both.streams)


def test_a_list_of_episodes_that_changed_takes_the_videos_over(done):
    record = Compression.read(done.compression)
    write_json(done.episodes, {**read_json(done.episodes), "attempts": 9})
    again = compressed(done, force=True)
    assert (again.streams, again.packed) == (record.streams, record.packed)
    assert again.provenance.inputs["episodes/episodes.json"] == sha256_file(done.episodes)


def test_episodes_that_join_later_are_not_mixed_with_other_settings(collection, run):
    episodes = Episodes.read(run.episodes)
    episodes.model_copy(update={"episodes": episodes.episodes[:1]}).write(run.episodes)
    compressed(run)
    shutil.copyfile(collection.episodes, run.episodes)
    with pytest.raises(MissingStage, match="no raw pictures any more"):
        compressed(run, force=True, crf=30)


@pytest.mark.slow
def test_videos_are_copied_where_there_are_no_hard_links(run, monkeypatch):
    def refuse(*_: object) -> None:
        raise OSError("no hard links here")

    monkeypatch.setattr(raw_pictures.os, "link", refuse)
    record = compressed(run)
    video = run.root / record.streams[0].file
    assert (run.episodes.parent / video.name).read_bytes() == video.read_bytes()


def test_an_episode_that_refers_to_videos_holds_no_pixels(whole):
    with h5py.File(files_of(whole)[0]) as file:
        assert all(not file["observations/images"][name].shape for name in CAMERAS)
