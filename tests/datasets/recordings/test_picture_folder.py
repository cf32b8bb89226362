from __future__ import annotations

import cv2
import numpy as np
import pytest

from tests.datasets.recordings.layouts import FRAMES, jpeg, png_that_declares, room, rooms
from vcage.base.errors import DamagedFile, OversizedFile
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


def test_alpha_is_laid_over_white_and_said(tmp_path):
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
