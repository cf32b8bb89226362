"""Depth, masks and other channels of many runs in one data set."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from tests.recordings import CAMERAS, collected, with_channels
from vcage.apps.appending import append_to
from vcage.base.errors import UsageError
from vcage.base.files import RunFolder
from vcage.campaigns.found_runs import Kind
from vcage.campaigns.merge import Order, merge
from vcage.datasets.lerobot.channels import V31, data_set_channels, depth_limits
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.recordings.opening import open_recordings
from vcage.runs.context import StageContext
from vcage.stages import compress, export

pytestmark = pytest.mark.slow

FRAMES = 6
SETTINGS = {"seed": 7, "workers": 1}


def finished(root: Path, seed: int, **changes) -> RunFolder:
    """A run of one episode, compressed and exported to v3.1."""
    run = collected(root, 1, FRAMES, seed=seed, **changes)
    compression = CompressionSettings(crf=8, effort="fast")
    compress.execute(run, compress.Options(compression=compression, **SETTINGS), StageContext())
    export.execute(run, export.Options(formats=(V31, "lerobot-v3.0"), **SETTINGS), StageContext())
    return run


@pytest.fixture(scope="module")
def runs(tmp_path_factory) -> Path:
    """Three runs: two with all channels and one without depth."""
    root = tmp_path_factory.mktemp("runs")
    finished(root / "all/a", 0, **with_channels(FRAMES))
    finished(root / "all/b", 100, **with_channels(FRAMES, 1))
    finished(root / "plain/c", 200, **with_channels(FRAMES, 2, ("rgb",)))
    return root


def info(root: Path) -> dict:
    return json.loads((root / "meta/info.json").read_text())


def test_runs_of_the_same_channels_are_one_data_set(runs, tmp_path):
    record = merge([runs / "all"], tmp_path / "set", Order(formats=(V31, "lerobot-v3.0"))).record
    assert [(one.format, one.episodes) for one in record.datasets] == [(V31, 2), ("lerobot-v3.0", 2)]
    assert record.left_out == []
    root = tmp_path / "set" / V31
    assert data_set_channels(root) == {"depth", "segmentation", "calibration", "robot"}
    assert len(list((root / "masks").rglob("*.mp4"))) == 2 * len(CAMERAS)
    assert data_set_channels(tmp_path / "set/lerobot-v3.0") == set()


def test_a_repeated_merge_fits_its_own_data_set(runs, tmp_path):
    for _ in range(2):
        merge([runs / "all"], tmp_path / "set", Order(formats=(V31, "lerobot-v3.0")))
    assert info(tmp_path / "set" / V31)["total_episodes"] == 2


def test_a_run_without_depth_is_refused_beside_one_with_and_both_are_named(runs, tmp_path):
    with pytest.raises(
        UsageError, match=r"2 kinds: .*hevc-calibration\+depth\+robot.*hevc-calibration\+robot"
    ) as caught:
        merge([runs], tmp_path / "set", Order(formats=(V31,)))
    assert "channels" in caught.value.details["other"]
    assert "--channels" in str(caught.value.hint)
    assert not (tmp_path / "set" / V31).exists()


def test_what_all_have_can_be_chosen(runs, tmp_path):
    merge([runs], tmp_path / "set", Order(formats=(V31,), channels=("rgb", "calibration")))
    root = tmp_path / "set" / V31
    assert info(root)["total_episodes"] == 3
    assert data_set_channels(root) == {"calibration"}


def test_older_formats_take_runs_of_all_channels(runs, tmp_path):
    merge([runs], tmp_path / "set", Order(formats=("lerobot-v3.0",)))
    assert info(tmp_path / "set/lerobot-v3.0")["total_episodes"] == 3


def test_a_run_without_depth_does_not_fit_a_data_set_with(runs, tmp_path):
    merge([runs / "all"], tmp_path / "set", Order(formats=(V31,)))
    with pytest.raises(UsageError, match=r"does not fit .*: it has channels \('calibration', 'robot'\)"):
        merge([runs / "plain"], tmp_path / "set", Order(formats=(V31,)))


def test_groups_have_their_own_channels(runs, tmp_path):
    record = merge([runs], tmp_path / "set", Order(formats=(V31,), group=True)).record
    assert sorted(one.episodes for one in record.datasets) == [1, 2]


def test_without_videos_there_is_neither_depth_nor_mask(runs, tmp_path):
    merge([runs], tmp_path / "set", Order(formats=(V31,), videos=False))
    assert data_set_channels(tmp_path / "set" / V31) == {"robot"}


def test_an_appended_run_has_what_its_export_has_but_objects(runs, tmp_path):
    for name in "ab":
        append_to(tmp_path / "set", RunFolder(runs / "all" / name))
    root = tmp_path / "set" / V31
    assert info(root)["total_episodes"] == 2
    assert "object_poses" in info(runs / "all/a/export" / V31)["features"]
    assert "object_poses" not in info(root)["features"]
    assert depth_limits(root)["cam_high"].farthest_m == 8.19
    assert len((root / "meta/ids.jsonl").read_text().splitlines()) == 2


def test_a_run_without_depth_is_not_appended_to_one_with(runs, tmp_path):
    append_to(tmp_path / "set", RunFolder(runs / "all/a"))
    with pytest.raises(UsageError, match=r"other cameras with depth \(\[\]\) than the data set") as caught:
        append_to(tmp_path / "set", RunFolder(runs / "plain/c"))
    assert "--channels" in str(caught.value.hint)


def test_what_another_version_cannot_hold_is_named(runs):
    (recording,) = open_recordings(runs / "all/a/export" / V31)
    assert {"robot_base.left", "camera_extrinsics.cam_high", "object_poses"} <= set(recording.left_out())
    recording.require_rgb(CAMERAS)
    with pytest.raises(UsageError, match="shows depth, which an RGB video cannot keep"):
        recording.require_rgb(["cam_high_depth"])


def test_the_kind_of_a_run_without_channels_keeps_its_name():
    kind = Kind("panda", 10.0, "hevc", (("cam", 64, 48),), (("a",), ("a",)))
    assert kind.name == "panda-10fps-1cameras-hevc-a42536"
    assert replace(kind, channels=("depth", "robot")).name.startswith("panda-10fps-1cameras-hevc-depth+robot-")


def test_a_channel_that_no_run_has_is_refused(runs, tmp_path):
    with pytest.raises(UsageError, match="no run has depth"):
        merge([runs / "plain"], tmp_path / "set", Order(formats=(V31,), channels=("depth",)))
