from __future__ import annotations

import shutil

import h5py
import numpy as np
import pytest

from tests.datasets.packing.orders import act_folder, packed, robotwin_folder
from tests.datasets.recordings.layouts import FRAMES
from tests.run_folders import digests
from vcage.base.errors import DamagedFile, InputFileError, OutputFolderError, UsageError
from vcage.datasets.packing.unpacking import unpack_all
from vcage.datasets.recordings.opening import open_recordings
from vcage.video.choices import LOSSLESS


@pytest.fixture(scope="module")
def small_once(tmp_path_factory):
    """Two recordings, compressed without loss."""
    folder = tmp_path_factory.mktemp("once")
    packed(act_folder(folder / "in"), folder / "small", crf=LOSSLESS)
    return folder


@pytest.fixture
def small(small_once, tmp_path):
    """A copy that may be damaged, in a folder with its source."""
    shutil.copytree(small_once, tmp_path, dirs_exist_ok=True)
    return tmp_path / "small"


def test_a_folder_named_like_a_file_is_not_a_file(small, tmp_path):
    (small / "notes.hdf5").mkdir()
    assert len(unpack_all(small, tmp_path / "back")) == 2


def test_the_pictures_come_back_as_many_in_order_in_their_places(small, tmp_path):
    before = digests(small)
    files = unpack_all(small, tmp_path / "back")
    assert files == [tmp_path / "back/a.hdf5", tmp_path / "back/b.hdf5"]
    for name in ("a", "b"):
        with h5py.File(tmp_path / f"in/{name}.hdf5") as old, h5py.File(tmp_path / f"back/{name}.hdf5") as new:
            key = "observations/images/cam_high"
            assert (old[key].dtype, old[key].shape, old[key].chunks) == (
                new[key].dtype,
                new[key].shape,
                new[key].chunks,
            )
            assert np.array_equal(old[key], new[key])
            assert np.array_equal(old["action"], new["action"])
    assert digests(small) == before


def test_swapped_colours_come_back_swapped(tmp_path):
    packed(robotwin_folder(tmp_path / "in", 1), tmp_path / "small", crf=LOSSLESS)
    unpack_all(tmp_path / "small", tmp_path / "back")
    old, new = (open_recordings(tmp_path / name)[0] for name in ("in", "back"))
    assert new.swapped("head_camera")
    assert np.array_equal(old.pictures("head_camera"), new.pictures("head_camera"))


def test_arrays_declared_bgr_come_back_unchanged(tmp_path):
    packed(act_folder(tmp_path / "in", "a"), tmp_path / "small", crf=LOSSLESS, colours="bgr")
    unpack_all(tmp_path / "small", tmp_path / "back")
    old, small, new = (open_recordings(tmp_path / name)[0].pictures("cam_high") for name in ("in", "small", "back"))
    assert np.array_equal(old, new) and np.array_equal(old, small[..., ::-1])


def test_one_file_is_taken_alone(small, tmp_path):
    assert unpack_all(small / "b.hdf5", tmp_path / "back") == [tmp_path / "back/b.hdf5"]


def test_folders_in_folders_are_kept(small, tmp_path):
    (tmp_path / "more").mkdir()
    small.rename(tmp_path / "more/small")
    files = unpack_all(tmp_path / "more", tmp_path / "back")
    assert [file.relative_to(tmp_path / "back").as_posix() for file in files] == ["small/a.hdf5", "small/b.hdf5"]


# --- refused -------------------------------------------------------------------------------------------


def without_its_video(small):
    (small / "b.cam_high.mp4").unlink()


def with_a_video_cut_off(small):
    video = small / "b.cam_high.mp4"
    video.write_bytes(video.read_bytes()[:-200])


def with_a_video_that_is_too_short(small):
    with h5py.File(small / "b.hdf5", "r+") as file:
        file["observations/images/cam_high"].attrs["vcage_frames"] = FRAMES + 1


def cut_off(small):
    (small / "b.hdf5").write_bytes((small / "b.hdf5").read_bytes()[:1000])


@pytest.mark.parametrize("damage", [without_its_video, with_a_video_cut_off, with_a_video_that_is_too_short, cut_off])
def test_missing_or_damaged_input_is_named_and_nothing_is_written(small, tmp_path, damage):
    damage(small)
    with pytest.raises(DamagedFile, match=r"b\."):
        unpack_all(small, tmp_path / "back")
    assert not list(tmp_path.glob("back*"))


def test_a_file_that_was_never_compressed_is_refused(small, tmp_path):
    with pytest.raises(UsageError, match="refers to no video"):
        unpack_all(tmp_path / "in", tmp_path / "back")


@pytest.mark.parametrize("root", ["none", "empty"])
def test_a_missing_file_is_asked_for(tmp_path, root):
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputFileError, match=root):
        unpack_all(tmp_path / root, tmp_path / "back")


@pytest.mark.parametrize("out", ["small", "small/back", "."])
def test_an_output_inside_or_around_the_input_is_refused(small, tmp_path, out):
    with pytest.raises(OutputFolderError, match="in one another"):
        unpack_all(small, tmp_path / out, force=True)


def test_an_existing_output_is_replaced_only_with_force(small, tmp_path):
    unpack_all(small, tmp_path / "back")
    with pytest.raises(OutputFolderError, match="exists already"):
        unpack_all(small, tmp_path / "back")
    before = digests(tmp_path / "back")
    unpack_all(small, tmp_path / "back", force=True)
    assert digests(tmp_path / "back") == before


def test_files_of_somebody_else_are_never_replaced(small, tmp_path):
    (tmp_path / "back").mkdir()
    (tmp_path / "back/thesis.txt").write_text("years of work")
    with pytest.raises(OutputFolderError, match=r"thesis\.txt"):
        unpack_all(small, tmp_path / "back", force=True)
    assert (tmp_path / "back/thesis.txt").exists()


def test_a_file_in_place_of_the_output_is_refused(small, tmp_path):
    (tmp_path / "back").write_text("mine")
    with pytest.raises(OutputFolderError, match="is a file"):
        unpack_all(small, tmp_path / "back", force=True)
