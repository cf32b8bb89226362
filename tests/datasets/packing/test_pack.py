from __future__ import annotations

import errno
import os
import shutil
from pathlib import Path

import av
import h5py
import numpy as np
import pytest

from tests.datasets.packing.orders import FPS, act_folder, add_camera, filled, order, packed, robotwin_folder
from tests.datasets.recordings.layouts import FRAMES, HEIGHT, WIDTH, act, jpeg, robotwin, robotwin_vision, room, rooms
from tests.recordings import written
from tests.run_folders import digests
from vcage.base.errors import (
    DamagedFile,
    DiskFull,
    FolderInUse,
    InputFileError,
    MissingDependency,
    OutputFolderError,
    StaleStage,
    UnknownName,
    UsageError,
)
from vcage.base.hold import held
from vcage.base.videos import decode
from vcage.datasets.packing import clips as clip_module
from vcage.datasets.packing.pack import RECORD, WORKING, pack
from vcage.datasets.recordings import opening
from vcage.datasets.recordings.columns import Columns, numbers_of
from vcage.datasets.recordings.hdf5_recording import Hdf5Recording
from vcage.datasets.recordings.opening import open_recordings
from vcage.schema.compression import Compression
from vcage.video.choices import LOSSLESS

LAYOUTS = {
    "robotwin": robotwin,
    "robotwin-1.0": robotwin_vision,
    "act": act,
    "act-encoded": lambda path: act(path, encoded=True),
    "vcage": lambda path: written(path, FRAMES),
}


@pytest.fixture(params=LAYOUTS)
def recording(request, tmp_path) -> Path:
    """A file in each layout."""
    return LAYOUTS[request.param](tmp_path / "in.hdf5")


@pytest.fixture
def source(tmp_path) -> Path:
    """A folder of two ACT files."""
    return act_folder(tmp_path / "in")


def beside(out: Path) -> set[str]:
    """Return the files beside an output, without the input."""
    return {path.name for path in out.parent.iterdir()} - {"in"}


# --- what is written -----------------------------------------------------------------------------------


def test_every_layout_comes_out_as_it_was_with_its_pictures_in_videos(recording, tmp_path):
    before = digests(tmp_path)
    done = packed(recording, tmp_path / "out", crf=LOSSLESS)
    (old,), (new,) = open_recordings(recording), open_recordings(tmp_path / "out")
    assert (new.LAYOUT, [camera.name for camera in new.cameras]) == (
        old.LAYOUT,
        [camera.name for camera in old.cameras],
    )
    for camera in old.cameras:
        assert np.array_equal(new.pictures(camera.name), old.pictures(camera.name))
    assert np.array_equal(new.motion.values, old.motion.values)
    assert done.fresh and all(stream.lossless for stream in done.record.streams)
    shutil.rmtree(tmp_path / "out")
    assert digests(tmp_path) == before


class ToyEpisode(Hdf5Recording):
    """All that a new layout takes."""

    LAYOUT = "toy"
    PICTURES = r"film/([^/]+)"

    def _commands(self, part: h5py.Group) -> Columns | None:
        return numbers_of(part, "told", ("x", "y", "gripper"))

    def _measured(self, part: h5py.Group) -> Columns | None:
        return None


def test_a_new_layout_is_a_class_and_an_entry_in_the_list_of_readers(tmp_path, monkeypatch):
    monkeypatch.setattr(opening, "HDF5_LAYOUTS", (*opening.HDF5_LAYOUTS, ToyEpisode))
    with h5py.File(tmp_path / "in.hdf5", "w") as file:
        file["film/top"], file["told"] = rooms(), np.zeros((FRAMES, 3))
    packed(tmp_path / "in.hdf5", tmp_path / "out", crf=LOSSLESS)
    (new,) = open_recordings(tmp_path / "out")
    assert (new.LAYOUT, new.motion.grippers, new.camera("top").storage) == ("toy", (2,), "hevc")
    assert np.array_equal(new.pictures("top"), rooms())


def test_the_record_describes_every_video_and_its_source(tmp_path, source):
    record = packed(source, tmp_path / "out").record
    assert [(stream.episode, stream.camera, stream.file) for stream in record.streams] == [
        ("a", "cam_high", "a.cam_high.mp4"),
        ("b", "cam_high", "b.cam_high.mp4"),
    ]
    for stream in record.streams:
        assert (tmp_path / "out" / stream.file).stat().st_size == stream.bytes
        assert stream.raw_bytes == stream.stored_bytes == FRAMES * HEIGHT * WIDTH * 3
        assert (stream.frames, stream.crf) == (FRAMES, 20)
    assert record.encoding.scope == "fixed"


def test_the_frame_rate_that_was_given_is_kept_in_the_videos(tmp_path, source):
    packed(source, tmp_path / "out")
    assert [recording.fps for recording in open_recordings(tmp_path / "out")] == [FPS, FPS]


def test_colours_that_were_swapped_are_mended_in_the_videos_and_reported(tmp_path):
    done = packed(robotwin_folder(tmp_path / "in", 1), tmp_path / "out")
    shown = decode(tmp_path / "out/episode0.head_camera.mp4")
    assert np.abs(shown.astype(int) - rooms()).mean() < 4
    assert any("swapped" in note for note in done.record.notes["episode0"])


def test_only_the_named_cameras_become_videos(tmp_path):
    add_camera(act_folder(tmp_path / "in", "a") / "a.hdf5", "cam_low")
    packed(tmp_path / "in", tmp_path / "out", cameras=("cam_low",))
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["a.cam_low.mp4", "a.hdf5", RECORD]
    with h5py.File(tmp_path / "out/a.hdf5") as file:
        assert np.array_equal(file["observations/images/cam_high"], rooms())


def test_folders_in_folders_are_kept(tmp_path):
    (tmp_path / "in").mkdir()
    act_folder(tmp_path / "in/monday", "a")
    packed(tmp_path / "in", tmp_path / "out")
    assert sorted(digests(tmp_path / "out")) == [RECORD, "monday/a.cam_high.mp4", "monday/a.hdf5"]
    assert open_recordings(tmp_path / "out")[0].pictures("cam_high").shape == (FRAMES, HEIGHT, WIDTH, 3)


def test_a_gripper_that_never_moves_is_no_obstacle(tmp_path, source):
    assert packed(source, tmp_path / "out").record.streams[0].keyframes == [0, FRAMES - 1]


def test_odd_sizes_keep_every_pixel(tmp_path):
    packed(filled(tmp_path / "in.hdf5", rooms()[:, :31, :47]), tmp_path / "out", crf=LOSSLESS)
    assert np.array_equal(open_recordings(tmp_path / "out")[0].pictures("top"), rooms()[:, :31, :47])


@pytest.mark.parametrize(("channels", "said"), [(1, "grey"), (4, "alpha")])
def test_grey_and_rgba_pictures_are_taken_and_reported(tmp_path, caplog, channels, said):
    path = filled(tmp_path / "in.hdf5", np.full((FRAMES, HEIGHT, WIDTH, channels), 200, np.uint8))
    assert said in packed(path, tmp_path / "out").record.notes["in"][0]
    assert said in caplog.text


def test_a_camera_that_some_lack_is_reported(tmp_path, source):
    add_camera(source / "b.hdf5", "cam_low")
    assert packed(source, tmp_path / "out").record.notes == {"a": ["it lacks cam_low, which others have"]}


# --- what was compressed before ------------------------------------------------------------------------


def test_compressed_input_can_be_compressed_again(tmp_path):
    packed(robotwin_folder(tmp_path / "in", 1), tmp_path / "once", crf=LOSSLESS)
    packed(tmp_path / "once", tmp_path / "twice", crf=LOSSLESS)
    once, twice = (open_recordings(tmp_path / name)[0] for name in ("once", "twice"))
    assert np.array_equal(once.pictures("head_camera"), twice.pictures("head_camera"))
    with h5py.File(tmp_path / "once/episode0.hdf5") as old, h5py.File(tmp_path / "twice/episode0.hdf5") as new:
        key = "observation/head_camera/rgb"
        assert {**old[key].attrs} == {**new[key].attrs}


def test_the_other_cameras_of_compressed_input_keep_their_videos(tmp_path):
    add_camera(act_folder(tmp_path / "in", "a") / "a.hdf5", "cam_low")
    packed(tmp_path / "in", tmp_path / "once")
    packed(tmp_path / "once", tmp_path / "twice", cameras=("cam_low",), crf=40)
    sizes = {name: (tmp_path / "twice" / f"a.{name}.mp4").read_bytes() for name in ("cam_high", "cam_low")}
    assert sizes["cam_high"] == (tmp_path / "once/a.cam_high.mp4").read_bytes()
    assert sizes["cam_low"] != (tmp_path / "once/a.cam_low.mp4").read_bytes()
    assert len(open_recordings(tmp_path / "twice")[0].cameras) == 2


# --- finished, stale, in the way -----------------------------------------------------------------------


def test_the_same_call_again_does_nothing(tmp_path, source):
    packed(source, tmp_path / "out")
    before = digests(tmp_path)
    assert not packed(source, tmp_path / "out").fresh
    assert digests(tmp_path) == before


def test_leftovers_of_a_call_killed_at_its_end_are_removed(tmp_path, source):
    packed(source, tmp_path / "out")
    (tmp_path / f"out{WORKING}/whole").mkdir(parents=True)
    packed(source, tmp_path / "out")
    assert beside(tmp_path / "out") == {"out"}


def test_naming_a_default_output_makes_no_other_call(tmp_path, source):
    packed(source, tmp_path / "out")
    assert not packed(source, tmp_path / "out", target="hdf5").fresh


def test_two_calls_do_not_write_one_output_at_once(tmp_path, source):
    working = tmp_path / f"out{WORKING}"
    working.mkdir()
    with held(working), pytest.raises(FolderInUse, match="in use"):
        packed(source, tmp_path / "out")
    assert packed(source, tmp_path / "out").fresh
    assert beside(tmp_path / "out") == {"out"}


def test_a_finished_call_does_not_clear_away_the_work_of_another(tmp_path, source):
    packed(source, tmp_path / "out")
    working = tmp_path / f"out{WORKING}"
    working.mkdir()
    with held(working):
        assert not packed(source, tmp_path / "out").fresh
        assert working.exists()
    assert not packed(source, tmp_path / "out").fresh
    assert not working.exists()


@pytest.mark.parametrize("what", ["options", "recordings"])
def test_an_output_of_another_call_is_stale_until_forced(tmp_path, source, what):
    packed(source, tmp_path / "out")
    changes = {"crf": 30} if what == "options" else {}
    if what == "recordings":
        add_camera(source / "a.hdf5", "cam_low")
    with pytest.raises(StaleStage, match="other recordings or with other options"):
        packed(source, tmp_path / "out", **changes)
    assert pack(order(source, tmp_path / "out", **changes), workers=1, force=True).fresh
    assert beside(tmp_path / "out") == {"out"}


@pytest.mark.parametrize("force", [True, False])
def test_a_folder_of_somebody_else_is_in_the_way_even_with_force(tmp_path, source, force):
    (tmp_path / "out").mkdir()
    (tmp_path / "out/thesis.txt").write_text("years of work")
    with pytest.raises(OutputFolderError, match="in the way"):
        pack(order(source, tmp_path / "out"), workers=1, force=force)
    assert (tmp_path / "out/thesis.txt").read_text() == "years of work"


def test_a_file_in_place_of_the_output_is_refused(tmp_path, source):
    (tmp_path / "out").write_text("mine")
    with pytest.raises(OutputFolderError, match="out"):
        packed(source, tmp_path / "out")
    assert (tmp_path / "out").read_text() == "mine"


@pytest.mark.parametrize("out", ["in", "in/small", "."])
def test_an_output_among_the_recordings_or_around_them_is_refused(tmp_path, source, out):
    before = digests(tmp_path)
    with pytest.raises(OutputFolderError, match="in one another"):
        packed(source, tmp_path / out)
    assert digests(tmp_path) == before


# --- refused before any work ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "error"),
    [
        ({"display": "cinema"}, UnknownName),
        ({"cameras": ("cam_none",)}, UnknownName),
        ({"target": "lerobot-v3.0"}, UsageError),
    ],
)
def test_an_impossible_call_is_refused_and_leaves_nothing_behind(tmp_path, source, changes, error):
    with pytest.raises(error):
        packed(source, tmp_path / "out", **changes)
    assert beside(tmp_path / "out") == set()


def test_an_encoder_that_is_missing_is_reported_before_any_work(tmp_path, source, monkeypatch):
    monkeypatch.setattr(av, "codecs_available", av.codecs_available - {"libx265"})
    with pytest.raises(MissingDependency, match="libx265"):
        packed(source, tmp_path / "out")
    assert beside(tmp_path / "out") == set()


# --- damage that only decoding shows -------------------------------------------------------------------


def with_changing_sizes(path: Path) -> Path:
    pictures = [jpeg(room()), jpeg(room()), jpeg(room()[:16])]
    return filled(path, np.array(pictures, dtype=f"S{max(map(len, pictures))}"), "observation/head_camera/rgb")


def with_a_broken_picture(path: Path) -> Path:
    with h5py.File(robotwin(path), "r+") as file:
        pictures = file["observation/head_camera/rgb"][()]
        pictures[1] = pictures[1][:40]  # outside the episodes sampled for their colours
        file["observation/head_camera/rgb"][...] = pictures
    return path


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (with_changing_sizes, "picture 2 is 48x16, the first 48x32"),
        (with_a_broken_picture, r"rgb\[1\] cannot be decoded"),
    ],
)
def test_a_picture_that_does_not_fit_stops_all_or_leaves_its_recording_out(tmp_path, damage, said):
    damage(robotwin_folder(tmp_path / "in", 1) / "bad.hdf5")
    with pytest.raises(DamagedFile, match=rf"bad\.hdf5.*{said}") as refused:
        packed(tmp_path / "in", tmp_path / "out")
    assert "--skip-damaged" in refused.value.hint
    assert not (tmp_path / "out").exists()
    done = packed(tmp_path / "in", tmp_path / "out", skip_damaged=True)
    assert {stream.episode for stream in done.record.streams} == {"episode0"}
    assert done.record.notes["bad"][0].startswith("left out")
    assert not packed(tmp_path / "in", tmp_path / "out", skip_damaged=True).fresh


def test_where_decoding_shows_all_to_be_damaged_nothing_is_written(tmp_path):
    (tmp_path / "in").mkdir()
    with_changing_sizes(tmp_path / "in/bad.hdf5")
    for skip in (True, False):
        with pytest.raises(DamagedFile, match="48x16") as refused:
            packed(tmp_path / "in", tmp_path / "out", skip_damaged=skip)
        assert "--skip-damaged" not in refused.value.hint
    assert not (tmp_path / "out").exists()


# --- broken off ----------------------------------------------------------------------------------------


@pytest.fixture
def uninterrupted(tmp_path, source) -> dict[str, str]:
    """The output of an uninterrupted call."""
    packed(source, tmp_path / "whole/out")
    return digests(tmp_path / "whole/out")


@pytest.mark.parametrize(
    "stop", ["vcage.datasets.packing.pack.compression_record", "vcage.datasets.packing.pack.atomic_folder"]
)
def test_a_call_that_was_stopped_goes_on_and_ends_with_the_same_bytes(
    tmp_path, source, uninterrupted, monkeypatch, stop
):
    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(stop, _interrupt)
        packed(source, tmp_path / "again/out")
    assert not (tmp_path / "again/out").exists()
    with monkeypatch.context() as patch:
        patch.setattr(clip_module, "search_clip", _interrupt)  # nothing is searched again
        packed(source, tmp_path / "again/out")
    assert digests(tmp_path / "again/out") == uninterrupted
    assert beside(tmp_path / "again/out") == {"out"}


def _interrupt(*_args: object, **_kwargs: object) -> None:
    raise KeyboardInterrupt


@pytest.mark.slow
@pytest.mark.parametrize("writes", range(8))
def test_a_full_disk_leaves_no_output_and_the_call_resumes_when_there_is_space(
    tmp_path, source, uninterrupted, monkeypatch, writes
):
    with monkeypatch.context() as patch, pytest.raises(DiskFull):
        _fill_disk(patch, after=writes)
        packed(source, tmp_path / "full/out")
    assert not (tmp_path / "full/out").exists()
    assert not list((tmp_path / "full").rglob("*.partial-*"))
    packed(source, tmp_path / "full/out")
    assert digests(tmp_path / "full/out") == uninterrupted


def _fill_disk(patch: pytest.MonkeyPatch, after: int) -> None:
    """No room for another file after some: each is synchronised before it takes its name."""
    synchronise, done = os.fsync, []

    def fsync(descriptor: int) -> None:
        if len(done) == after:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        done.append(descriptor)
        synchronise(descriptor)

    patch.setattr(os, "fsync", fsync)


def test_leftovers_of_a_stopped_call_do_not_block_one_with_other_options(tmp_path, source, monkeypatch):
    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr("vcage.datasets.packing.pack.compression_record", _interrupt)
        packed(source, tmp_path / "out")
    assert {stream.crf for stream in packed(source, tmp_path / "out", crf=35).record.streams} == {35}
    assert beside(tmp_path / "out") == {"out"}


def test_a_record_of_an_output_that_was_damaged_is_replaced_with_force_only(tmp_path, source):
    packed(source, tmp_path / "out")
    (tmp_path / "out" / RECORD).write_text("{")
    with pytest.raises(InputFileError):
        Compression.read(tmp_path / "out" / RECORD)
    with pytest.raises(OutputFolderError, match="in the way"):
        packed(source, tmp_path / "out")
    assert pack(order(source, tmp_path / "out"), workers=1, force=True).fresh
