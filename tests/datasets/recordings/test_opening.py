from __future__ import annotations

import os

import cv2
import h5py
import numpy as np
import pytest

from tests.datasets.recordings import layouts, simulators
from tests.datasets.recordings.layouts import act, jpeg, png_that_declares, robotwin, robotwin_vision, room
from vcage.base.errors import DamagedFile, InputFileError, OversizedFile
from vcage.datasets.recordings.hdf5_colours import COLOURS
from vcage.datasets.recordings.opening import open_all, open_hdf5, open_recordings


def test_a_folder_of_files_gives_one_recording_per_file_in_any_layout(tmp_path):
    (tmp_path / "data").mkdir()
    act(tmp_path / "data" / "b.hdf5")
    robotwin(tmp_path / "a.h5")
    assert [(one.path.name, one.LAYOUT) for one in open_recordings(tmp_path)] == [
        ("a.h5", "robotwin"),
        ("b.hdf5", "act"),
    ]


def test_a_folder_of_pictures_is_one_recording(tmp_path):
    (tmp_path / "0.jpg").write_bytes(jpeg(room()))
    assert [one.LAYOUT for one in open_recordings(tmp_path)] == ["pictures"]


def test_recordings_that_lie_together_have_their_colours_in_one_order(tmp_path):
    cold = np.stack([room(index)[..., ::-1] for index in range(6)])
    for name in "abcd":
        robotwin_vision(tmp_path / f"{name}.hdf5", swapped=True)
    robotwin_vision(tmp_path / "e.hdf5", swapped=True, pictures=cold)
    alone, *_, last = open_recordings(tmp_path / "e.hdf5") + open_recordings(tmp_path)
    assert not alone.swapped("cam_head") and last.swapped("cam_head")
    assert np.abs(last.pictures("cam_head").astype(int) - cold).mean() < 3


def test_a_recording_that_says_its_colours_is_believed_beside_others(tmp_path):
    for name in "abc":
        robotwin_vision(tmp_path / f"{name}.hdf5", swapped=True)
    with h5py.File(tmp_path / "c.hdf5", "r+") as file:
        file.attrs[COLOURS] = "true"
    assert [one.swapped("cam_head") for one in open_recordings(tmp_path)] == [True, True, False]


@pytest.mark.parametrize("name", ["missing", "empty"])
def test_an_unreadable_folder_error_lists_the_known_layouts(tmp_path, name):
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputFileError) as caught:
        open_recordings(tmp_path / name)
    assert name in str(caught.value) and caught.value.hint


def test_files_of_a_folder_come_in_natural_order_without_hidden_ones(tmp_path):
    for number in (0, 1, 2, 10, 11):
        layouts.act(tmp_path / f"episode_{number}.hdf5")
    (tmp_path / "._episode_0.hdf5").write_bytes(b"\0\5\26\7")
    (tmp_path / ".ipynb_checkpoints").mkdir()
    layouts.act(tmp_path / ".ipynb_checkpoints/episode_3.hdf5")
    found = open_all(tmp_path)
    assert [one.path.stem for one in found.recordings] == [f"episode_{number}" for number in (0, 1, 2, 10, 11)]
    assert not found.damaged


def test_linked_folders_are_searched_once(tmp_path):
    (tmp_path / "data").mkdir()
    (tmp_path / "elsewhere").mkdir()
    layouts.act(tmp_path / "elsewhere/a.hdf5")
    (tmp_path / "data/more").symlink_to(tmp_path / "elsewhere")
    (tmp_path / "elsewhere/back").symlink_to(tmp_path / "data")
    assert [one.name(tmp_path / "data") for one in open_all(tmp_path / "data").recordings] == ["more/a"]


def test_a_file_that_was_not_fetched_is_damaged_with_the_way_to_fetch_it(tmp_path):
    layouts.act(tmp_path / "a.hdf5")
    (tmp_path / "b.hdf5").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n")
    (tmp_path / "c.hdf5").symlink_to(".git/annex/objects/c.hdf5")
    messages = [error.message for error in open_all(tmp_path).damaged.values()]
    assert ["git lfs pull" in messages[0], "git annex get" in messages[1]] == [True, True]


@pytest.mark.parametrize(
    ("make", "key"),
    [
        (layouts.act, "action"),
        (layouts.robotwin, "joint_action/left_arm"),
        (layouts.robotwin_vision, "action/left_arm"),
        (layouts.robomimic, "data/demo_0/actions"),
    ],
)
def test_no_layout_reads_other_files(tmp_path, make, key):
    (tmp_path / "secret").write_bytes(bytes(4096))
    path = make(tmp_path / "file.hdf5")
    with h5py.File(path, "r+") as file:
        shape = file[key].shape
        del file[key]
        file.create_dataset(key, shape, np.float64, external=[(str(tmp_path / "secret"), 0, 4096)])
    with pytest.raises(DamagedFile, match=f":/{key} has external storage"):
        open_recordings(path)


@pytest.mark.parametrize(
    ("make", "key"), [(layouts.act, "observations/images/cam_high"), (layouts.robotwin, "observation/head_camera/rgb")]
)
def test_pictures_and_numbers_behind_soft_links_are_read(tmp_path, make, key):
    straight = open_hdf5(make(tmp_path / "straight.hdf5"))
    path = make(tmp_path / "linked.hdf5")
    with h5py.File(path, "r+") as file:
        for number, name in enumerate((key, "action" if make is layouts.act else "joint_action/left_arm")):
            file.move(name, f"real/{number}")
            file[name] = h5py.SoftLink(f"/real/{number}")
    linked = open_hdf5(path)
    assert [camera.name for camera in linked.cameras] == [camera.name for camera in straight.cameras]
    assert np.array_equal(linked.pictures(linked.cameras[0].name), straight.pictures(linked.cameras[0].name))
    assert np.array_equal(linked.motion.values, straight.motion.values)


def test_a_picture_too_large_to_decode_is_refused_before_that(tmp_path, monkeypatch):
    path = act(tmp_path / "file.hdf5")
    with h5py.File(path, "r+") as file:
        del file["observations/images/cam_high"]
        data = np.frombuffer(png_that_declares(30_000, 30_000), np.uint8)
        file["observations/images/cam_high"] = np.stack([data] * 6)
    monkeypatch.setattr(cv2, "imdecode", lambda *_: pytest.fail("decoded"))
    with pytest.raises(OversizedFile, match=r"cam_high\[0\] is too large: 30000 x 30000 pixels"):
        _ = open_hdf5(path).cameras


@pytest.mark.parametrize("name", [b"x\xff", b"x\xff.hdf5"])
def test_a_path_that_is_not_utf8_is_refused_before_any_work(tmp_path, name):
    path = tmp_path / os.fsdecode(name)
    if not name.endswith(b"hdf5"):
        path.mkdir()
        path = path / "a.hdf5"
    layouts.act(path)
    with pytest.raises(InputFileError, match=r"x\\xff.* is not UTF-8"):
        open_all(tmp_path)


def layout_with_a_pipe(root, name):
    """A recording, or a data set, of which the file called so is a pipe."""
    if name == "t.json":
        simulators.maniskill(root / "t.h5")
    elif name.startswith("instructions"):
        simulators.robotwin_tree(root)
    file = root / name
    file.parent.mkdir(exist_ok=True)
    file.unlink(missing_ok=True)
    os.mkfifo(file)
    return root


@pytest.mark.parametrize("name", ["meta/info.json", "t.json", "instructions/episode1.json", "a.hdf5", "frame_0.png"])
def test_a_pipe_in_place_of_a_file_of_a_recording_is_refused_by_name(tmp_path, name):
    root = layout_with_a_pipe(tmp_path, name)
    with pytest.raises(DamagedFile, match=rf"{name} is no regular file"):
        for recording in open_recordings(root):
            assert recording.failed is None and recording.left_out()
