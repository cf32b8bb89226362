"""``vcage decompress`` as a user calls it."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from tests.datasets.packing.orders import act_folder, packed, robotwin_folder
from tests.run_folders import command, digests
from vcage.video.choices import LOSSLESS


@pytest.fixture
def small(tmp_path) -> Path:
    packed(act_folder(tmp_path / "in"), tmp_path / "small", crf=LOSSLESS)
    return tmp_path / "small"


def test_the_pictures_are_put_back(capsys, tmp_path, small):
    answer = command(capsys, "decompress", small, "--out", tmp_path / "back")
    assert (answer.code, answer.record["output"]) == (0, str(tmp_path / "back"))
    assert answer.record["summary"]["files"] == [str(tmp_path / "back/a.hdf5"), str(tmp_path / "back/b.hdf5")]
    key = "observations/images/cam_high"
    with h5py.File(tmp_path / "in/a.hdf5") as old, h5py.File(tmp_path / "back/a.hdf5") as new:
        assert np.array_equal(old[key], new[key])


def test_encoded_pictures_come_as_arrays_on_demand(capsys, tmp_path):
    packed(robotwin_folder(tmp_path / "in", 1), tmp_path / "small")
    command(capsys, "decompress", tmp_path / "small", "--out", tmp_path / "back", "--storage", "raw")
    with h5py.File(tmp_path / "back/episode0.hdf5") as file:
        assert file["observation/head_camera/rgb"].shape == (6, 32, 48, 3)


@pytest.mark.parametrize(
    ("source", "code", "name"),
    [("in", 2, "usage"), ("none", 3, "bad_input_file"), ("empty", 3, "bad_input_file")],
)
def test_an_uncompressed_run_is_refused(capsys, tmp_path, small, source, code, name):
    (tmp_path / "empty").mkdir()
    answer = command(capsys, "decompress", tmp_path / source, "--out", tmp_path / "back")
    assert (answer.code, answer.error["code"]) == (code, name)
    assert not list(tmp_path.glob("back*"))


def test_a_missing_video_is_named_with_the_way_out(capsys, tmp_path, small):
    (small / "b.cam_high.mp4").unlink()
    answer = command(capsys, "decompress", small, "--out", tmp_path / "back")
    assert (answer.code, answer.error["code"]) == (3, "damaged_file")
    assert "b.cam_high.mp4" in answer.error["message"] and answer.error["hint"]


def test_existing_output_is_replaced_only_with_force(capsys, tmp_path, small):
    call = ("decompress", small, "--out", tmp_path / "back")
    assert command(capsys, *call).code == 0
    before = digests(tmp_path)
    refused = command(capsys, *call)
    assert (refused.code, refused.error["code"]) == (2, "output_not_writable")
    assert command(capsys, *call, "--force").code == 0
    assert digests(tmp_path) == before


def test_an_output_inside_the_input_is_refused(capsys, small):
    assert command(capsys, "decompress", small, "--out", small / "back").error["code"] == "output_not_writable"
