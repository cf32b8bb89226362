"""Files that hold many recordings, robomimic's demonstrations, through the whole of packing."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from tests.datasets.packing.orders import order, packed, settings
from tests.datasets.recordings.layouts import DEMOS, FRAMES, RATE, act, robomimic, rooms
from tests.datasets.test_packed import everything
from tests.run_folders import digests
from vcage.base.errors import DamagedFile, UsageError
from vcage.base.videos import frame_rate
from vcage.datasets.lerobot.formats import FORMATS
from vcage.datasets.packing import clips as clip_module
from vcage.datasets.packing.estimating import estimate
from vcage.datasets.packing.inspecting import as_lines, inspect, totals
from vcage.datasets.packing.pack import RECORD
from vcage.datasets.packing.sources import find_sources
from vcage.datasets.packing.unpacking import unpack_all
from vcage.datasets.recordings.opening import open_recordings
from vcage.video.choices import LOSSLESS

CAMERAS = ("agentview", "robot0_eye_in_hand")


@pytest.fixture
def path(tmp_path) -> Path:
    return robomimic(tmp_path / "lift.hdf5")


def videos(*demos: str) -> list[str]:
    return [f"lift.{demo}.{camera}.mp4" for demo in demos for camera in CAMERAS]


# --- found ---------------------------------------------------------------------------------------------


def test_a_demonstration_is_named_after_its_file_and_itself(path):
    assert [source.name for source in find_sources(path, settings()).sources] == [f"lift.{demo}" for demo in DEMOS]
    assert {source.file for source in find_sources(path.parent, settings()).sources} == {"lift"}


@pytest.mark.parametrize("name", ["lift.h5", "lift.demo_2.hdf5"])
def test_a_file_that_would_be_written_where_a_demonstration_is_is_refused(path, name):
    act(path.with_name(name))
    with pytest.raises(UsageError, match="would both be written as lift"):
        find_sources(path.parent, settings())


def test_a_look_lists_the_demonstrations(path):
    found = inspect(path)
    lines = as_lines(found).splitlines()
    assert lines[0] == f"{path}:demo_0: robomimic, 20 fps, 7 numbers in a command"
    assert totals(found)["recordings"] == len(DEMOS)


def test_a_frame_rate_that_is_not_reported_is_asked_for(tmp_path):
    path = robomimic(tmp_path / "lift.hdf5", rate=None)
    with pytest.raises(UsageError, match="demo_0 does not say how many frames per second"):
        find_sources(path, settings()).clips()


def test_a_size_is_estimated_of_a_few_demonstrations(path, tmp_path):
    assert estimate(order(path, tmp_path / "out"), workers=1)["recordings"] == len(DEMOS)


# --- HDF5 ----------------------------------------------------------------------------------------------


def test_the_file_is_written_once_beside_the_videos_of_all_its_demonstrations(path, tmp_path):
    done = packed(path, tmp_path / "out")
    assert sorted(digests(tmp_path / "out")) == sorted([RECORD, "lift.hdf5", *videos(*DEMOS)])
    assert frame_rate(tmp_path / "out/lift.demo_0.agentview.mp4") == RATE
    assert any("control_freq" in note for note in done.record.notes["lift.demo_0"])


def test_all_but_the_pictures_stays_as_it_was(path, tmp_path):
    packed(path, tmp_path / "out")
    keys = {camera.key for demo in open_recordings(path) for camera in demo.cameras}
    before, after = everything(path), everything(tmp_path / "out/lift.hdf5")
    assert keys <= set(before) and before.keys() == after.keys()
    assert all(before[key] == after[key] for key in before.keys() - keys)


def test_all_comes_back_as_it_was(path, tmp_path):
    packed(path, tmp_path / "out", crf=LOSSLESS)
    assert unpack_all(tmp_path / "out", tmp_path / "back") == [tmp_path / "back/lift.hdf5"]
    assert everything(tmp_path / "back/lift.hdf5") == everything(path)


def test_demonstrations_that_were_compressed_are_read_as_before_and_compressed_again(path, tmp_path):
    packed(path, tmp_path / "once", crf=LOSSLESS)
    packed(tmp_path / "once", tmp_path / "twice", crf=LOSSLESS, cameras=("agentview",))
    for old, new in zip(open_recordings(path), open_recordings(tmp_path / "twice"), strict=True):
        assert [camera.storage for camera in new.cameras] == ["hevc", "hevc"]
        for camera in CAMERAS:
            assert np.array_equal(old.pictures(camera), new.pictures(camera))


def test_demonstrations_need_not_have_the_same_cameras(path, tmp_path):
    with h5py.File(path, "r+") as file:
        file["data/demo_2/obs/sideview_image"] = rooms()
    record = packed(path, tmp_path / "out").record
    assert (tmp_path / "out/lift.demo_2.sideview.mp4").is_file()
    assert "it lacks sideview, which others have" in record.notes["lift.demo_0"]


def test_a_call_that_was_stopped_goes_on_where_it_was(path, tmp_path, monkeypatch):
    search = clip_module.search_clip

    def stops(*args: object) -> object:
        if len(list((tmp_path / "out.compressing/videos").glob("*.mp4"))) == 3:
            raise KeyboardInterrupt
        return search(*args)

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(clip_module, "search_clip", stops)
        packed(path, tmp_path / "out")
    searched = []
    monkeypatch.setattr(clip_module, "search_clip", lambda *args: searched.append(args) or search(*args))
    packed(path, tmp_path / "out")
    assert len(searched) == 3
    assert everything(tmp_path / "out/lift.hdf5").keys() == everything(path).keys()
    assert not packed(path, tmp_path / "out").fresh


# --- damage --------------------------------------------------------------------------------------------


def with_nan(demo: h5py.Group) -> None:
    demo["actions"][1, 2] = np.nan


def without_pictures(demo: h5py.Group) -> None:
    for camera in CAMERAS:
        del demo[f"obs/{camera}_image"]


def with_fewer_pictures(demo: h5py.Group) -> None:
    del demo["obs/agentview_image"]
    demo["obs/agentview_image"] = rooms(FRAMES - 1)


def with_a_broken_chunk(demo: h5py.Group) -> None:
    demo["obs/agentview_image"].id.write_direct_chunk((3, 0, 0, 0), b"no gzip")


DAMAGE = [
    (with_nan, "holds NaN"),
    (without_pictures, "holds no pictures"),
    (with_fewer_pictures, "agentview has 5 pictures"),
    (with_a_broken_chunk, "is damaged"),
]


@pytest.mark.slow
@pytest.mark.parametrize(("damage", "said"), DAMAGE)
def test_a_damaged_demonstration_stops_all_or_stays_in_the_file_as_it_was(path, tmp_path, damage, said):
    with h5py.File(path, "r+") as file:
        damage(file["data/demo_2"])
    with pytest.raises(DamagedFile, match=said) as refused:
        packed(path, tmp_path / "out")
    assert "--skip-damaged" in refused.value.hint
    assert not (tmp_path / "out").exists()
    done = packed(path, tmp_path / "out", skip_damaged=True)
    assert sorted(digests(tmp_path / "out")) == sorted([RECORD, "lift.hdf5", *videos("demo_0", "demo_10")])
    assert said in done.record.notes["lift.demo_2"][0]
    with h5py.File(path) as old, h5py.File(tmp_path / "out/lift.hdf5") as new:
        assert old["data/demo_2/obs"].keys() == new["data/demo_2/obs"].keys()
        for name, item in old["data/demo_2/obs"].items():
            copy = new["data/demo_2/obs"][name]
            assert (copy.shape, copy.dtype) == (item.shape, item.dtype)
            assert copy.id.get_storage_size() == item.id.get_storage_size()
        assert np.array_equal(old["mask/train"], new["mask/train"])


def test_a_demonstration_without_its_video_is_left_out_and_its_files_stay(path, tmp_path):
    packed(path, tmp_path / "once")
    (tmp_path / "once/lift.demo_2.agentview.mp4").unlink()
    packed(tmp_path / "once", tmp_path / "twice", skip_damaged=True)
    there = {*videos(*DEMOS)} - {"lift.demo_2.agentview.mp4"}
    assert set(digests(tmp_path / "twice")) == {RECORD, "lift.hdf5", *there}


# --- LeRobot -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("target", FORMATS)
def test_demonstrations_become_episodes_in_the_order_of_their_numbers(path, tmp_path, target):
    packed(path, tmp_path / "out", target=target, task="lift the cube", crf=LOSSLESS)
    episodes = open_recordings(tmp_path / "out")
    for old, new in zip(open_recordings(path), episodes, strict=True):
        assert (new.fps, new.task, new.state_names) == (RATE, "lift the cube", old.state_names)
        assert np.array_equal(new.motion.values, old.motion.values)
        assert np.allclose(new.state, old.state)
        for camera in CAMERAS:
            assert np.array_equal(new.pictures(camera), old.pictures(camera))


def test_demonstrations_of_other_cameras_do_not_share_a_data_set(path, tmp_path):
    with h5py.File(path, "r+") as file:
        del file["data/demo_2/obs/robot0_eye_in_hand_image"]
    with pytest.raises(UsageError, match=r"demo_2 has other cameras .* than .*demo_0"):
        packed(path, tmp_path / "out", target="lerobot-v3.0", task="lift the cube")


def test_videos_alone_are_named_after_their_demonstrations(path, tmp_path):
    packed(path, tmp_path / "out", target="videos")
    assert sorted(digests(tmp_path / "out")) == sorted([RECORD, *videos(*DEMOS)])
