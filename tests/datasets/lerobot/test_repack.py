"""A LeRobot data set with other videos, and everything else as it was."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import cv2
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.datasets.conftest import LENGTHS
from tests.recordings import CAMERAS, FPS, clip
from vcage.base.errors import DamagedFile, DiskFull, UsageError
from vcage.base.files import sha256_file
from vcage.base.videos import codec_name, decode
from vcage.datasets.lerobot.features import CAMERA
from vcage.datasets.lerobot.repack import repack, require_whole
from vcage.datasets.recordings.opening import open_recordings
from vcage.video.codec import EncoderSettings, encode

CAM, OTHER = "observation.images.cam_high", "observation.images.cam_left_wrist"
KEYS = [f"observation.images.{camera}" for camera in CAMERAS]
CODEC = EncoderSettings("h264", "yuv420p", gop=2)
ENCODINGS = {key: {"video.crf": 5, "video.g": 2} for key in KEYS}


# --- what is repacked ----------------------------------------------------------------------------------


@pytest.fixture(scope="session")
def films(tmp_path_factory) -> dict[str, dict[int, Path]]:
    """New videos of all cameras and episodes."""
    folder = tmp_path_factory.mktemp("films")
    films = {key: {index: folder / f"{index}.{key}.mp4" for index in range(len(LENGTHS))} for key in KEYS}
    for number, key in enumerate(KEYS):
        for index, length in enumerate(LENGTHS):
            films[key][index].write_bytes(encode(clip(length, number), FPS, CODEC, 5))
    return films


@pytest.fixture(params=["v2.1", "v3.0"])
def source(request, v21, v3, tmp_path) -> Path:
    """A data set with a column and files that only its owner knows."""
    root = shutil.copytree(v21 if request.param == "v2.1" else v3, tmp_path / "source")
    for file in frame_tables(root):
        table = pq.read_table(file)
        rewards = pa.array(np.random.default_rng(table.num_rows).normal(size=table.num_rows))
        pq.write_table(table.append_column("next.reward", rewards), file)
    change_info(root, lambda info: info["features"].update({"next.reward": {"dtype": "float64", "shape": [1]}}))
    for name in ("README.md", "meta/mine.json", ".gitattributes", ".cache/huggingface/etag", ".git/objects/pack"):
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(name)
    return root


@pytest.fixture
def with_pictures(source) -> Path:
    """The data set, with the pictures of one camera in its tables of frames and no videos of it."""
    return put_pictures(source, lambda index, frame, png: {"bytes": png, "path": f"frame_{frame:06d}.png"})


@pytest.fixture
def with_picture_files(source) -> Path:
    """The same, with the pictures in files that the tables name."""

    def stored(index: int, frame: int, png: bytes) -> dict:
        path = source / f"images/{CAM}/episode_{index:06d}/frame_{frame:06d}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(png)
        return {"bytes": None, "path": path.relative_to(source).as_posix()}

    return put_pictures(source, stored)


def put_pictures(root: Path, stored) -> Path:
    for file in frame_tables(root):
        table, values = pq.read_table(file), []
        for index, frame in zip(table["episode_index"].to_pylist(), table["frame_index"].to_pylist(), strict=True):
            png = cv2.imencode(".png", clip(LENGTHS[index])[frame][..., ::-1])[1].tobytes()
            values.append(stored(index, frame, png))
        kind = pa.struct([("bytes", pa.binary()), ("path", pa.string())])
        pq.write_table(table.append_column(CAM, pa.array(values, kind)), file, row_group_size=8)
    for video in root.rglob(f"**/{CAM}/**/*.mp4"):
        video.unlink()
    for file in (root / "meta").rglob("file-*.parquet"):
        table = pq.read_table(file)
        columns = [name for name in table.column_names if name.startswith(f"videos/{CAM}/")]
        pq.write_table(table.drop_columns(columns), file)

    def changed(info):
        info["features"][CAM] = {"dtype": "image", "shape": [48, 64, 3], "names": ["height", "width", "channels"]}
        if "total_videos" in info:
            info["total_videos"] -= len(LENGTHS)

    change_info(root, changed)
    return root


def share_videos(root: Path) -> None:
    """Put all episodes of a v3.0 set into one video for each camera, as lerobot does."""
    for number, key in enumerate(KEYS):
        folder = root / f"videos/{key}/chunk-000"
        shutil.rmtree(folder)
        folder.mkdir()
        pictures = np.concatenate([clip(length, number) for length in LENGTHS])
        (folder / "file-000.mp4").write_bytes(encode(pictures, FPS, CODEC, 5))
    (file,) = (root / "meta/episodes").rglob("*.parquet")
    table, start = pq.read_table(file), 0.0
    rows = table.to_pylist()
    for row in rows:
        for key in KEYS:
            row[f"videos/{key}/file_index"] = 0
            row[f"videos/{key}/from_timestamp"] = start
            row[f"videos/{key}/to_timestamp"] = start + row["length"] / FPS
        start += row["length"] / FPS
    pq.write_table(pa.Table.from_pylist(rows, schema=table.schema), file)


def frame_tables(root: Path) -> list[Path]:
    return sorted((root / "data").rglob("*.parquet"))


def info_of(root: Path) -> dict:
    return json.loads((root / "meta/info.json").read_text())


def change_info(root: Path, change) -> None:
    info = info_of(root)
    change(info)
    (root / "meta/info.json").write_text(json.dumps(info))


def hashes(root: Path) -> dict[str, str]:
    return {file.relative_to(root).as_posix(): sha256_file(file) for file in root.rglob("*") if file.is_file()}


def is_video(name: str) -> bool:
    return name.endswith(".mp4")


def only(films, *keys):
    return {key: films[key] for key in keys}


def near(recording, camera: str, number: int) -> bool:
    true = clip(LENGTHS[recording.number], number).astype(int)
    return bool(np.abs(recording.pictures(camera) - true).mean() < 6)


# --- what stays ----------------------------------------------------------------------------------------


def test_all_other_files_are_the_same_bytes(source, films, tmp_path):
    before = hashes(source)
    repack(source, tmp_path / "out", films, ENCODINGS)
    after = hashes(tmp_path / "out")
    kept = {name for name in before if not is_video(name) and not name.startswith((".cache", ".git/"))}
    assert {name for name in after if not is_video(name)} == kept
    changed = {name for name in kept if before[name] != after[name]}
    assert changed == {"meta/info.json"} | {name for name in kept if name.startswith("meta/episodes/")}


def test_the_source_is_only_read(source, films, tmp_path):
    before = hashes(source)
    repack(source, tmp_path / "out", films, ENCODINGS)
    assert hashes(source) == before


def test_the_list_of_episodes_changes_in_the_places_of_videos_only(source, films, tmp_path):
    repack(source, tmp_path / "out", only(films, CAM), ENCODINGS)
    for file in (source / "meta").rglob("*.parquet"):
        before, after = pq.read_table(file), pq.read_table(tmp_path / "out" / file.relative_to(source))
        assert before.schema.equals(after.schema, check_metadata=True)
        for name in before.column_names:
            assert name.startswith(f"videos/{CAM}/") or before[name] == after[name]


def test_info_changes_only_in_its_entries_for_the_new_videos(source, films, tmp_path):
    change_info(source, lambda info: info["features"][CAM]["info"].update({"video.preset": 12, "mount": "arm"}))
    repack(source, tmp_path / "out", only(films, CAM), ENCODINGS)
    before, after = info_of(source), info_of(tmp_path / "out")
    old, new = before["features"][CAM].pop("info"), after["features"][CAM].pop("info")
    assert before == after
    assert list(before["features"]) == list(after["features"])
    assert old["video.codec"] == "hevc"
    assert new == {
        "video.height": 48,
        "video.width": 64,
        "video.channels": 3,
        "video.codec": "h264",
        "video.pix_fmt": "yuv420p",
        "has_audio": False,
        "video.fps": 10,
        "video.is_depth_map": False,
        "video.crf": 5,
        "video.g": 2,
        "mount": "arm",
    }


def test_facts_in_which_videos_differ_are_left_open(source, films, tmp_path):
    repack(source, tmp_path / "out", only(films, CAM), {CAM: {"video.pix_fmt": None}})
    assert "video.pix_fmt" not in info_of(tmp_path / "out")["features"][CAM]["info"]


def test_facts_stay_where_older_sets_have_them(source, films, tmp_path):
    def older(info):
        info["features"][CAM]["video_info"] = info["features"][CAM].pop("info")

    change_info(source, older)
    repack(source, tmp_path / "out", only(films, CAM), ENCODINGS)
    feature = info_of(tmp_path / "out")["features"][CAM]
    assert feature["video_info"]["video.codec"] == "h264"
    assert "info" not in feature


# --- what is new ---------------------------------------------------------------------------------------


def test_every_episode_shows_the_new_videos(source, films, tmp_path):
    repack(source, tmp_path / "out", films, ENCODINGS)
    recordings = open_recordings(tmp_path / "out")
    assert [recording.number for recording in recordings] == [0, 1]
    for recording in recordings:
        for camera, key in zip(CAMERAS, KEYS, strict=True):
            assert recording.camera(camera).storage == "h264"
            assert np.array_equal(recording.pictures(camera), decode(films[key][recording.number]))


def test_the_old_videos_are_gone(source, films, tmp_path):
    repack(source, tmp_path / "out", films, ENCODINGS)
    found = [file for file in (tmp_path / "out").rglob("*") if is_video(file.name)]
    assert len(found) == len(KEYS) * len(LENGTHS)
    assert {codec_name(file) for file in found} == {"h264"}


def test_cameras_that_are_not_named_keep_their_videos_and_their_places(source, films, tmp_path):
    before = hashes(source)
    repack(source, tmp_path / "out", only(films, CAM), ENCODINGS)
    after = hashes(tmp_path / "out")
    kept = {name for name in before if is_video(name) and CAM not in name}
    assert {name: before[name] for name in kept} == {name: after[name] for name in kept}
    for recording in open_recordings(tmp_path / "out"):
        assert [recording.camera(camera).storage for camera in CAMERAS] == ["h264", "hevc", "hevc"]
        assert all(near(recording, camera, number) for number, camera in enumerate(CAMERAS))


def test_episodes_that_shared_a_video_get_one_each(v3, films, tmp_path):
    source = shutil.copytree(v3, tmp_path / "source")
    share_videos(source)
    repack(source, tmp_path / "out", only(films, CAM), ENCODINGS)
    rows = pq.read_table(next((tmp_path / "out/meta/episodes").rglob("*.parquet"))).to_pylist()
    assert [row[f"videos/{CAM}/file_index"] for row in rows] == [0, 1]
    assert [row[f"videos/{CAM}/from_timestamp"] for row in rows] == [0.0, 0.0]
    assert [row[f"videos/{CAM}/to_timestamp"] for row in rows] == [length / FPS for length in LENGTHS]
    assert [row[f"videos/{OTHER}/file_index"] for row in rows] == [0, 0]
    assert [row[f"videos/{OTHER}/from_timestamp"] for row in rows] == [0.0, LENGTHS[0] / FPS]
    for recording in open_recordings(tmp_path / "out"):
        assert all(near(recording, camera, number) for number, camera in enumerate(CAMERAS))


def test_episodes_continue_in_the_next_folder_when_one_is_full(source, films, tmp_path):
    change_info(source, lambda info: info.update(chunks_size=1))
    for file in frame_tables(source):
        if file.stem == "episode_000001":
            file.rename((source / "data/chunk-001").mkdir() or source / "data/chunk-001" / file.name)
    repack(source, tmp_path / "out", films, ENCODINGS)
    for recording in open_recordings(tmp_path / "out"):
        assert np.array_equal(recording.pictures("cam_high"), decode(films[CAM][recording.number]))
    assert len(list((tmp_path / "out/videos").rglob("chunk-001/**/*.mp4"))) == len(KEYS)


# --- pictures that were no videos ----------------------------------------------------------------------


def test_pictures_leave_the_tables_and_become_videos(with_pictures, films, tmp_path):
    repack(with_pictures, tmp_path / "out", only(films, CAM), ENCODINGS)
    for file in frame_tables(with_pictures):
        before, after = pq.read_table(file), pq.read_table(tmp_path / "out" / file.relative_to(with_pictures))
        assert after == before.drop_columns(CAM)
        assert before.schema.remove(before.schema.get_field_index(CAM)) == after.schema
    for recording in open_recordings(tmp_path / "out"):
        assert recording.camera("cam_high").storage == "h264"
        assert np.array_equal(recording.pictures("cam_high"), decode(films[CAM][recording.number]))
        assert recording.motion.values.shape == (LENGTHS[recording.number], 6)


def test_info_says_that_pictures_became_videos(with_pictures, films, tmp_path):
    repack(with_pictures, tmp_path / "out", only(films, CAM), ENCODINGS)
    before, after = info_of(with_pictures), info_of(tmp_path / "out")
    old, new = before["features"].pop(CAM), after["features"].pop(CAM)
    assert (old["shape"], old["names"]) == (new["shape"], new["names"])
    assert new["dtype"] == "video"
    assert new["info"]["video.codec"] == "h264"
    assert after.pop("total_videos", 6) == 6  # v2.1 counts them
    before.pop("total_videos", None)
    assert before == after


def test_statistics_of_pictures_stay(with_pictures, films, tmp_path):
    repack(with_pictures, tmp_path / "out", only(films, CAM), ENCODINGS)
    for name in ("meta/stats.json", "meta/episodes_stats.jsonl"):
        if (with_pictures / name).exists():
            assert (with_pictures / name).read_bytes() == (tmp_path / "out" / name).read_bytes()
    for file in (with_pictures / "meta/episodes").rglob("*.parquet"):
        after = pq.read_table(tmp_path / "out" / file.relative_to(with_pictures))
        for name in pq.read_schema(file).names:
            assert after[name] == pq.read_table(file)[name]


def test_a_data_set_without_any_video_gets_a_place_for_them(with_pictures, films, tmp_path):
    def without_others(info):
        info["video_path"] = None
        for key in KEYS:
            if key != CAM:
                del info["features"][key]

    change_info(with_pictures, without_others)
    shutil.rmtree(with_pictures / "videos")
    repack(with_pictures, tmp_path / "out", only(films, CAM), ENCODINGS)
    for recording in open_recordings(tmp_path / "out"):
        assert np.array_equal(recording.pictures("cam_high"), decode(films[CAM][recording.number]))


def test_picture_files_that_became_videos_are_not_copied(with_picture_files, films, tmp_path):
    (with_picture_files / "images/mine.png").write_bytes(b"mine")
    repack(with_picture_files, tmp_path / "out", only(films, CAM), ENCODINGS)
    assert [file.name for file in (tmp_path / "out").rglob("*.png")] == ["mine.png"]


def test_pictures_of_a_camera_that_is_not_named_stay(with_picture_files, films, tmp_path):
    repack(with_picture_files, tmp_path / "out", only(films, OTHER), ENCODINGS)
    for file in frame_tables(with_picture_files):
        assert file.read_bytes() == (tmp_path / "out" / file.relative_to(with_picture_files)).read_bytes()
    for recording in open_recordings(tmp_path / "out"):
        assert np.array_equal(recording.pictures("cam_high"), clip(LENGTHS[recording.number]))


def test_folders_that_are_links_are_followed(source, films, tmp_path):
    (source / "videos").rename(tmp_path / "elsewhere")
    (source / "videos").symlink_to(tmp_path / "elsewhere")
    repack(source, tmp_path / "out", only(films, CAM), ENCODINGS)
    assert all(near(recording, "cam_left_wrist", 1) for recording in open_recordings(tmp_path / "out"))
    assert not (tmp_path / "out/videos").is_symlink()


# --- what is refused -----------------------------------------------------------------------------------


def test_an_episode_that_is_left_out_is_named(source):
    with pytest.raises(UsageError, match="none can be left out; missing: 1") as refused:
        require_whole(source, [0])
    assert refused.value.details == {"missing": [1]}
    assert "--to lerobot-v" in refused.value.hint


def test_all_episodes_are_a_whole_data_set(source):
    require_whole(source, [1, 0])


def test_a_camera_without_a_video_of_every_episode_is_refused(source, films, tmp_path):
    with pytest.raises(UsageError, match="missing: 0"):
        repack(source, tmp_path / "out", {CAM: {1: films[CAM][1]}}, ENCODINGS)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"shape": [48, 64, 1]}, r"pictures of the shape \[48, 64, 1\]"),
        ({"info": {"video.is_depth_map": True}}, "depth"),
        ({"info": {"is_depth_map": True}}, "depth"),
        ({"info": None, "video_info": {"video.is_depth_map": True}}, "depth"),
    ],
)
def test_pictures_beyond_an_rgb_video_are_refused(source, films, tmp_path, change, what):
    change_info(source, lambda info: info["features"][CAM].update(change))
    with pytest.raises(UsageError, match=f"cam_high shows {what}, which an RGB video cannot keep"):
        repack(source, tmp_path / "out", films, ENCODINGS)
    with pytest.raises(UsageError, match=f"cam_high shows {what}"):
        open_recordings(source)[0].require_rgb(["cam_high"])
    open_recordings(source)[0].require_rgb([OTHER.removeprefix(CAMERA)])
    assert repack(source, tmp_path / "out", only(films, OTHER), ENCODINGS).is_dir()


def test_a_video_of_other_frames_is_refused(source, films, tmp_path):
    exchanged = {CAM: {0: films[CAM][1], 1: films[CAM][0]}}
    with pytest.raises(DamagedFile, match="has 9 frames, its episode 12"):
        repack(source, tmp_path / "out", exchanged, ENCODINGS)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("missing", ["chunks_size", "data_path", "features", "fps"])
def test_an_info_that_lacks_something_is_named(source, films, tmp_path, missing):
    change_info(source, lambda info: info.pop(missing))
    with pytest.raises(DamagedFile, match=rf"info\.json does not say {missing}"):
        repack(source, tmp_path / "out", films, ENCODINGS)


@pytest.mark.parametrize("pattern", ["/tmp/{video_key}.mp4", "videos/../../{video_key}.mp4"])
def test_nothing_is_written_outside_regardless_of_info(source, films, tmp_path, pattern):
    change_info(source, lambda info: info.update(video_path=pattern))
    with pytest.raises(DamagedFile, match="not inside the data set"):
        repack(source, tmp_path / "out", films, ENCODINGS)
    assert not (tmp_path / "out").exists()


def test_a_damaged_table_is_named_and_leaves_nothing(with_pictures, films, tmp_path):
    file = frame_tables(with_pictures)[0]
    file.write_bytes(file.read_bytes()[:-50])
    with pytest.raises(DamagedFile, match=rf"{file.name} cannot be read"):
        repack(with_pictures, tmp_path / "out", only(films, CAM), ENCODINGS)
    assert not (tmp_path / "out").exists()


def test_a_full_disk_leaves_nothing(source, films, tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(shutil, "copyfile", full)
    with pytest.raises(DiskFull):
        repack(source, tmp_path / "out", films, ENCODINGS)
    assert [path.name for path in tmp_path.iterdir()] == ["source"]


def test_a_link_to_a_file_outside_is_not_copied_into_the_output(source, tmp_path):
    (tmp_path / "secret.txt").write_text("secret")
    (source / "meta/notes.txt").symlink_to(tmp_path / "secret.txt")
    with pytest.raises(DamagedFile, match=r"notes\.txt is a link to .*secret\.txt, outside the data set"):
        repack(source, tmp_path / "out", {}, {})
    assert not (tmp_path / "out").exists()


def test_hidden_files_of_other_systems_are_not_copied(source, tmp_path):
    for name in ("._README.md", ".DS_Store", "meta/._info.json", "data/.ipynb_checkpoints/a.parquet"):
        (source / name).parent.mkdir(exist_ok=True)
        (source / name).write_text(name)
    out = repack(source, tmp_path / "out", {}, {})
    hidden = [path.name for path in out.rglob("*") if path.name.startswith(".")]
    assert hidden == [".gitattributes"]


@pytest.mark.parametrize("path", ["/etc/hostname", "../../frame.png"])
def test_a_picture_file_outside_the_data_set_is_refused_by_the_table_that_names_it(source, path):
    put_pictures(source, lambda index, frame, png: {"bytes": None, "path": path})
    with pytest.raises(DamagedFile, match=rf"\.parquet: path names the path '{path}'"):
        _ = open_recordings(source)[0].cameras
