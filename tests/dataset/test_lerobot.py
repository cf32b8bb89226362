"""Both LeRobot layouts hold what their readers look up: fields, columns, videos, statistics."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import av
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.dataset.conftest import LENGTHS
from tests.recordings import CAMERAS, FPS, INSTRUCTION, STATE_NAMES, episode
from vcage.dataset.lerobot import gather, video_key
from vcage.dataset.lerobot_v3 import export_v3
from vcage.errors import DamagedFile, UsageError
from vcage.videos import decode

KEYS = [video_key(camera) for camera in CAMERAS]


def lines(path: Path) -> list[dict]:
    return [json.loads(line) for line in path.read_text().splitlines()]


@pytest.mark.parametrize("version", ["v3.0", "v2.1"])
def test_info_holds_the_fields_that_lerobot_reads(version, v3, v21):
    info = json.loads(((v3 if version == "v3.0" else v21) / "meta/info.json").read_text())
    assert info["codebase_version"] == version
    assert (info["total_episodes"], info["total_frames"], info["total_tasks"]) == (2, sum(LENGTHS), 1)
    assert info["fps"] == 10 and isinstance(info["fps"], int)
    assert info["splits"] == {"train": "0:2"}
    assert info["features"]["observation.state"] == {"dtype": "float32", "shape": [6], "names": STATE_NAMES}
    video = info["features"]["observation.images.cam_high"]
    assert video["shape"] == [48, 64, 3]
    assert video["info"]["video.codec"] == "hevc"
    assert video["info"]["video.crf"] == 10
    assert video["info"]["video.fps"] == 10


def test_v3_frames_are_in_one_file_with_the_columns_and_types_of_the_format(v3):
    table = pq.read_table(v3 / "data/chunk-000/file-000.parquet")
    assert table.schema.field("action").type == pa.list_(pa.float32(), 6)
    assert str(table.schema.field("timestamp").type) == "float"
    assert table["index"].to_pylist() == list(range(sum(LENGTHS)))
    assert table["episode_index"].to_pylist() == [0] * 12 + [1] * 9
    assert table["frame_index"].to_pylist() == [*range(12), *range(9)]


def test_state_is_measured_and_action_is_commanded(v3):
    table = pq.read_table(v3 / "data/chunk-000/file-000.parquet")
    np.testing.assert_allclose(table["observation.state"].to_pylist()[:12], episode(12).qpos, atol=1e-6)
    np.testing.assert_allclose(table["action"].to_pylist()[:12], episode(12).action, atol=1e-6)


def test_timestamps_start_at_zero_in_every_episode_and_match_the_video(v3, v21):
    table = pq.read_table(v21 / "data/chunk-000/episode_000001.parquet")
    path = v21 / f"videos/chunk-000/{KEYS[0]}/episode_000001.mp4"
    with av.open(str(path)) as container:
        times = [float(frame.pts * frame.time_base) for frame in container.decode(video=0)]
    np.testing.assert_allclose(table["timestamp"].to_pylist(), times, atol=1e-6)


def test_v3_episode_rows_lead_to_frames_and_videos(v3):
    rows = pq.read_table(v3 / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    assert [(row["dataset_from_index"], row["dataset_to_index"]) for row in rows] == [(0, 12), (12, 21)]
    assert all(row["tasks"] == [INSTRUCTION] for row in rows)
    info = json.loads((v3 / "meta/info.json").read_text())
    for row, length in zip(rows, LENGTHS, strict=True):
        for key in KEYS:
            place = {name: row[f"videos/{key}/{name}"] for name in ("chunk_index", "file_index")}
            video = v3 / info["video_path"].format(video_key=key, **place)
            assert len(decode(video)) == length
            assert row[f"videos/{key}/to_timestamp"] == pytest.approx(length / FPS)
        assert np.shape(row[f"stats/{KEYS[0]}/mean"]) == (3, 1, 1)
        assert len(row["stats/action/q99"]) == 6


def test_v3_tasks_have_the_text_as_their_pandas_index(v3):
    table = pq.read_table(v3 / "meta/tasks.parquet")
    assert table["task_index"].to_pylist() == [0]
    assert json.loads(table.schema.metadata[b"pandas"])["index_columns"] == ["task"]
    assert table["task"].to_pylist() == [INSTRUCTION]


def test_v3_statistics_cover_every_feature(v3):
    stats = json.loads((v3 / "meta/stats.json").read_text())
    assert set(stats) == {"observation.state", "action", *KEYS, *_scalars()}
    assert stats["index"]["max"] == [sum(LENGTHS) - 1]


def test_v21_has_one_parquet_and_video_per_episode(v21):
    info = json.loads((v21 / "meta/info.json").read_text())
    assert (info["total_videos"], info["total_chunks"]) == (6, 1)
    for index, length in enumerate(LENGTHS):
        names = {"episode_chunk": 0, "episode_index": index}
        assert pq.read_table(v21 / info["data_path"].format(**names)).num_rows == length
        for key in KEYS:
            assert len(decode(v21 / info["video_path"].format(video_key=key, **names))) == length


def test_v21_lists_tasks_episodes_and_statistics_as_json_lines(v21):
    assert lines(v21 / "meta/tasks.jsonl") == [{"task_index": 0, "task": INSTRUCTION}]
    assert [row["length"] for row in lines(v21 / "meta/episodes.jsonl")] == list(LENGTHS)
    stats = lines(v21 / "meta/episodes_stats.jsonl")[1]["stats"]
    assert set(stats["action"]) == {"min", "max", "mean", "std", "count"}
    assert stats[KEYS[0]]["count"] == [9]


def test_every_frame_names_its_sub_task(v3):
    table = pq.read_table(v3 / "data/chunk-000/file-000.parquet")
    names = pq.read_table(v3 / "meta/subtasks.parquet")["subtask"].to_pylist()
    assert names == ["lift block", "place block"]
    assert table["subtask_index"].to_pylist()[:12] == [0] * 6 + [1] * 6


def test_videos_are_copied_byte_for_byte(v3, episodes):
    copy = v3 / f"videos/{KEYS[0]}/chunk-000/file-001.mp4"
    assert copy.read_bytes() == episodes[1].videos[CAMERAS[0]].read_bytes()


def test_the_same_contents_give_the_same_files(contents, v3, tmp_path):
    again = export_v3(contents, tmp_path / "again")
    for path in filter(Path.is_file, v3.rglob("*")):
        assert (again / path.relative_to(v3)).read_bytes() == path.read_bytes()


def test_nothing_to_export_is_refused():
    with pytest.raises(UsageError, match="no accepted episode"):
        gather([], {})


def test_episodes_of_two_robots_are_refused(episodes):
    other = replace(episodes[1], data=episode(9, meta={**episode().meta, "robot": "aloha"}))
    with pytest.raises(UsageError, match="episode 1 has other robot"):
        gather([episodes[0], other], {})


def test_a_video_of_another_length_is_refused(episodes):
    wrong = replace(episodes[0], videos=episodes[1].videos)
    with pytest.raises(DamagedFile, match="9 frames"):
        gather([wrong], {})


def _scalars() -> set[str]:
    return {"timestamp", "frame_index", "episode_index", "index", "task_index", "subtask_index"}
