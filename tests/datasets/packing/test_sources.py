from __future__ import annotations

import os

import h5py
import numpy as np
import pytest

from tests.datasets.packing.orders import FPS, act_folder, add_camera, filled, packed, settings
from tests.datasets.recordings.layouts import FRAMES, HEIGHT, WIDTH, act, rooms
from vcage.base.errors import DamagedFile, InputFileError, OutputFolderError, UnknownName, UsageError
from vcage.base.files import sha256_file
from vcage.datasets.packing import sources
from vcage.datasets.packing.sources import find_sources
from vcage.datasets.recordings.opening import open_recordings


def test_recordings_are_named_after_their_place_in_the_folder(tmp_path):
    act_folder(tmp_path / "in", "b", "a")
    act_folder(tmp_path / "in/more.1", "a")
    found = find_sources(tmp_path / "in", settings())
    assert [source.name for source in found.sources] == ["a", "b", "more.1/a"]
    assert [source.name for source in find_sources(tmp_path / "in/a.hdf5", settings()).sources] == ["a"]


def test_two_recordings_that_would_be_written_as_one_are_refused(tmp_path):
    act_folder(tmp_path / "in", "a")
    act(tmp_path / "in/a.h5")
    with pytest.raises(UsageError, match=r"a\.h5 and .*a\.hdf5 would both be written as a"):
        find_sources(tmp_path / "in", settings())


def test_clips_come_from_all_cameras_of_all_recordings_or_the_named_ones(tmp_path):
    add_camera(act_folder(tmp_path / "in") / "b.hdf5", "cam_low")
    found = find_sources(tmp_path / "in", settings())
    clips = found.clips(fps=FPS)
    assert [(clip.name, clip.camera, clip.fps) for clip in clips] == [
        ("a", "cam_high", FPS),
        ("b", "cam_high", FPS),
        ("b", "cam_low", FPS),
    ]
    assert [clip.name for clip in found.clips(["cam_high"], FPS)] == ["a", "b"]
    with pytest.raises(UnknownName, match=r"a\.hdf5 'cam_low'; available: cam_high"):
        found.clips(["cam_low"], FPS)


def test_a_camera_that_only_some_have_is_reported_of_the_others(tmp_path):
    add_camera(act_folder(tmp_path / "in") / "b.hdf5", "cam_low")
    assert find_sources(tmp_path / "in", settings()).missing_cameras() == {"a": ["cam_low"]}


def test_a_recording_that_does_not_say_its_frame_rate_asks_for_it(tmp_path):
    with pytest.raises(UsageError, match="frames per second") as refused:
        find_sources(act_folder(tmp_path / "in"), settings()).clips()
    assert "--fps" in refused.value.hint


def test_a_recording_of_numbers_alone_is_refused(tmp_path, monkeypatch):
    folder = act_folder(tmp_path / "in", "a")
    monkeypatch.setattr(type(open_recordings(folder)[0]), "cameras", [])
    with pytest.raises(UsageError, match=r"a\.hdf5 holds no pictures"):
        find_sources(folder, settings())


# --- what is damaged -----------------------------------------------------------------------------------


def cut_off(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def without_frames(path):
    with h5py.File(path, "r+") as file:
        del file["action"], file["observations"]
        file["observations/images/cam_high"] = np.zeros((0, HEIGHT, WIDTH, 3), np.uint8)


def with_nan(path):
    with h5py.File(path, "r+") as file:
        file["action"][2, 3] = np.nan


def with_fewer_commands(path):
    with h5py.File(path, "r+") as file:
        del file["action"]
        file["action"] = np.zeros((FRAMES - 1, 14))


def with_commands_of_text(path):
    with h5py.File(path, "r+") as file:
        del file["action"]
        file["action"] = ["left"] * FRAMES


DAMAGE = [
    (cut_off, "is damaged"),
    (without_frames, "holds no frame"),
    (with_nan, "frame 2 holds NaN"),
    (with_fewer_commands, "6 pictures, the action 5 rows"),
    (with_commands_of_text, "no row of numbers"),
]


@pytest.mark.parametrize(("damage", "said"), DAMAGE)
def test_a_damaged_recording_is_refused_before_any_work_and_left_out_on_demand(tmp_path, damage, said):
    damage(act_folder(tmp_path / "in") / "b.hdf5")
    with pytest.raises(DamagedFile, match=rf"b\.hdf5.*{said}") as refused:
        find_sources(tmp_path / "in", settings())
    assert "--skip-damaged" in refused.value.hint
    found = find_sources(tmp_path / "in", settings(), skip_damaged=True)
    assert [source.name for source in found.sources] == ["a"]
    assert said.replace("frame 2 ", "") in found.damaged["b"]


def test_where_none_is_sound_nothing_can_be_left_out(tmp_path):
    with_nan(act_folder(tmp_path / "in", "a") / "a.hdf5")
    with pytest.raises(DamagedFile, match="NaN") as refused:
        find_sources(tmp_path / "in", settings(), skip_damaged=True)
    assert "fix the action" in refused.value.hint


def test_of_many_damaged_ones_the_first_are_named_and_all_are_reported(tmp_path):
    folder = act_folder(tmp_path / "in", *"abcdefgh")
    for name in "abcdefg":
        (folder / f"{name}.hdf5").write_bytes(b"no HDF5")
    with pytest.raises(DamagedFile, match="and 2 more") as refused:
        find_sources(folder, settings())
    assert sorted(refused.value.details["damaged"]) == list("abcdefg")


@pytest.mark.parametrize("exists", [True, False])
def test_where_no_recording_is_one_is_asked_for(tmp_path, exists):
    folder = tmp_path / "in"
    if exists:
        folder.mkdir()
    with pytest.raises(InputFileError, match=str(folder)):
        find_sources(folder, settings())


# --- sizes ---------------------------------------------------------------------------------------------


def test_pictures_that_are_too_small_are_refused_with_the_smallest_size(tmp_path):
    path = filled(tmp_path / "a.hdf5", rooms()[:, :12, :12])
    with pytest.raises(UsageError, match=r"a\.hdf5, top: pictures of 12x12") as refused:
        find_sources(path, settings())
    assert "16" in refused.value.hint


@pytest.mark.parametrize(
    ("changes", "way_out"),
    [({"codec": "av1", "effort": "fast"}, "hevc"), ({"pixel_format": "yuv420p"}, "yuv444p10le")],
)
def test_odd_sizes_that_do_not_fit_are_refused_with_the_fitting_ones(tmp_path, changes, way_out):
    path = filled(tmp_path / "a.hdf5", rooms()[:, :31, :47])
    with pytest.raises(UsageError, match="47x31") as refused:
        find_sources(path, settings(**changes))
    assert way_out in refused.value.hint
    assert find_sources(path, settings()).sources


# --- hashes --------------------------------------------------------------------------------------------


def test_the_hash_of_a_file_is_that_of_its_content(tmp_path):
    found = find_sources(act_folder(tmp_path / "in", "a"), settings())
    assert found.hashes() == {"a": sha256_file(tmp_path / "in/a.hdf5")}


def test_the_hash_of_a_compressed_recording_changes_with_its_videos(tmp_path):
    packed(act_folder(tmp_path / "in", "a"), tmp_path / "small")
    before = find_sources(tmp_path / "small", settings()).hashes()
    video = tmp_path / "small/a.cam_high.mp4"
    video.write_bytes(video.read_bytes() + b"\0")
    assert find_sources(tmp_path / "small", settings()).hashes() != before


def test_recordings_are_in_natural_order(tmp_path):
    act_folder(tmp_path / "in", *(f"episode_{number}" for number in (10, 1, 2, 0)))
    found = find_sources(tmp_path / "in", settings())
    assert [source.name for source in found.sources] == [f"episode_{number}" for number in (0, 1, 2, 10)]


def test_cameras_are_in_natural_order(tmp_path):
    folder = act_folder(tmp_path / "in", "a")
    for name in ("cam_10", "cam_2"):
        add_camera(folder / "a.hdf5", name)
    found = find_sources(folder, settings())
    assert [camera.name for camera in found.sources[0].recording.cameras] == ["cam_2", "cam_10", "cam_high"]


def test_pictures_that_do_not_fit_in_memory_are_refused_with_their_size(tmp_path, monkeypatch):
    folder = act_folder(tmp_path / "in", "a")
    monkeypatch.setattr(sources, "free_memory", lambda: 1000)
    with pytest.raises(DamagedFile, match=rf"a\.hdf5, .*cam_high: {FRAMES} pictures of {WIDTH} x {HEIGHT} take"):
        find_sources(folder, settings())


@pytest.mark.parametrize(
    ("root", "out", "error"), [(b"i\xff", b"o", InputFileError), (b"i", b"o\xff", OutputFolderError)]
)
def test_paths_that_are_not_utf8_are_refused_before_any_work(tmp_path, root, out, error):
    with pytest.raises(error, match=r"\\xff is not UTF-8"):
        sources.require_apart(tmp_path / os.fsdecode(root), tmp_path / os.fsdecode(out))
