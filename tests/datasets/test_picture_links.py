from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from tests.datasets.recordings.layouts import FRAMES, HEIGHT, WIDTH, robotwin
from vcage.base.errors import DamagedFile
from vcage.datasets.hdf5_files import open_hdf5_file
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
def test_a_video_is_beside_its_file(name):
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
def test_an_incomplete_link_is_damaged(file, link, attribute, value):
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


# --- each link has a video of its own ------------------------------------------------------------------


@pytest.fixture
def two(tmp_path) -> Path:
    """A packed file of two cameras; of links alone, since none is followed."""
    with h5py.File(tmp_path / "two.hdf5", "w") as file:
        for camera in ("left", "right"):
            file[f"images/{camera}"] = np.zeros((FRAMES, HEIGHT, WIDTH, 3), np.uint8)
            original = Original.of(file[f"images/{camera}"])
            del file[f"images/{camera}"]
            stream = replace(STREAM, camera=camera, key=f"images/{camera}", file=f"two.{camera}.mp4")
            write_link(file["images"], camera, Link(stream, original))
    return tmp_path / "two.hdf5"


def rewrite(dataset: h5py.Dataset, value: object) -> None:
    """Another value in place of a scalar dataset's, with the attributes that it has."""
    parent, name, attributes = dataset.parent, dataset.name, dict(dataset.attrs)
    del parent[name]
    parent[name] = value
    parent[name].attrs.update(attributes)


def attribute_of_another(file: h5py.File) -> None:
    file["images/left"].attrs["vcage_file"] = "two.right.mp4"


def text_of_another(file: h5py.File) -> None:
    rewrite(file["images/left"], "two.right.mp4")


def text_that_is_a_number(file: h5py.File) -> None:
    rewrite(file["images/left"], 3.0)


def video_of_another(file: h5py.File) -> None:
    attribute_of_another(file)
    text_of_another(file)


def link_of_another(file: h5py.File) -> None:
    del file["images/left"]
    file.copy("images/right", "images/left")


def links_swapped(file: h5py.File) -> None:
    for old, new in (("left", "x"), ("right", "left"), ("x", "right")):
        file.move(f"images/{old}", f"images/{new}")


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (attribute_of_another, "images/left refers to two.left.mp4, its attribute vcage_file to two.right.mp4"),
        (text_of_another, "images/left refers to two.right.mp4, its attribute vcage_file to two.left.mp4"),
        (text_that_is_a_number, "images/left refers to 3.0, its"),
        (video_of_another, "refers to two.right.mp4, and so does /images/"),
        (link_of_another, "images/left is the link of images/right"),
        (links_swapped, "is the link of images/"),
    ],
)
def test_a_link_to_the_video_of_another_camera_is_refused_when_the_file_is_opened(two, change, told):
    with h5py.File(two, "r+") as file:
        change(file)
    with pytest.raises(DamagedFile, match=told):
        open_hdf5_file(two)


def test_a_link_may_have_several_names(two):
    with h5py.File(two, "r+") as file:
        file["alias"], file["soft"] = file["images/left"], h5py.SoftLink("/images/left")
        file["empty"] = h5py.Empty("f")
    open_hdf5_file(two).close()


def test_links_may_move_to_another_demonstration(two):
    with h5py.File(two, "r+") as file:
        file.move("images", "demo_7/images")
    open_hdf5_file(two).close()
