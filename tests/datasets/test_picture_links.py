from __future__ import annotations

from dataclasses import replace

import h5py
import numpy as np
import pytest

from tests.datasets.recordings.layouts import FRAMES, HEIGHT, WIDTH, robotwin
from vcage.base.errors import DamagedFile
from vcage.datasets.picture_links import Link, Original, Stream, read_link, write_link
from vcage.video.codec import EncoderSettings, encode

KEY = "observation/head_camera/rgb"
STREAM = Stream("head_camera", KEY, "a.head_camera.mp4", FRAMES, WIDTH, HEIGHT, "jpeg", True)


@pytest.fixture
def file(tmp_path):
    with h5py.File(robotwin(tmp_path / "a.hdf5"), "r+") as file:
        yield file


@pytest.fixture
def link(file) -> Link:
    return Link(STREAM, Original.of(file[KEY]))


def test_a_link_comes_back_as_it_was_written(file, link):
    assert read_link(write_link(file, "link", link)) == link
    assert (link.original.kind, link.original.shape, link.original.channels) == ("fixed", [FRAMES], 3)


def test_a_link_of_an_earlier_version_that_says_more_is_read(file, link):
    dataset = write_link(file, "link", link)
    dataset.attrs["vcage_original_dtype"] = '"uint8"'
    assert read_link(dataset) == link


def test_another_dataset_is_no_link(file):
    assert read_link(file[KEY]) is None


@pytest.mark.parametrize("name", ["../a.mp4", "/tmp/a.mp4", "videos/a.mp4", "", ".."])
def test_a_video_lies_nowhere_but_beside_its_file(name):
    with pytest.raises(ValueError, match="bare name"):
        replace(STREAM, file=name)


@pytest.mark.parametrize(
    ("attribute", "value"),
    [
        ("vcage_frames", None),
        ("vcage_frames", "many"),
        ("vcage_height", -1),
        ("vcage_swapped", "no"),
        ("vcage_file", "../a.mp4"),
        ("vcage_original_kind", None),
        ("vcage_original_kind", '"film"'),
        ("vcage_original_kind", '"array"'),
        ("vcage_original_shape", "[1"),
        ("vcage_original_shape", f"[{FRAMES + 1}]"),
        ("vcage_original_shape", f"[{FRAMES}, 10]"),
        ("vcage_original_maxshape", "5"),
        ("vcage_original_maxshape", "[null, null]"),
        ("vcage_original_chunks", "[0]"),
        ("vcage_original_channels", '"x"'),
    ],
)
def test_a_link_that_is_not_whole_is_damaged(file, link, attribute, value):
    dataset = write_link(file, "link", link)
    del dataset.attrs[attribute]
    if value is not None:
        dataset.attrs[attribute] = value
    with pytest.raises(DamagedFile, match=r"a\.hdf5:/link is not a whole link"):
        read_link(dataset)


@pytest.mark.parametrize("shape", [[FRAMES, 10, 10, 3], [FRAMES, 10**5, 10**5, 3], [FRAMES, HEIGHT, WIDTH, 10**9]])
def test_an_array_had_the_size_of_its_pictures(link, shape):
    original = replace(link.original, kind="array", shape=[FRAMES, HEIGHT, WIDTH, 3], maxshape=[None] * 4, chunks=None)
    Link(STREAM, original)
    with pytest.raises(ValueError, match="original_shape is"):
        Link(STREAM, replace(original, shape=shape))


def test_a_video_of_another_size_is_noticed_before_it_is_decoded(link, tmp_path):
    pixels = np.zeros((FRAMES, HEIGHT, 2 * WIDTH, 3), np.uint8)
    (tmp_path / STREAM.file).write_bytes(encode(pixels, 10.0, EncoderSettings(gop=2), None))
    with pytest.raises(DamagedFile, match=f"frame 0 is {2 * WIDTH}x{HEIGHT}, the pictures were {WIDTH}x"):
        link.whole_video(tmp_path / "a.hdf5")


def test_a_link_of_another_version_is_refused(file, link):
    dataset = write_link(file, "link", link)
    dataset.attrs["vcage_schema"] = "vcage.pictures_in_video/99"
    with pytest.raises(DamagedFile, match="in_video/99"):
        read_link(dataset)


def test_the_video_lies_beside_the_file_or_is_missed_by_name(link, tmp_path):
    with pytest.raises(DamagedFile, match=r"a\.head_camera\.mp4"):
        link.video(tmp_path / "a.hdf5")
    (tmp_path / "a.head_camera.mp4").touch()
    assert link.video(tmp_path / "a.hdf5") == tmp_path / "a.head_camera.mp4"
