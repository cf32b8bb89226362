"""Every frame says in words which sub-tasks its episode has, and when each begins."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.datasets.conftest import LENGTHS, add
from tests.recordings import FPS
from vcage.base.errors import UsageError
from vcage.datasets.lerobot.episode import SubtaskSpan, span_starts, with_language
from vcage.datasets.recordings.opening import open_recordings

FRAMES = "data/chunk-000/file-000.parquet"


def of_frames(root) -> list[dict]:
    return pq.read_table(root / FRAMES).to_pylist()


def active_at(rows: list[dict], timestamp: float) -> str:
    """Return the result of lerobot's resolver of that name: the last of the rows that began."""
    begun = [row for row in rows if row["timestamp"] <= timestamp]
    latest = max(row["timestamp"] for row in begun)
    (found,) = [row for row in begun if row["timestamp"] == latest]
    return found["content"]


def test_all_frames_of_an_episode_hold_the_same_rows(v31):
    frames = of_frames(v31)
    for number, length in enumerate(LENGTHS):
        rows = [frame["language_persistent"] for frame in frames if frame["episode_index"] == number]
        assert len(rows) == length
        assert all(row == rows[0] for row in rows)


def test_a_row_is_a_sub_task_as_lerobot_writes_one(v31):
    assert of_frames(v31)[0]["language_persistent"] == [
        {
            "role": "assistant",
            "content": text,
            "style": "subtask",
            "timestamp": pytest.approx(time),
            "camera": None,
            "tool_calls": None,
        }
        for text, time in (("lift block", 0.0), ("place block", 0.6))
    ]


def test_the_row_in_force_is_the_sub_task_of_the_frame(v31):
    names = pq.read_table(v31 / "meta/subtasks.parquet")["subtask"].to_pylist()
    for frame in of_frames(v31):
        assert active_at(frame["language_persistent"], frame["timestamp"]) == names[frame["subtask_index"]]


def test_no_frame_has_an_event(v31):
    assert {len(frame["language_events"]) for frame in of_frames(v31)} == {0}


def test_the_columns_have_the_types_of_the_format(v31):
    schema = pq.read_schema(v31 / FRAMES)
    persistent, events = (schema.field(f"language_{name}").type.value_type for name in ("persistent", "events"))
    assert [field.name for field in persistent] == ["role", "content", "style", "timestamp", "camera", "tool_calls"]
    assert [field.name for field in events] == ["role", "content", "style", "camera", "tool_calls"]
    assert persistent.field("timestamp").type == pa.float32()


def test_a_gap_belongs_to_the_sub_task_that_follows():
    spans = [SubtaskSpan("push", 2, 4), SubtaskSpan("pull", 6, 8), SubtaskSpan("rest", 8, 9)]
    assert span_starts(spans) == [0, 4, 8]


def test_without_sub_tasks_no_frame_has_a_row():
    frames = with_language(pa.table({"index": [0, 1]}), [], np.array([0.0, 0.1], np.float32))
    assert frames["language_persistent"].to_pylist() == [[], []]


def test_a_data_set_without_the_columns_is_added_to_without(v3, episodes, tmp_path):
    root = shutil.copytree(v3, tmp_path / "set")
    add("lerobot-v3.1", root, episodes)
    assert open_recordings(root)[-1].LAYOUT == "lerobot-v3.0"
    tables = sorted((root / "data").rglob("*.parquet"))
    assert all("language_persistent" not in pq.read_schema(table).names for table in tables)


def test_a_data_set_with_the_columns_is_added_to_with_them(v31, episodes, tmp_path):
    root = shutil.copytree(v31, tmp_path / "set")
    push = replace(episodes[1], subtasks=[SubtaskSpan("push", 0, 9)])
    add("lerobot-v3.0", root, [push])
    (row,) = pq.read_table(root / "data/chunk-000/file-001.parquet")["language_persistent"][0].as_py()
    assert row["content"] == "push"


def test_statistics_are_of_numbers_and_pictures_alone(v31, v3):
    assert (
        json.loads((v31 / "meta/stats.json").read_text()).keys()
        == json.loads((v3 / "meta/stats.json").read_text()).keys()
    )


def test_another_robot_is_still_refused(v31, episodes, tmp_path):
    root = shutil.copytree(v31, tmp_path / "set")
    with pytest.raises(UsageError, match="other robot"):
        add("lerobot-v3.1", root, [replace(episodes[0], robot="aloha")])


def test_a_recording_from_another_version_names_the_parts_it_lacks(v31):
    recording = open_recordings(v31)[0]
    assert (recording.LAYOUT, recording.fps) == ("lerobot-v3.1", FPS)
    assert list(recording.left_out()) == ["subtask_index", "language_persistent", "language_events"]
