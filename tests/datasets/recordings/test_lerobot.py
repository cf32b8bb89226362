from __future__ import annotations

import json
import pickle
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
import pytest

from tests.datasets.conftest import LENGTHS, write
from tests.recordings import CAMERAS, FPS, INSTRUCTION, STATE_NAMES, clip, episode
from vcage.base.errors import DamagedFile
from vcage.datasets.lerobot import meta
from vcage.datasets.lerobot.meta import MetaLimits, data_set_info, read_lines
from vcage.datasets.packing.output import OutputSpec
from vcage.datasets.packing.pack import Order, pack
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.recordings.opening import open_recordings


@pytest.fixture(params=["v2.1", "v3.0"])
def dataset(request, v21, v3):
    return v21 if request.param == "v2.1" else v3


def test_every_episode_of_a_data_set_is_a_recording_with_its_pictures_and_commands(dataset):
    recordings = open_recordings(dataset)
    assert len(recordings) == len(LENGTHS)
    for recording, length in zip(recordings, LENGTHS, strict=True):
        assert (
            recording.LAYOUT.removeprefix("lerobot-")
            == json.loads((dataset / "meta/info.json").read_text())["codebase_version"]
        )
        assert recording.fps == FPS
        assert {camera.name: camera.frames for camera in recording.cameras} == dict.fromkeys(CAMERAS, length)
        assert np.allclose(recording.motion.values, episode(length).action, atol=1e-6)
        assert np.allclose(recording.state, episode(length).qpos, atol=1e-6)
        for number, camera in enumerate(CAMERAS):
            true = clip(length, number).astype(int)
            assert np.abs(recording.pictures(camera) - true).mean() < 6
            assert np.array_equal(recording.pictures(camera, [2, 7]), recording.pictures(camera)[[2, 7]])


def test_a_data_set_states_the_meaning_of_its_numbers_and_the_task(dataset):
    recording = open_recordings(dataset)[1]
    assert recording.state_names == recording.action_names == STATE_NAMES
    assert recording.motion.grippers == (2, 5)
    assert (recording.task, recording.robot) == (INSTRUCTION, "dual_panda")


def test_an_episode_of_a_data_set_goes_to_another_process(dataset):
    recording = open_recordings(dataset)[1]
    again = pickle.loads(pickle.dumps(recording))
    assert np.array_equal(again.pictures("cam_high", [3]), recording.pictures("cam_high", [3]))
    assert np.array_equal(again.state, recording.state)


def test_a_data_set_says_how_its_pictures_are_stored(dataset):
    recording = open_recordings(dataset)[0]
    for camera in recording.cameras:
        assert camera.storage == "hevc"
        assert 0 < camera.stored_bytes < camera.raw_bytes


def test_a_missing_video_is_named(dataset, tmp_path):
    copy = shutil.copytree(dataset, tmp_path / "copy")
    next(copy.rglob("*.mp4")).unlink()
    with pytest.raises(DamagedFile, match=r"\.mp4"):
        for recording in open_recordings(copy):
            _ = recording.cameras


def test_a_video_shorter_than_its_episode_is_named(v21, tmp_path):
    copy = shutil.copytree(v21, tmp_path / "copy")
    first, second = (recording._files.clip("observation.images.cam_high").file for recording in open_recordings(copy))
    shutil.copy(second, first)
    with pytest.raises(DamagedFile, match=r"episode 0 is longer than its video: .*\.mp4 has 9 frames"):
        open_recordings(copy)[0].pictures("cam_high")


def changed(source: Path, copy: Path, change: Callable[[dict], object]) -> Path:
    """A copy of a data set, with its ``info.json`` changed."""
    shutil.copytree(source, copy)
    info = json.loads((copy / "meta/info.json").read_text())
    change(info)
    (copy / "meta/info.json").write_text(json.dumps(info))
    return copy


def test_an_unknown_version_is_named(v3, tmp_path):
    copy = changed(v3, tmp_path / "copy", lambda info: info.update(codebase_version="v1.6"))
    with pytest.raises(DamagedFile, match=r"version v1\.6"):
        open_recordings(copy)


def test_a_missing_list_of_episodes_is_named(v21, tmp_path):
    copy = shutil.copytree(v21, tmp_path / "copy")
    (copy / "meta/episodes.jsonl").unlink()
    with pytest.raises(DamagedFile, match=r"episodes\.jsonl"):
        open_recordings(copy)


@pytest.mark.parametrize("missing", ["codebase_version", "features", "fps", "chunks_size", "data_path", "video_path"])
def test_an_info_that_lacks_something_is_named(dataset, tmp_path, missing):
    copy = changed(dataset, tmp_path / "copy", lambda info: info.pop(missing))
    with pytest.raises(DamagedFile, match=rf"info\.json does not say {missing}"):
        open_recordings(copy)


@pytest.mark.parametrize(
    "change",
    [
        lambda info: info.update(fps=0),
        lambda info: info.update(features=[]),
        lambda info: info["features"]["action"].pop("dtype"),
        lambda info: info["features"]["observation.images.cam_high"].update(shape=[3]),
    ],
)
def test_an_info_that_makes_no_sense_is_named(v21, tmp_path, change):
    with pytest.raises(DamagedFile, match=r"info\.json"):
        open_recordings(changed(v21, tmp_path / "copy", change))


def test_a_place_that_the_list_of_episodes_does_not_tell_is_named(v3, tmp_path):
    copy = shutil.copytree(v3, tmp_path / "copy")
    (table,) = (copy / "meta/episodes").rglob("*.parquet")
    pq.write_table(pq.read_table(table).drop_columns(["data/file_index"]), table)
    with pytest.raises(DamagedFile, match="does not say data/file_index of 0"):
        _ = open_recordings(copy)[0].motion


def test_an_episode_without_frames_is_refused_alone(dataset, tmp_path):
    copy = shutil.copytree(dataset, tmp_path / "copy")
    for path in (copy / "data").rglob("*.parquet"):
        pq.write_table(pq.read_table(path, filters=pc.field("episode_index") != 0), path)
    empty, whole = open_recordings(copy)
    with pytest.raises(DamagedFile, match="episode 0 holds no frame"):
        _ = empty.motion
    assert len(whole.motion.values) == LENGTHS[1]


def test_an_episode_with_other_frames_than_the_list_says_is_refused(dataset, tmp_path):
    copy = changed(dataset, tmp_path / "copy", without_cameras)
    for path in (copy / "data").rglob("*.parquet"):
        pq.write_table(pq.read_table(path, filters=pc.field("frame_index") != 3), path)
    with pytest.raises(DamagedFile, match=r"episode 0 has 11 frames in .*, not 12"):
        _ = open_recordings(copy)[0].state


def without_cameras(info: dict) -> None:
    info["features"] = {name: one for name, one in info["features"].items() if one["dtype"] != "video"}


def test_a_data_set_of_numbers_alone_has_frames_but_no_camera(dataset, tmp_path):
    recording = open_recordings(changed(dataset, tmp_path / "copy", without_cameras))[0]
    assert (recording.cameras, recording.frames) == ([], LENGTHS[0])
    assert recording.motion.values.shape == (LENGTHS[0], 6)


@pytest.mark.parametrize("names", [{"motors": STATE_NAMES}, {name: index for index, name in enumerate(STATE_NAMES)}])
def test_names_come_in_groups_or_numbered_too(v21, tmp_path, names):
    copy = changed(v21, tmp_path / "copy", lambda info: info["features"]["action"].update(names=names))
    assert open_recordings(copy)[0].action_names == STATE_NAMES


@pytest.mark.parametrize("names", [None, ["channel", "height", "width"], ["channels", "height", "width"]])
@pytest.mark.parametrize("shape", [[48, 64, 3], [3, 48, 64], [48, 64], [48, 64, 1]])
def test_the_picture_size_follows_from_its_shape_regardless_of_axis_names(v21, tmp_path, names, shape):
    def change(info: dict) -> None:
        info["features"]["observation.images.cam_high"].update(names=names, shape=shape)

    camera = open_recordings(changed(v21, tmp_path / "copy", change))[0].camera("cam_high")
    assert (camera.height, camera.width) == (48, 64)


def test_a_camera_without_reported_facts_holds_a_video(v21, tmp_path):
    copy = changed(
        v21, tmp_path / "copy", lambda info: info["features"]["observation.images.cam_high"].update(info=None)
    )
    assert open_recordings(copy)[0].camera("cam_high").storage == "video"


def test_an_instruction_may_hold_unicode_line_breaks(episodes, tmp_path):
    told = "first\u2028second\u0085third"
    copy = write("lerobot-v2.1", tmp_path / "set", [replace(episodes[1], task=told)])
    assert open_recordings(copy)[0].task == told


@pytest.fixture
def with_picture_files(v21, tmp_path):
    """A data set whose pictures lie in its tables, as PNG."""
    key = "observation.images.cam_high"

    def change(info: dict) -> None:
        without_cameras(info)
        info["features"][key] = {"dtype": "image", "shape": [48, 64, 3], "names": ["height", "width", "channels"]}

    copy = changed(v21, tmp_path / "copy", change)
    for index, length in enumerate(LENGTHS):
        path = copy / f"data/chunk-000/episode_{index:06d}.parquet"
        files = [{"bytes": cv2.imencode(".png", one[..., ::-1])[1].tobytes(), "path": None} for one in clip(length)]
        pq.write_table(pq.read_table(path).append_column(key, pa.array(files)), path)
    return copy


def test_pictures_in_the_tables_of_a_data_set_are_read(with_picture_files):
    for recording, length in zip(open_recordings(with_picture_files), LENGTHS, strict=True):
        (camera,) = recording.cameras
        assert (camera.storage, camera.frames, camera.channels) == ("png", length, 3)
        assert 0 < camera.stored_bytes < camera.raw_bytes
        assert np.array_equal(recording.pictures("cam_high"), clip(length))
        assert np.array_equal(recording.pictures("cam_high", [1, 5]), clip(length)[[1, 5]])
        assert recording.motion.values.shape == (length, 6)


def with_entries(source: Path, copy: Path, **entries: object) -> Path:
    """A copy of a data set whose info.json says something else."""
    shutil.copytree(source, copy)
    info = json.loads((copy / "meta/info.json").read_text())
    (copy / "meta/info.json").write_text(json.dumps({**info, **entries}))
    return copy


@pytest.mark.parametrize("field", ["data_path", "video_path", "image_path"])
@pytest.mark.parametrize("path", ["/other/file", "../other/file"])
def test_paths_that_leave_the_data_set_are_refused_by_file_and_field(dataset, tmp_path, field, path):
    copy = with_entries(dataset, tmp_path / "copy", **{field: path})
    with pytest.raises(DamagedFile, match=rf"meta/info\.json: {field} names the path '{path}'"):
        open_recordings(copy)


@pytest.mark.parametrize("suffix", ["mp4", "parquet"])
def test_a_file_of_a_data_set_that_was_not_fetched_is_named(dataset, tmp_path, suffix):
    copy = shutil.copytree(dataset, tmp_path / "copy")
    for file in [*(copy / "data").rglob("*.parquet"), *copy.rglob("*.mp4")]:
        if file.suffix == f".{suffix}":
            file.write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n")
    recording = open_recordings(copy)[0]
    with pytest.raises(DamagedFile, match=rf"\.{suffix} is a Git LFS pointer.*git lfs pull"):
        _ = recording.motion, recording.cameras


def test_hidden_files_of_other_systems_are_passed_over(dataset, tmp_path):
    copy = shutil.copytree(dataset, tmp_path / "copy")
    for file in [path for path in copy.rglob("*") if path.is_file()]:
        file.with_name(f"._{file.name}").write_bytes(b"\0\5\26\7")
    recordings = open_recordings(copy)
    assert [recording.motion.values.shape[0] for recording in recordings] == list(LENGTHS)
    assert not [file for file in recordings[0].files if file.name.startswith(".")]


@pytest.mark.parametrize(
    ("entries", "named"),
    [
        ({"fps": float("inf")}, "fps and chunks_size are not positive"),
        ({"chunks_size": 0.5}, "fps and chunks_size are not positive"),
        ({"robot_type": "\ud800"}, "surrogates not allowed"),
    ],
)
def test_values_that_no_data_set_has_are_refused(dataset, tmp_path, entries, named):
    with pytest.raises(DamagedFile, match=rf"info\.json.*{named}"):
        open_recordings(with_entries(dataset, tmp_path / "copy", **entries))


@pytest.mark.parametrize(
    ("name", "shape", "named"),
    [
        ("observation.images.top", [30_000, 30_000, 3], "2,700,000,000 numbers"),
        ("observation.images.top", [-1, 3, 3], r"the shape \[-1, 3, 3\]"),
        ("observation.images./../../top", [48, 64, 3], "is not a camera name"),
    ],
)
def test_cameras_that_cannot_be_are_refused(v21, tmp_path, name, shape, named):
    features = {name: {"dtype": "video", "shape": shape, "names": None}}
    with pytest.raises(DamagedFile, match=rf"info\.json.*{named}"):
        open_recordings(with_entries(v21, tmp_path / "copy", features=features))


@pytest.mark.parametrize(
    ("line", "named"),
    [
        ({"episode_index": 0, "length": 10**9}, "episode 0 has 1,000,000,000 frames"),
        ({"episode_index": 0, "length": -1}, "whose length is -1"),
        ({"episode_index": 1, "length": 3}, "lists episode 1 twice"),
    ],
)
def test_episodes_that_cannot_be_are_refused(v21, tmp_path, line, named):
    copy = shutil.copytree(v21, tmp_path / "copy")
    rows = (copy / "meta/episodes.jsonl").read_text().splitlines()
    (copy / "meta/episodes.jsonl").write_text("\n".join([json.dumps({**line, "tasks": []}), *rows[1:]]))
    with pytest.raises(DamagedFile, match=named):
        open_recordings(copy)


@pytest.mark.parametrize("text", ["[" * 100_000, " " * 2000], ids=["deep", "long"])
def test_json_that_fills_the_memory_or_the_stack_is_refused(v21, tmp_path, monkeypatch, text):
    monkeypatch.setattr(meta, "LIMITS", MetaLimits(max_json_bytes=200_000 if "[" in text else 1000))
    copy = shutil.copytree(v21, tmp_path / "copy")
    for name in ("info.json", "episodes.jsonl"):
        (copy / "meta" / name).write_text(text)
    for read in (lambda: data_set_info(copy), lambda: list(read_lines(copy / "meta/episodes.jsonl"))):
        with pytest.raises(DamagedFile, match=r"not valid JSON|too many characters|has 2,000 bytes"):
            read()


def test_chunk_numbers_that_are_texts_are_refused(v3, tmp_path):
    copy = shutil.copytree(v3, tmp_path / "copy")
    (table,) = (copy / "meta/episodes").rglob("*.parquet")
    rows = [{**row, "data/chunk_index": "../../x"} for row in pq.read_table(table).to_pylist()]
    pq.write_table(pa.Table.from_pylist(rows), table)
    with pytest.raises(DamagedFile, match=r"data/chunk_index of 0 is '../../x', not a number"):
        _ = open_recordings(copy)[0].motion


# --- older versions ------------------------------------------------------------------------------------


@pytest.fixture
def v20(v21, tmp_path):
    """The same as lerobot wrote it before v2.1: statistics of all episodes together, none of each."""
    copy = changed(v21, tmp_path / "v20", lambda info: info.update(codebase_version="v2.0"))
    rows = [json.loads(line) for line in (copy / "meta/episodes_stats.jsonl").read_text().splitlines()]
    (copy / "meta/episodes_stats.jsonl").unlink()
    (copy / "meta/stats.json").write_text(json.dumps(rows[0]["stats"]))
    return copy


def test_version_2_0_is_read_like_2_1(v20, v21):
    for old, new in zip(open_recordings(v20), open_recordings(v21), strict=True):
        assert (old.LAYOUT, old.fps, old.task, old.robot) == ("lerobot-v2.0", new.fps, new.task, new.robot)
        assert np.array_equal(old.state, new.state) and old.state_names == new.state_names
        assert np.array_equal(old.motion.values, new.motion.values)
        assert np.array_equal(old.pictures("cam_high"), new.pictures("cam_high"))


def test_version_2_0_stays_one_or_becomes_another(v20, tmp_path):
    settings = CompressionSettings(crf=20, keyframes=2, effort="fast")
    for target, version in ((None, "lerobot-v2.0"), ("lerobot-v2.1", "lerobot-v2.1"), ("lerobot-v3.0", "lerobot-v3.0")):
        out = tmp_path / version
        pack(Order(v20, out, settings, OutputSpec(target), ("cam_high",)), workers=1)
        for old, new in zip(open_recordings(v20), open_recordings(out), strict=True):
            assert (new.LAYOUT, new.task, new.fps) == (version, old.task, old.fps)
            assert np.array_equal(new.state, old.state) and np.array_equal(new.motion.values, old.motion.values)
    assert (tmp_path / "lerobot-v2.0/meta/stats.json").read_bytes() == (v20 / "meta/stats.json").read_bytes()
    assert (tmp_path / "lerobot-v2.1/meta/episodes_stats.jsonl").is_file()


@pytest.mark.parametrize("place", ["meta/info.json", "meta_data/info.json"])
def test_versions_1_are_refused_by_name_with_the_converter(tmp_path, place):
    (tmp_path / place).parent.mkdir()
    (tmp_path / place).write_text(json.dumps({"codebase_version": "v1.6", "fps": 50, "video": True}))
    (tmp_path / "videos").mkdir()
    with pytest.raises(DamagedFile, match=r"version v1\.6; v2\.0, v2\.1, v3\.0 are known") as refused:
        open_recordings(tmp_path)
    assert "convert_dataset_v1_to_v2" in refused.value.hint
