from __future__ import annotations

import os
from pathlib import Path

import cv2
import numpy as np
import pytest

from tests.datasets.packing.orders import settings
from tests.datasets.packing.searching import Searches, episode
from tests.datasets.recordings.layouts import FRAMES, act, rooms
from tests.recordings import written
from vcage.base.errors import DamagedFile
from vcage.datasets.packing.clips import Clip, SearchTask, is_finished, jpeg_bytes, known, perform
from vcage.datasets.recordings.opening import open_recordings
from vcage.schema.compression import VideoStream
from vcage.video.choices import LOSSLESS
from vcage.video.jod import JodMetric


def task(path: Path, folder: Path, **changes) -> SearchTask:
    chosen = settings(**changes)
    recording = open_recordings(path)[0]
    return SearchTask(
        clip=Clip("name", recording, recording.cameras[0].name, 10.0),
        choices=chosen.choices(),
        criterion=chosen.criterion(),
        display=chosen.display,
        keyframes=chosen.keyframes,
        folder=folder,
    )


@pytest.fixture
def searches(monkeypatch) -> Searches:
    return Searches(monkeypatch)


def test_a_completed_search_is_known_and_finished(tmp_path, searches):
    one = task(episode(tmp_path / "a.hdf5", top=20), tmp_path / "work")
    assert known(one) is None and not is_finished(one)
    stream = perform(one)
    assert known(one) == stream and is_finished(one)


@pytest.mark.slow
def test_frames_scored_in_a_search_are_not_scored_again(tmp_path, monkeypatch):
    one = task(written(tmp_path / "a.hdf5"), tmp_path / "work", crf=None)
    scored: list[bytes] = []
    loss = JodMetric.loss

    def counted(self, test, reference):
        scored.extend(picture.tobytes() for picture in test)
        return loss(self, test, reference)

    monkeypatch.setattr(JodMetric, "loss", counted)
    stream = perform(one)
    assert len(stream.evaluations) > 1 and len(set(scored)) == len(scored)


def test_a_video_without_its_record_counts_for_nothing(tmp_path, searches):
    one = task(episode(tmp_path / "a.hdf5", top=20), tmp_path / "work")
    perform(one)
    one.record.unlink()
    assert not is_finished(one)


@pytest.mark.parametrize("change", [{"crf": 21}, {"display": "standard_4k"}, {"keyframes": 4}, {"effort": "best"}])
def test_options_that_change_the_result_change_the_name(tmp_path, change):
    path = episode(tmp_path / "a.hdf5", top=20)
    assert task(path, tmp_path).record != task(path, tmp_path, **change).record


def test_another_version_of_the_metric_has_another_name(tmp_path, monkeypatch):
    path = episode(tmp_path / "a.hdf5", top=20)
    before = task(path, tmp_path).record
    monkeypatch.setattr("importlib.metadata.version", lambda name: f"{name} of tomorrow")
    assert task(path, tmp_path).record != before


def test_a_recording_that_was_written_again_has_another_name(tmp_path):
    path = episode(tmp_path / "a.hdf5", top=20)
    before = task(path, tmp_path).record
    os.utime(path, ns=(0, 0))
    assert task(path, tmp_path).record != before


def test_a_stream_tells_the_baselines_of_its_pictures(tmp_path):
    stream = perform(task(act(tmp_path / "a.hdf5"), tmp_path / "work"))
    assert isinstance(stream, VideoStream)
    assert (stream.frames, stream.raw_bytes, stream.stored_bytes) == (FRAMES, rooms().nbytes, rooms().nbytes)
    assert stream.jpeg_bytes == jpeg_bytes(rooms())


def test_a_stream_without_loss_tells_the_pixel_format_of_its_video(tmp_path):
    stream = perform(task(act(tmp_path / "a.hdf5"), tmp_path / "work", codec="h264", crf=LOSSLESS))
    assert (stream.lossless, stream.pixel_format) == (True, "rgb24")


def test_keyframes_follow_the_commands_if_there_are_any(tmp_path):
    frames = 24
    stream = perform(task(written(tmp_path / "a.hdf5", frames), tmp_path / "work"))
    assert {0, frames // 3, 2 * frames // 3, frames - 1} <= set(stream.keyframes)


def test_without_commands_keyframes_follow_the_pictures(tmp_path):
    pictures = np.zeros((9, 32, 32, 3), np.uint8)
    pictures[4:] = 200
    folder = tmp_path / "pictures"
    folder.mkdir()
    for index, picture in enumerate(pictures):
        cv2.imwrite(str(folder / f"{index}.png"), picture)
    stream = perform(task(folder, tmp_path / "work"))
    assert stream.keyframes == [0, 4, 8]


def test_damage_names_the_recording(tmp_path, searches):
    one = task(episode(tmp_path / "a.hdf5", top=20), tmp_path / "work")
    assert known(one) is None
    with open(one.clip.recording.path, "r+b") as handle:
        handle.truncate(100)
    with pytest.raises(DamagedFile, match=r"a\.hdf5") as damaged:
        perform(one)
    assert damaged.value.details == {"recording": "name"}
    assert not (tmp_path / "work").exists()
