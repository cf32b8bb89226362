from __future__ import annotations

import h5py
import pytest

from tests.datasets.packing.orders import act_folder, order, packed, robotwin_folder
from tests.datasets.packing.searching import Searches, episode
from tests.datasets.recordings.layouts import FRAMES
from tests.run_folders import digests
from vcage.base.errors import DamagedFile, OutputFolderError, UnknownName, UsageError
from vcage.datasets.packing import estimating
from vcage.datasets.packing.estimating import SampleSettings, estimate


@pytest.fixture
def source(tmp_path):
    return act_folder(tmp_path / "in", *"abcd")


def test_an_estimate_writes_nothing(tmp_path, source):
    before = digests(tmp_path)
    estimate(order(source, tmp_path / "out"))
    assert digests(tmp_path) == before and [path.name for path in tmp_path.iterdir()] == ["in"]


def test_an_estimate_of_similar_recordings_matches_the_result(tmp_path, source):
    told = estimate(order(source, tmp_path / "out"), workers=1)
    streams = packed(source, tmp_path / "out").record.streams
    assert (told["recordings"], told["videos"], told["cameras"]["cam_high"]["crf"]) == (4, 4, [20, 20, 20])
    for what in ("bytes", "raw_bytes", "jpeg_bytes"):
        assert told[what] == pytest.approx(sum(getattr(stream, what) for stream in streams), rel=0.01)


def test_more_workers_take_less_time(tmp_path, source, monkeypatch):
    monkeypatch.setattr(
        estimating, "SETTINGS", SampleSettings(frames=FRAMES // 2)
    )  # half of each of three clips of four
    monkeypatch.setattr("time.perf_counter", iter([0.0, 300.0, 1000.0, 1300.0]).__next__)
    assert estimate(order(source, tmp_path / "out"), workers=1)["seconds"] == 800
    assert estimate(order(source, tmp_path / "out"), workers=4)["seconds"] == 200


def test_the_bytes_are_for_the_crf_shared_by_all_episodes_of_a_camera(tmp_path, monkeypatch):
    Searches(monkeypatch)
    (tmp_path / "in").mkdir()
    for number, allowed in enumerate([24, 9, 22]):
        episode(tmp_path / f"in/{number}.hdf5", top=allowed)
    told = estimate(order(tmp_path / "in", tmp_path / "out", crf=None))
    assert told["cameras"]["top"]["crf"] == [9, 9, 9]
    assert told["bytes"] == 3 * len("yuv444p10le 9")


def test_damage_found_by_decoding_alone_is_skipped_if_allowed(tmp_path):
    folder = robotwin_folder(tmp_path / "in", 3)
    with h5py.File(folder / "episode1.hdf5", "r+") as file:
        rgb = file["observation/head_camera/rgb"]
        rgb[5] = b"no JPEG"
    with pytest.raises(DamagedFile, match="episode1"):
        estimate(order(folder, tmp_path / "out"))
    assert estimate(order(folder, tmp_path / "out", skip_damaged=True))["recordings"] == 2


def test_only_the_middle_of_a_clip_is_searched(tmp_path, source, monkeypatch):
    monkeypatch.setattr(estimating, "SETTINGS", SampleSettings(frames=4))
    told = estimate(order(source, tmp_path / "out", cameras=("cam_high",)))
    assert (told["sampled_frames"], told["cameras"]["cam_high"]["frames"]) == (3 * 4, 4 * FRAMES)


@pytest.mark.parametrize(
    ("changes", "error"),
    [
        ({"display": "cinema"}, UnknownName),
        ({"target": "lerobot-v3.0"}, UsageError),
        ({"cameras": ("no",)}, UnknownName),
    ],
)
def test_impossible_requests_are_refused(tmp_path, source, changes, error):
    with pytest.raises(error):
        estimate(order(source, tmp_path / "out", **changes))


def test_an_output_among_the_recordings_is_refused(source):
    with pytest.raises(OutputFolderError, match="in one another"):
        estimate(order(source, source / "out"))
