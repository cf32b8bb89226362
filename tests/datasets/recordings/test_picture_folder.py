from __future__ import annotations

import re
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from tests.datasets.recordings.layouts import FRAMES, jpeg, png_that_declares, room, rooms
from vcage.base.errors import DamagedFile, InputFileError, OversizedFile
from vcage.datasets.recordings.opening import open_all, open_recordings
from vcage.datasets.recordings.picture_folder import PictureFolder


def test_pictures_come_in_the_order_of_their_numbers(tmp_path):
    for index in range(12):
        cv2.imwrite(str(tmp_path / f"frame_{index}.png"), np.full((32, 32, 3), index, np.uint8))
    recording = PictureFolder(tmp_path)
    assert [camera.frames for camera in recording.cameras] == [12]
    assert recording.pictures("camera")[:, 0, 0, 0].tolist() == list(range(12))


def test_each_folder_of_pictures_is_a_camera(tmp_path):
    for camera in ("left", "high"):
        (tmp_path / camera).mkdir()
        for index, picture in enumerate(rooms()):
            (tmp_path / camera / f"{index}.jpg").write_bytes(jpeg(picture))
    recording = PictureFolder(tmp_path)
    assert [(camera.name, camera.frames, camera.storage) for camera in recording.cameras] == [
        ("high", FRAMES, "jpeg"),
        ("left", FRAMES, "jpeg"),
    ]
    assert np.abs(recording.pictures("left").astype(int) - rooms()).mean() < 3


def test_alpha_is_laid_over_white_and_reported(tmp_path):
    cv2.imwrite(str(tmp_path / "0.png"), np.zeros((32, 48, 4), np.uint8))
    recording = PictureFolder(tmp_path)
    assert (recording.pictures("camera") == 255).all()
    assert recording.camera("camera").channels == 4 and "alpha" in recording.notes[0]


def test_pictures_know_nothing_of_a_robot(tmp_path):
    (tmp_path / "0.jpg").write_bytes(jpeg(room()))
    recording = PictureFolder(tmp_path)
    assert (recording.motion, recording.state, recording.task, recording.robot) == (None, None, None, None)
    assert not recording.swapped("camera")


def test_a_damaged_picture_is_named(tmp_path):
    (tmp_path / "0.jpg").write_bytes(jpeg(room()))
    (tmp_path / "1.jpg").write_bytes(b"\xff\xd8 no more")
    with pytest.raises(DamagedFile, match=r"1\.jpg"):
        PictureFolder(tmp_path).pictures("camera")


def folder(path: Path, *names: str, picture: np.ndarray | None = None) -> Path:
    path.mkdir(parents=True, exist_ok=True)
    for index, name in enumerate(names):
        assert cv2.imwrite(str(path / name), room(index)[..., ::-1] if picture is None else picture)
    return path


@pytest.mark.parametrize(
    ("suffix", "storage"),
    [("webp", "webp"), ("bmp", "bmp"), ("tif", "tiff"), ("tiff", "tiff"), ("PNG", "png"), ("JPG", "jpeg")],
)
def test_frames_are_read_from_every_usual_format(tmp_path, suffix, storage):
    folder(tmp_path / "cam", *(f"frame_{index}.{suffix}" for index in range(FRAMES)))
    (recording,) = open_recordings(tmp_path)
    assert [(camera.frames, camera.storage) for camera in recording.cameras] == [(FRAMES, storage)]
    assert np.abs(recording.pictures("cam").astype(int) - rooms()).mean() < 6


def test_the_filling_of_a_bitmap_is_no_alpha(tmp_path):
    (tmp_path / "cam").mkdir()
    empty = Image.fromarray(np.dstack([room(), np.zeros((32, 48), np.uint8)]), "RGBA")
    empty.save(tmp_path / "cam/0.bmp")
    recording = PictureFolder(tmp_path)
    assert recording.camera("cam").channels == 3 and recording.notes == []
    assert np.array_equal(recording.pictures("cam")[0], room())


@pytest.mark.parametrize("mode", ["P", "L", "LA", "1"])
def test_palettes_and_grey_are_read_as_rgb(tmp_path, mode):
    (tmp_path / "cam").mkdir()
    picture = Image.fromarray(room()).convert(mode)
    picture.save(tmp_path / "cam/0.png")
    looks = np.asarray(picture.convert("RGB"))
    assert np.array_equal(PictureFolder(tmp_path).pictures("cam")[0], looks)


@pytest.mark.parametrize("name", ["0.exr", "depth.npy", "0.GIF"])
def test_an_unsupported_format_is_refused_by_name_with_the_supported_ones(tmp_path, name):
    (tmp_path / "cam").mkdir()
    (tmp_path / "cam" / name).write_bytes(b"whatever")
    with pytest.raises(InputFileError, match=name) as caught:
        open_recordings(tmp_path)
    assert ".png" in caught.value.hint and ".webp" in caught.value.hint


def test_files_of_another_format_beside_frames_are_named(tmp_path):
    folder(tmp_path / "cam", "0.png", "1.png")
    (tmp_path / "depth").mkdir()
    for index in range(2):
        (tmp_path / f"depth/{index}.npy").write_bytes(b"")
    (note,) = PictureFolder(tmp_path).notes
    assert note.startswith("depth: 0.npy and 1 more left out")


def test_folders_beside_pictures_that_are_a_camera_themselves_are_named(tmp_path):
    folder(tmp_path, "0.png", "1.png")
    folder(tmp_path / "wrist", "0.png")
    assert [note.partition(",")[0] for note in PictureFolder(tmp_path).notes] == ["wrist: left out"]


DEEP = np.full((32, 48), 40_000, np.uint16)


@pytest.mark.parametrize(("name", "stored"), [("frame_{}.png", "16-bit png"), ("frame_{}.tiff", "16-bit tiff")])
def test_a_folder_of_sixteen_bits_is_no_camera(tmp_path, name, stored):
    folder(tmp_path / "high", "0.png", "1.png")
    folder(tmp_path / "top", *(name.format(index) for index in range(2)), picture=DEEP)
    recording = PictureFolder(tmp_path)
    assert [camera.name for camera in recording.cameras] == ["high"]
    assert [str(one) for one in recording.other_streams] == [f"top (depth or other numbers, {stored})"]


@pytest.mark.parametrize("name", ["depth", "masks"])
def test_a_folder_named_depth_or_masks_is_no_camera(tmp_path, name):
    folder(tmp_path / "high", "0.png", "1.png")
    folder(tmp_path / name, "0.png", "1.png", picture=DEEP.astype(np.uint8))
    assert [one.key for one in PictureFolder(tmp_path).other_streams] == [name]


@pytest.mark.parametrize(("name", "cameras"), [("depth", 0), ("masked_grasps_01", 1)])
def test_the_name_of_a_whole_recording_counts_only_if_it_is_nothing_else(tmp_path, name, cameras):
    folder(tmp_path / name, "0.png", "1.png")
    assert len(PictureFolder(tmp_path / name).cameras) == cameras


def test_a_picture_of_sixteen_bits_among_others_is_refused(tmp_path):
    folder(tmp_path / "cam", "0.png", "1.png")
    cv2.imwrite(str(tmp_path / "cam/2.png"), DEEP)
    with pytest.raises(DamagedFile, match=r"2\.png has 16 bits a channel"):
        _ = PictureFolder(tmp_path).cameras


@pytest.mark.parametrize(
    ("names", "said"),
    [
        (("rgb_0.png", "rgb_1.png", "left_0.png", "left_1.png"), "several cameras: left_* and rgb_*"),
        (("frame_1.png", "frame_2.png", "frame_2.jpg"), "one frame twice"),
        (("frame_1.png", "frame_01.png"), "one frame twice"),
    ],
)
def test_frames_of_several_cameras_in_a_folder_are_refused(tmp_path, names, said):
    folder(tmp_path / "cam", *names)
    with pytest.raises(DamagedFile, match=re.escape(said)):
        _ = PictureFolder(tmp_path).cameras


@pytest.mark.parametrize(
    ("numbers", "said"),
    [
        ((0, 1, 2, 5, 6), "between the numbers 2 and 5"),
        ((0, 1, 3), "between the numbers 1 and 3"),
        ((0, 5, 10, 20), "between the numbers 10 and 20"),
        ((0, 5, 10, 15), None),
        ((3, 17, 40), None),
        ((0, 7), None),
    ],
)
def test_missing_numbers_are_reported_where_the_others_follow_in_even_steps(tmp_path, numbers, said):
    folder(tmp_path / "cam", *(f"ep0_frame_{number}.png" for number in numbers))
    notes = PictureFolder(tmp_path).notes
    assert bool(notes) == bool(said) and (said is None or said in notes[0])


def test_an_animation_is_no_frame(tmp_path):
    first, *others = [Image.fromarray(room(index)) for index in range(3)]
    (tmp_path / "cam").mkdir()
    first.save(tmp_path / "cam/0.webp", save_all=True, append_images=others)
    with pytest.raises(DamagedFile, match="several frames"):
        _ = PictureFolder(tmp_path).cameras


def test_a_user_says_that_red_and_blue_changed_places(tmp_path):
    folder(tmp_path / "cam", "0.png")
    (recording,) = open_all(tmp_path, "bgr").recordings
    assert np.array_equal(recording.pictures("cam")[0], room()[..., ::-1])


def test_a_picture_of_another_size_is_found_without_decoding_all(tmp_path, monkeypatch):
    for index in range(3):
        (tmp_path / f"{index}.jpg").write_bytes(jpeg(room()[: 16 if index == 1 else None]))
    with pytest.raises(DamagedFile, match=r"1\.jpg is 48x16, the first of its folder 48x32"):
        _ = PictureFolder(tmp_path).cameras


def test_hidden_files_are_no_pictures_and_linked_folders_are_cameras(tmp_path):
    folder, elsewhere = tmp_path / "in", tmp_path / "elsewhere"
    for path in (folder / "cam_10", folder / ".cache", elsewhere):
        path.mkdir(parents=True)
        (path / "0.jpg").write_bytes(jpeg(room()))
        (path / "._0.jpg").write_bytes(b"\0\5\26\7")
    (folder / "cam_2").symlink_to(elsewhere)
    cameras = PictureFolder(folder).cameras
    assert [(camera.name, camera.frames) for camera in cameras] == [("cam_2", 1), ("cam_10", 1)]


def test_a_picture_that_was_not_fetched_is_named(tmp_path):
    (tmp_path / "0.jpg").write_bytes(jpeg(room()))
    (tmp_path / "1.jpg").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n")
    with pytest.raises(DamagedFile, match=r"1\.jpg is a Git LFS pointer"):
        _ = PictureFolder(tmp_path).cameras


def test_a_picture_that_declares_too_many_pixels_is_refused_by_its_header(tmp_path):
    (tmp_path / "0.png").write_bytes(cv2.imencode(".png", room())[1].tobytes())
    (tmp_path / "1.png").write_bytes(png_that_declares(30_000, 30_000))
    with pytest.raises(OversizedFile, match=r"1\.png is too large: 30000 x 30000 pixels"):
        _ = PictureFolder(tmp_path).cameras
