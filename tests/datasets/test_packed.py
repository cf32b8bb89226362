from __future__ import annotations

import pickle
import shutil
from pathlib import Path

import cv2
import h5py
import numpy as np
import pytest

from tests.datasets.packed_files import pack, streams
from tests.datasets.recordings.layouts import FRAMES, HEIGHT, WIDTH, act, jpeg, robotwin, robotwin_vision, rooms
from tests.recordings import FPS, INSTRUCTION, clip, episode, written
from vcage.base.errors import DamagedFile, InputFileError, UsageError
from vcage.datasets.packed import Stream, unpack, write_packed
from vcage.datasets.reader import EpisodeReader
from vcage.datasets.recordings.opening import open_hdf5
from vcage.video.codec import EncoderSettings, encode

LAYOUTS = {
    "robotwin": robotwin,
    "robotwin-1.0": robotwin_vision,
    "robotwin-1.0-swapped": lambda path: robotwin_vision(path, swapped=True),
    "act": act,
    "act-encoded": lambda path: act(path, encoded=True),
    "vcage": lambda path: written(path, FRAMES),
}


@pytest.fixture(scope="module", params=LAYOUTS)
def source(request, tmp_path_factory) -> Path:
    """A recording with extra content that no layout knows."""
    path = LAYOUTS[request.param](tmp_path_factory.mktemp("source") / "source.hdf5")
    with h5py.File(path, "r+") as file:
        file.create_dataset("extra/notes", data=["a", "bc"], dtype=h5py.string_dtype())
        file["extra"].attrs["by"] = "hand"
        for stream in streams(path):
            file[stream.key].attrs["lens"] = "wide"
    return path


@pytest.fixture(scope="module")
def packed(source, tmp_path_factory) -> Path:
    return pack(source, tmp_path_factory.mktemp("packed") / "source.hdf5")


def everything(path: Path) -> dict[str, tuple]:
    """Name → kind, attributes, and for datasets type and content."""
    found: dict[str, tuple] = {}

    def look(name: str, item: h5py.Group | h5py.Dataset) -> None:
        attributes = {key: content(value) for key, value in item.attrs.items()}
        data = (item.dtype, item.chunks, content(item[()])) if isinstance(item, h5py.Dataset) else ()
        found[name] = (type(item), attributes, *data)

    with h5py.File(path) as file:
        look("/", file)
        file.visititems(look)
    return found


def content(value: object) -> tuple:
    """A value that equals only the same bits."""
    array = np.asarray(value)
    return array.shape, repr(array.tolist()) if array.dtype.hasobject else array.tobytes()


# --- packing -------------------------------------------------------------------------------------------


def test_all_but_the_pictures_is_the_same_bit_for_bit(source, packed):
    keys = {stream.key for stream in streams(source)}
    before, after = everything(source), everything(packed)
    assert before.keys() == after.keys()
    assert {name: one for name, one in before.items() if name not in keys and before[name] != after[name]} == {}


def test_a_link_names_its_stream_and_the_original(source, packed):
    with h5py.File(packed) as file, h5py.File(source) as old:
        for stream in streams(source):
            link = file[stream.key]
            assert link[()].decode() == link.attrs["vcage_file"] == stream.file
            assert (link.shape, link.attrs["vcage_frames"]) == ((), stream.frames)
            assert (link.attrs["vcage_storage"], link.attrs["vcage_swapped"]) == (stream.storage, stream.swapped)
            assert link.attrs["vcage_original_shape"] == str(list(old[stream.key].shape))
            assert link.attrs["lens"] == "wide"


def test_the_pictures_leave_no_space_behind(tmp_path):
    source = act(tmp_path / "source.hdf5")
    with h5py.File(source, "r+") as file:
        file["observations/images/cam_low"] = np.random.default_rng(0).integers(0, 255, (90, 64, 96, 3), np.uint8)
    target = write_packed(source, tmp_path / "packed.hdf5", streams(source))
    assert target.stat().st_size < 30_000 < source.stat().st_size


def test_the_source_is_left_as_it_was(source, tmp_path):
    before = source.read_bytes()
    write_packed(source, tmp_path / "packed.hdf5", streams(source))
    assert source.read_bytes() == before


def test_the_same_source_gives_the_same_bytes(source, packed, tmp_path):
    again = write_packed(source, tmp_path / "again.hdf5", streams(source))
    assert again.read_bytes() == packed.read_bytes()


def test_a_file_is_not_written_over_itself(source):
    with pytest.raises(UsageError, match="is the input file"):
        write_packed(source, source, streams(source))


def test_a_stream_that_fits_no_dataset_is_refused_and_leaves_nothing(source, tmp_path):
    first = streams(source)[0]
    for wrong in ({"key": "none"}, {"frames": first.frames + 1}, {"key": "extra"}):
        with pytest.raises(DamagedFile, match=r"source\.hdf5"):
            write_packed(source, tmp_path / "out" / "packed.hdf5", [Stream(**{**vars(first), **wrong})])
    assert list((tmp_path / "out").iterdir()) == []


@pytest.mark.parametrize("content", [None, b"no HDF5"])
def test_a_source_that_cannot_be_read_is_named(tmp_path, content):
    source = tmp_path / "source.hdf5"
    if content is not None:
        source.write_bytes(content)
    with pytest.raises(InputFileError, match=r"source\.hdf5"):
        write_packed(source, tmp_path / "packed.hdf5", [])


def test_repacked_pictures_keep_their_original_description(source, packed, tmp_path):
    again = write_packed(packed, tmp_path / "again.hdf5", streams(packed))
    assert again.read_bytes() == packed.read_bytes()


def test_a_stream_of_other_frames_than_the_packed_pictures_is_refused(packed, tmp_path):
    stream = streams(packed)[0]
    with pytest.raises(DamagedFile, match="does not hold"):
        write_packed(packed, tmp_path / "again.hdf5", [Stream(**{**vars(stream), "frames": stream.frames + 1})])


# --- reading packed files ------------------------------------------------------------------------------


def test_a_packed_file_is_read_like_its_source(source, packed):
    old, new = open_hdf5(source), open_hdf5(packed)
    assert (new.LAYOUT, new.fps, new.task) == (old.LAYOUT, FPS, old.task)
    for before, after in zip(old.cameras, new.cameras, strict=True):
        assert (after.name, after.key, after.frames, after.raw_bytes) == (
            before.name,
            before.key,
            before.frames,
            before.raw_bytes,
        )
        assert after.storage == "hevc" and not new.swapped(after.name)
        assert after.stored_bytes == (packed.parent / f"source.{after.name}.mp4").stat().st_size
        assert np.array_equal(new.pictures(after.name), old.pictures(after.name))
        assert np.array_equal(new.pictures(after.name, [1, 4]), old.pictures(after.name, [1, 4]))
    assert np.array_equal(new.motion.values, old.motion.values)
    assert np.array_equal(new.state, old.state)


def test_a_packed_recording_goes_to_another_process(packed):
    recording = pickle.loads(pickle.dumps(open_hdf5(packed)))
    assert len(recording.pictures(recording.cameras[0].name)) == FRAMES


def test_a_camera_may_stay_unpacked(tmp_path):
    source = robotwin(tmp_path / "a.hdf5")
    one = streams(source)[0]
    (tmp_path / one.file).write_bytes(encode(rooms(), 10.0, EncoderSettings(), None))
    recording = open_hdf5(write_packed(source, tmp_path / "packed.hdf5", [one]))
    assert [camera.storage for camera in recording.cameras] == ["hevc", "jpeg"]
    assert np.array_equal(recording.pictures("head_camera"), rooms())
    assert np.array_equal(recording.pictures("left_camera"), open_hdf5(source).pictures("left_camera"))


def spoil_missing(video: Path) -> None:
    video.unlink()


def spoil_shorter(video: Path) -> None:
    video.write_bytes(encode(rooms(FRAMES - 1), 10.0, EncoderSettings(), None))


def spoil_cut(video: Path) -> None:
    video.write_bytes(video.read_bytes()[:400])


@pytest.mark.parametrize("spoil", [spoil_missing, spoil_shorter, spoil_cut])
def test_a_wrong_video_is_named(packed, tmp_path, spoil):
    packed = shutil.copytree(packed.parent, tmp_path / "copy") / packed.name
    video = sorted(packed.parent.glob("*.mp4"))[0]
    spoil(video)
    with pytest.raises(DamagedFile, match=video.name):
        _ = open_hdf5(packed).cameras
    with pytest.raises(DamagedFile, match=video.name):
        unpack(packed, tmp_path / "out" / "source.hdf5")
    assert not (tmp_path / "out").exists() or list((tmp_path / "out").iterdir()) == []


def test_a_video_of_another_size_is_named(tmp_path):
    packed = pack(act(tmp_path / "a.hdf5"), tmp_path / "packed" / "a.hdf5")
    (packed.parent / "a.cam_high.mp4").write_bytes(encode(rooms().repeat(2, 1), 10.0, EncoderSettings(), None))
    with pytest.raises(DamagedFile, match="frame 0 is 48x64, the pictures were 48x32"):
        unpack(packed, tmp_path / "b.hdf5")


# --- unpacking -----------------------------------------------------------------------------------------


def test_unpacked_pictures_match_the_original_for_the_layouts_readers(source, packed, tmp_path):
    whole = unpack(packed, tmp_path / "whole.hdf5")
    with h5py.File(source) as before, h5py.File(whole) as after:
        for stream in streams(source):
            old, new = before[stream.key], after[stream.key]
            assert (old.dtype.kind, old.ndim, len(old)) == (new.dtype.kind, new.ndim, len(new))
            assert dict(new.attrs) == dict(old.attrs) and new.attrs["lens"] == "wide"
            for index in range(len(old)):
                if stream.storage == "raw":
                    assert np.array_equal(old[index], new[index])
                else:
                    assert np.array_equal(seen(old[index]), seen(new[index]))


def seen(data: bytes | np.ndarray) -> np.ndarray:
    """A picture as OpenCV, which the layouts' readers use, decodes it."""
    return cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)


def test_unpacking_puts_everything_else_back_bit_for_bit(source, packed, tmp_path):
    keys = {stream.key for stream in streams(source)}
    before, after = everything(source), everything(unpack(packed, tmp_path / "whole.hdf5"))
    assert {name: one for name, one in before.items() if name not in keys} == {
        name: one for name, one in after.items() if name not in keys
    }


def test_an_unpacked_file_is_again_a_recording_in_its_layout(source, packed, tmp_path):
    old, new = open_hdf5(source), open_hdf5(unpack(packed, tmp_path / "whole.hdf5"))
    assert new.LAYOUT == old.LAYOUT
    for camera in old.cameras:
        assert new.camera(camera.name).storage == ("raw" if camera.storage == "raw" else "png")
        assert np.array_equal(new.pictures(camera.name), old.pictures(camera.name))


def test_raw_puts_arrays_of_rgb_in_place_of_encoded_pictures(source, packed, tmp_path):
    old, new = open_hdf5(source), open_hdf5(unpack(packed, tmp_path / "whole.hdf5", "raw"))
    for camera in old.cameras:
        assert new.camera(camera.name).storage == "raw"
        assert np.array_equal(new.pictures(camera.name), old.pictures(camera.name))


def test_an_unpacked_episode_of_ours_is_an_episode_again(tmp_path):
    packed = pack(written(tmp_path / "a.hdf5", 8), tmp_path / "packed" / "a.hdf5")
    with EpisodeReader(unpack(packed, tmp_path / "b.hdf5")) as reader:
        assert np.array_equal(reader.episode.qpos, episode(8).qpos)
        assert (reader.episode.fps, reader.episode.instruction) == (FPS, INSTRUCTION)
        assert np.array_equal(reader.images("cam_high")[:], clip(8))


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"chunks": (4, 16, 48, 3), "compression": "gzip", "compression_opts": 7, "shuffle": True},
        {"chunks": (1, HEIGHT, WIDTH, 3), "compression": "lzf", "maxshape": (None, HEIGHT, WIDTH, 3)},
        {"chunks": (6, 8, 8, 3), "fletcher32": True, "maxshape": (9, HEIGHT, WIDTH, 3)},
    ],
)
def test_arrays_are_stored_again_as_they_were(tmp_path, options):
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file.create_dataset("observations/images/top", data=rooms(), **options)
    whole = unpack(pack(tmp_path / "a.hdf5", tmp_path / "packed" / "a.hdf5"), tmp_path / "b.hdf5")
    with h5py.File(tmp_path / "a.hdf5") as old, h5py.File(whole) as new:
        before, after = old["observations/images/top"], new["observations/images/top"]
        for name in ("dtype", "shape", "chunks", "maxshape", "compression", "compression_opts", "shuffle"):
            assert getattr(before, name) == getattr(after, name), name
        assert before.fletcher32 == after.fletcher32
        assert np.array_equal(before[()], after[()])


@pytest.mark.parametrize("shape", [(), (1,)])
def test_grey_arrays_come_back_grey(tmp_path, shape):
    grey = rooms()[..., 0].reshape(FRAMES, HEIGHT, WIDTH, *shape)
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file.create_dataset("observations/images/top", data=grey, chunks=True)
    whole = unpack(pack(tmp_path / "a.hdf5", tmp_path / "packed" / "a.hdf5"), tmp_path / "b.hdf5")
    with h5py.File(whole) as file:
        assert np.array_equal(file["observations/images/top"], grey)


def test_grey_picture_files_come_back_grey(tmp_path):
    grey = rooms()[..., 0]
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        dataset = file.create_dataset("vision/top/colors", (FRAMES,), h5py.vlen_dtype(np.uint8))
        for index, picture in enumerate(grey):
            dataset[index] = cv2.imencode(".png", picture)[1].reshape(-1)
    whole = unpack(pack(tmp_path / "a.hdf5", tmp_path / "packed" / "a.hdf5"), tmp_path / "b.hdf5")
    with h5py.File(whole) as file:
        assert np.array_equal(cv2.imdecode(file["vision/top/colors"][2], cv2.IMREAD_UNCHANGED), grey[2])


def test_alpha_comes_back_as_rgb_over_white(tmp_path):
    with_alpha = np.concatenate([rooms(), np.full((FRAMES, HEIGHT, WIDTH, 1), 255, np.uint8)], axis=-1)
    with_alpha[:, :4, :, 3] = 0
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file.create_dataset("observations/images/top", data=with_alpha, chunks=(1, HEIGHT, WIDTH, 4))
    whole = unpack(pack(tmp_path / "a.hdf5", tmp_path / "packed" / "a.hdf5"), tmp_path / "b.hdf5")
    with h5py.File(whole) as file:
        pictures = file["observations/images/top"][()]
    assert (pictures[:, :4] == 255).all() and np.array_equal(pictures[:, 4:], rooms()[:, 4:])


def test_padded_strings_that_could_grow_can_grow_again(tmp_path):
    files = [jpeg(picture) for picture in rooms()]
    data = np.array(files, dtype=f"S{max(map(len, files))}")
    with h5py.File(tmp_path / "a.hdf5", "w") as file:
        file.create_dataset("observation/head/rgb", data=data, maxshape=(None,), chunks=(2,))
    whole = unpack(pack(tmp_path / "a.hdf5", tmp_path / "packed" / "a.hdf5"), tmp_path / "b.hdf5")
    with h5py.File(whole) as file:
        dataset = file["observation/head/rgb"]
        assert (dataset.maxshape, dataset.chunks) == ((None,), (2,))


def test_a_file_that_was_never_packed_cannot_be_unpacked(tmp_path):
    with pytest.raises(UsageError, match="refers to no video"):
        unpack(act(tmp_path / "a.hdf5"), tmp_path / "b.hdf5")
    assert not (tmp_path / "b.hdf5").exists()
