"""Statements of files about their encoded pictures stay true of the restored ones."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import h5py
import numpy as np
import pytest

from tests.datasets.packed_files import pack, streams
from tests.datasets.recordings.layouts import HEIGHT, WIDTH, act, jpeg
from vcage.base.errors import DamagedFile
from vcage.datasets.packed import unpack, write_packed
from vcage.datasets.picture_lengths import find_lengths
from vcage.datasets.recordings.opening import open_recordings
from vcage.video.codec import EncoderSettings, encode

CAMERAS = ("cam_high", "cam_low", "cam_left_wrist")
"""As a recorder lists them, which is not the order in which HDF5 does."""

FRAMES = 5


def pictures(camera: int) -> np.ndarray:
    """(T, H, W, 3) RGB with enough in it for JPEGs of different lengths."""
    return np.random.default_rng(camera).integers(0, 255, (FRAMES, HEIGHT, WIDTH, 3), dtype=np.uint8)


def act_plus_plus(path: Path, dtype: type = np.float32, *, by_frame: bool = False) -> Path:
    """ACT++'s layout: padded JPEG, and how long each is."""
    files = [[jpeg(picture) for picture in pictures(number)] for number in range(len(CAMERAS))]
    lengths = np.array([[len(data) for data in own] for own in files])
    with h5py.File(path, "w") as file:
        file.attrs["compress"], file.attrs["sim"] = True, False
        file["compress_len"] = (lengths.T if by_frame else lengths).astype(dtype)
        file["compress_len"].attrs["unit"] = "bytes"
        file["action"] = np.zeros((FRAMES, 14))
        file.create_group("observations/images").attrs["encoding"] = "jpeg"
        for camera, own in zip(CAMERAS, files, strict=True):
            padded = np.stack([np.frombuffer(data.ljust(lengths.max() + 3, b"\0"), np.uint8) for data in own])
            file[f"observations/images/{camera}"] = padded
    return path


def read_cut(path: Path, *, by_frame: bool = False) -> dict[str, np.ndarray]:
    """Pictures as readers decode them that cut each where the file says."""
    with h5py.File(path) as file:
        lengths = file["compress_len"][()].astype(int)
        lengths = lengths.T if by_frame else lengths
        return {
            camera: np.stack(
                [
                    cv2.imdecode(row[: lengths[number, index]], cv2.IMREAD_COLOR)[..., ::-1]
                    for index, row in enumerate(file[f"observations/images/{camera}"][()])
                ]
            )
            for number, camera in enumerate(CAMERAS)
        }


@pytest.mark.parametrize("by_frame", [False, True])
@pytest.mark.parametrize("dtype", [np.float32, np.int64, np.uint16])
def test_readers_that_cut_padded_pictures_read_the_restored_ones(tmp_path, dtype, by_frame):
    source = act_plus_plus(tmp_path / "a.hdf5", dtype, by_frame=by_frame)
    back = unpack(pack(source, tmp_path / "small/a.hdf5"), tmp_path / "back.hdf5")
    old, new = read_cut(source, by_frame=by_frame), read_cut(back, by_frame=by_frame)
    assert all(np.array_equal(old[camera], new[camera]) for camera in CAMERAS)
    with h5py.File(back) as file:
        assert (file["compress_len"].dtype, file["compress_len"].attrs["unit"]) == (dtype, "bytes")


def test_lengths_that_grow_too_large_for_their_type_get_a_wider_one(tmp_path):
    noise = np.random.default_rng(0).integers(100, 140, (FRAMES, 160, 160, 3), dtype=np.uint8)
    files = [cv2.imencode(".jpg", picture)[1].tobytes() for picture in noise]
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file["observations/images/cam_high"] = np.array(files, f"S{max(map(len, files))}")
        file["compress_len"] = np.array([len(data) for data in files], np.int16)
    back = unpack(pack(tmp_path / "a.hdf5", tmp_path / "small/a.hdf5"), tmp_path / "back.hdf5")
    with h5py.File(back) as file:
        lengths = [len(data) for data in file["observations/images/cam_high"][()]]
        assert min(lengths) > np.iinfo(np.int16).max
        assert (file["compress_len"][()].tolist(), file["compress_len"].dtype) == (lengths, np.int64)


def test_lengths_stay_as_they_are_while_pictures_lie_in_videos_and_in_videos_of_videos(tmp_path):
    source = act_plus_plus(tmp_path / "a.hdf5")
    packed = pack(pack(source, tmp_path / "once/a.hdf5"), tmp_path / "twice/a.hdf5")
    with h5py.File(source) as old, h5py.File(packed) as new:
        assert np.array_equal(old["compress_len"], new["compress_len"])
    old_read, new_read = read_cut(source), read_cut(unpack(packed, tmp_path / "back.hdf5"))
    assert all(np.array_equal(old_read[camera], new_read[camera]) for camera in CAMERAS)


def test_a_file_says_how_its_pictures_are_encoded_now(tmp_path):
    packed = pack(act_plus_plus(tmp_path / "a.hdf5"), tmp_path / "small/a.hdf5")
    with h5py.File(unpack(packed, tmp_path / "same.hdf5")) as file:
        assert file.attrs["compress"] and file["observations/images"].attrs["encoding"] == "png"
    with h5py.File(unpack(packed, tmp_path / "raw.hdf5", "raw")) as file:
        assert not file.attrs["compress"] and file.attrs["compress"].dtype == bool
        assert file["observations/images"].attrs["encoding"] == "raw"
        assert (file["compress_len"][()] == HEIGHT * WIDTH * 3).all()


def test_a_file_is_flagged_as_encoded_while_one_camera_is(tmp_path):
    source = act_plus_plus(tmp_path / "a.hdf5")
    some = write_packed(source, tmp_path / "some.hdf5", streams(source)[:1])
    video = tmp_path / streams(source)[0].file
    video.write_bytes(encode(open_recordings(source)[0].pictures("cam_high"), 10.0, EncoderSettings(gop=2), None))
    with h5py.File(unpack(some, tmp_path / "raw.hdf5", "raw")) as file:
        assert file.attrs["compress"] and file["observations/images/cam_high"].ndim == 4


def test_numbers_unlike_the_lengths_stay_unchanged(tmp_path):
    source = act_plus_plus(tmp_path / "a.hdf5")
    with h5py.File(source, "r+") as file:
        file["compress_len"][...] = file["compress_len"][()] + 1
        file["steps"] = np.arange(FRAMES)
    back = unpack(pack(source, tmp_path / "small/a.hdf5"), tmp_path / "back.hdf5")
    with h5py.File(source) as old, h5py.File(back) as new:
        assert all(np.array_equal(old[key], new[key]) for key in ("compress_len", "steps"))


def test_identical_pictures_have_rows_of_their_own(tmp_path):
    source = act(tmp_path / "a.hdf5", encoded=True)
    with h5py.File(source, "r+") as file:
        own = file["observations/images/cam_high"]
        file["observations/images/cam_low"] = own[()]
        file["compress_len"] = [[len(row.tobytes().rstrip(b"\0")) for row in own[()]]] * 2
    back = unpack(pack(source, tmp_path / "small/a.hdf5"), tmp_path / "back.hdf5")
    with h5py.File(back) as file:
        png = [len(row.tobytes().rstrip(b"\0")) for row in file["observations/images/cam_high"][()]]
        assert file["compress_len"][()].tolist() == [png, png]


def test_checksums_of_pictures_are_named_as_they_do_not_hold_for_videos(tmp_path):
    source = act(tmp_path / "a.hdf5")
    with h5py.File(source, "r+") as file:
        file["observations/images/cam_high"].attrs["sha256"] = "0" * 64
        file["observations/images"].attrs["crop_hashing"] = "none"
    (recording,) = open_recordings(source)
    (note,) = recording.notes
    assert note.startswith("observations/images/cam_high@sha256: made of the pictures as they are")


def test_numbers_too_many_to_be_lengths_are_not_read(tmp_path):
    path = act_plus_plus(tmp_path / "a.hdf5")
    with h5py.File(path, "r+") as file:
        file.create_dataset("cloud", (FRAMES, 2**33), np.float64, chunks=(1, 1024))
    with h5py.File(path) as file:
        found = find_lengths(file, ["observations/images/cam_high"])
    assert [place.key for place in found["observations/images/cam_high"]] == ["compress_len"]


# --- other forms ---------------------------------------------------------------------------------------

FORMS = {
    "compress_len": lambda lengths, _: lengths,
    "images_ends": lambda lengths, _: np.cumsum(lengths),
    "images_offsets": lambda lengths, _: np.cumsum(lengths) - lengths,
    "images_bounds": lambda lengths, _: np.concatenate([[0], np.cumsum(lengths)]),
    "padded_size": lambda _, width: np.array(width),
    "image_size": lambda _, width: np.array(width),
    "longest_length": lambda lengths, _: lengths.max(),
    "total_bytes": lambda lengths, _: lengths.sum(),
}
KEY = "observations/images/cam_high"


def sizes(dataset: h5py.Dataset) -> tuple[np.ndarray, int]:
    """Bytes of each padded picture, and with padding."""
    rows = dataset[()]
    return np.array([len(row.tobytes().rstrip(b"\0")) for row in rows]), rows.shape[1]


@pytest.fixture(scope="module")
def other_forms(tmp_path_factory) -> tuple[Path, Path]:
    """A file of one camera with sizes in all forms, as datasets and as attributes; and its restored copy."""
    folder = tmp_path_factory.mktemp("forms")
    padded = [jpeg(picture) for picture in pictures(0)]
    longest = max(map(len, padded)) + 3
    with h5py.File(folder / "a.hdf5", "w") as file:
        file["action"] = np.zeros((FRAMES, 14))
        file[KEY] = np.stack([np.frombuffer(data.ljust(longest, b"\0"), np.uint8) for data in padded])
        for name, form in FORMS.items():
            file[name] = file[KEY].attrs[name] = file["observations"].attrs[name] = form(*sizes(file[KEY]))
        file.attrs["episode_len"], file["padding"], file[KEY].attrs["mean_bytes"] = FRAMES, 7, 12.5
    back = unpack(pack(folder / "a.hdf5", folder / "small/a.hdf5"), folder / "back.hdf5")
    return folder / "a.hdf5", back


@pytest.mark.parametrize("name", FORMS)
def test_sizes_are_true_in_every_form_of_the_pictures_that_came_back(other_forms, name):
    with h5py.File(other_forms[0]) as old, h5py.File(other_forms[1]) as file:
        expected = FORMS[name](*sizes(file[KEY]))
        for found in (file[name][()], file[KEY].attrs[name], file["observations"].attrs[name]):
            assert np.array_equal(found, expected) and found.dtype.kind == "i"
        assert not np.array_equal(old[name], expected)


def test_apparent_sizes_of_an_unknown_form_are_named_and_stay(other_forms):
    (recording,) = open_recordings(other_forms[0])
    (note,) = [note for note in recording.notes if "sizes" in note]
    assert note.startswith(f"{KEY}@mean_bytes, padding: like sizes of the pictures, in no known form")
    with h5py.File(other_forms[1]) as file:
        assert (file["padding"][()], file[KEY].attrs["mean_bytes"], file.attrs["episode_len"]) == (7, 12.5, FRAMES)


@pytest.mark.parametrize(
    "place",
    [
        {"key": "action", "axis": 7, "index": 9},
        {"key": "action", "axis": 0, "index": 99},
        {"key": "action", "axis": 0, "index": 0},
        {"key": "nothing"},
        {"key": "compress_len", "form": "film"},
        {"key": KEY, "attribute": "nothing"},
        {"key": "observations"},
    ],
)
def test_a_link_that_names_other_numbers_as_lengths_changes_none_of_them(tmp_path, place):
    source = act_plus_plus(tmp_path / "a.hdf5")
    with h5py.File(source, "r+") as file:
        file["action"][...] = -0.5
    packed = pack(source, tmp_path / "small/a.hdf5")
    with h5py.File(packed, "r+") as file:
        file[KEY].attrs["vcage_lengths"] = json.dumps([place])
    with pytest.raises(DamagedFile, match=r"(?i)lengths"):
        unpack(packed, tmp_path / "back.hdf5")
    assert not (tmp_path / "back.hdf5").exists()
